"""Figure of one channel over one judged recording: signal, residual before and after, what is left, a closer look."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.diagnosis.judging.result import ChannelResult, ChannelSeries, Diagnosis, JudgedRecording
from feeddrive.report.figures.drawing import (
    LEFT_OUT,
    MEASURED,
    ReportFigure,
    dress,
    legend_above,
    new_figure,
)
from feeddrive.report.figures.selection import residuals, stem_of
from feeddrive.report.figures.thinning import envelope, left_out_stretches
from feeddrive.report.words.number_text import Scale, axis_label, scale_for_error, scale_for_signal, scale_for_time
from feeddrive.report.words.words import plain
from feeddrive.typing import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Residual = tuple[str, str, FloatArray]
"""Label, colour and samples, (n,)."""

_CLOSER_SHARE = 0.02
_CLOSER_SAMPLES = 400
_VISIBLE_SHARE = 0.01
_LONGEST_LABEL = 16


@dataclass(frozen=True)
class _Picture:
    """What one figure draws: the series, its residuals, and the units they are shown in."""

    time: FloatArray
    time_unit: str
    channel: ChannelResult
    series: ChannelSeries
    residuals: list[Residual]
    signal: Scale
    error: Scale

    @property
    def overlay(self) -> bool:
        """Whether measured and predicted can be distinguished when drawn over each other."""
        spread = float(np.nanmax(self.series.measured) - np.nanmin(self.series.measured))
        return float(np.nanmax(np.abs(self.residuals[0][2]))) > _VISIBLE_SHARE * spread


def series_figure(
    diagnosis: Diagnosis, number: int, recording: JudgedRecording, channel: ChannelResult, series: ChannelSeries
) -> ReportFigure:
    """Signal, residual before and after, and a closer look at a short stretch, for one channel of one recording.

    Recordings count from 1; samples are (n,), NaN where left out.
    """
    name = plain(channel.name)
    title = f"{name[:1].upper()}{name[1:]} over time, {recording.name}"
    picture = _picture(diagnosis, recording, channel, series)
    stem = f"series_{number}_{stem_of(channel.name)}"
    return ReportFigure(stem, title, _caption(picture), _draw(picture))


def _picture(
    diagnosis: Diagnosis, recording: JudgedRecording, channel: ChannelResult, series: ChannelSeries
) -> _Picture:
    """Residuals and units of one figure."""
    largest = float(np.nanmax(np.abs(series.measured)))
    time = scale_for_time(float(recording.time[-1] - recording.time[0]))
    return _Picture(
        time=recording.time * time.factor,
        time_unit=time.unit,
        channel=channel,
        series=series,
        residuals=residuals(diagnosis, series),
        signal=scale_for_signal(channel.name, largest, series.unit),
        error=scale_for_error(series.unit),
    )


def _draw(picture: _Picture) -> Figure:
    """The signal, its residuals, what is left where something was found, and a stretch as the eye can see it."""
    pair, overlay = len(picture.residuals) > 1, picture.overlay
    closer = overlay or not pair
    heights = (2, 3, *([3] * (pair + closer)))
    figure = new_figure(0.825 * sum(heights))
    top, middle, *rest = figure.subplots(len(heights), 1, height_ratios=heights)
    name, time = plain(picture.channel.name), axis_label("time", picture.time_unit)
    residual = axis_label("residual", picture.error.unit)
    _signal_lines(top, picture, slice(None), with_predictions=False)
    dress(top, time, axis_label(_short(name), picture.signal.unit), "measured")
    _residual_lines(middle, picture, picture.residuals, slice(None))
    dress(middle, time, residual, "measured minus predicted")
    whole = [top, middle]
    if pair:
        _residual_lines(rest[0], picture, picture.residuals[1:], slice(None))
        dress(rest[0], time, residual, "what is left, enlarged")
        whole.append(rest[0])
    if closer:
        _closer_look(rest[-1], picture)
    for axes in whole[1:]:
        axes.sharex(top)
    top.margins(x=0.01)
    for axes in whole:
        _shade_left_out(axes, picture)
    return figure


def _short(name: str) -> str:
    """A channel's name for the axis of a low panel: what is measured, where the whole would not fit."""
    if len(name) <= _LONGEST_LABEL:
        return name
    return next((word for word in ("temperature", "growth") if word in name), name)


def _signal_lines(axes: Axes, picture: _Picture, part: slice, with_predictions: bool) -> None:
    """Measured signal and, on request, the predictions over it."""
    factor = picture.signal.factor
    axes.plot(
        *envelope(picture.time[part], picture.series.measured[part] * factor), color=MEASURED, lw=1.4, label="measured"
    )
    if with_predictions:
        for label, colour, residual in picture.residuals:
            predicted = (picture.series.measured - residual)[part] * factor
            axes.plot(*envelope(picture.time[part], predicted), color=colour, lw=1.1, label=label)
        legend_above(axes)


def _residual_lines(axes: Axes, picture: _Picture, residuals: Sequence[Residual], part: slice) -> None:
    """Residuals with the band of the sensor noise: the largest of 60 000 samples is about 4 times the rms."""
    factor = picture.error.factor
    for label, colour, residual in residuals:
        time, values = envelope(picture.time[part], residual[part] * factor)
        axes.plot(time, values, color=colour, lw=0.8, label=label)
    if picture.channel.noise_rms > 0.0:
        edge = 4.0 * picture.channel.noise_rms * factor
        for level, label in ((-edge, "± 4 × noise rms"), (edge, "")):
            axes.axhline(level, color=MEASURED, lw=0.8, ls="--", label=label or None, zorder=4)
    legend_above(axes)


def _closer_look(axes: Axes, picture: _Picture) -> None:
    """A short stretch around the largest residual before: as signals where the eye can distinguish them."""
    part = _closer_part(picture)
    if picture.overlay:
        _signal_lines(axes, picture, part, with_predictions=True)
        label = axis_label(_short(plain(picture.channel.name)), picture.signal.unit)
    else:
        _residual_lines(axes, picture, picture.residuals, part)
        label = axis_label("residual", picture.error.unit)
    dress(axes, axis_label("time", picture.time_unit), label, "closer look, where the residual swings most")
    axes.margins(x=0.01)


def _closer_part(picture: _Picture) -> slice:
    """The stretch over which the residual before varies most: a reversal rather than a constant offset."""
    residual = picture.residuals[0][2]
    length = max(min(_CLOSER_SAMPLES, residual.size // 4), int(_CLOSER_SHARE * residual.size))
    starts = range(0, max(1, residual.size - length + 1), max(1, length // 8))
    return max((slice(first, first + length) for first in starts), key=lambda part: _swing(residual[part]))


def _swing(residual: FloatArray) -> float:
    """Standard deviation of a stretch; a stretch that is mostly left out counts as none."""
    kept = residual[np.isfinite(residual)]
    return float(np.std(kept)) if 2 * kept.size > residual.size else -1.0


def _shade_left_out(axes: Axes, picture: _Picture) -> None:
    """Grey where samples were left out for long enough to be seen."""
    shortest = 0.004 * float(picture.time[-1] - picture.time[0])
    for first, last in left_out_stretches(picture.time, picture.residuals[0][2], shortest):
        axes.axvspan(first, last, color=LEFT_OUT, lw=0.0, zorder=0)


def _caption(picture: _Picture) -> str:
    """What to look at."""
    first = "Top: the measured signal. Below: what the prediction misses. Grey stretches were left out."
    if len(picture.residuals) == 1:
        look = "A residual inside the dashed lines is sensor noise: the declared plant says all there is to say."
    else:
        look = "Then what is left alone, on its own scale: inside the dashed lines it is sensor noise."
    if picture.overlay:
        return (
            f"{first} {look} Bottom: measured and predicted over a short stretch, where their difference swings most."
        )
    if len(picture.residuals) > 1:
        return f"{first} {look}"
    return f"{first} {look} Bottom: the residual over a short stretch; beside the signal it is too small to see."
