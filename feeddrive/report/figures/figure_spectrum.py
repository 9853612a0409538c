"""Spectra of residuals with left-out stretches: over time in Hz, and over the screw in orders per revolution."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.diagnosis.judging.result import ChannelResult, Diagnosis, JudgedRecording
from feeddrive.report.figures.drawing import NOISE, ReportFigure, dress, legend_above, new_figure
from feeddrive.report.figures.selection import residuals, series_of, stem_of, with_variable
from feeddrive.report.figures.thinning import runs
from feeddrive.report.words.number_text import axis_label, scale_for_error, significant, with_unit
from feeddrive.report.words.words import plain
from feeddrive.typing import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes


_BINS_PER_REVOLUTION = 160
_HIGHEST_ORDER = 40.0
_FEWEST_REVOLUTIONS = 3.0
_SEGMENT_SECONDS = 4.0
_LONGEST_ANGLE_GRID = 2**17


@dataclass(frozen=True)
class Spectrum:
    """Abscissa (frequency [Hz] or order per revolution) and amplitudes in the channel's unit, shape (points,) each."""

    abscissa: FloatArray
    amplitude: FloatArray


def sample_time(time: FloatArray) -> float:
    """The usual distance of two samples [s], NaN for fewer than two samples."""
    return float(np.median(np.diff(time))) if time.size > 1 else float("nan")


def density_spectrum(recordings: list[tuple[JudgedRecording, FloatArray]]) -> Spectrum | None:
    """Welch amplitude spectral density [unit/sqrt(Hz)] over all recordings of the most usual sample time.

    Residuals are (n,), NaN where left out; None where no stretch is long enough.
    """
    steps = [sample_time(recording.time) for recording, _ in recordings]
    usable = [step for step in steps if np.isfinite(step) and step > 0.0]
    if not usable:
        return None
    step = max(usable, key=lambda one: sum(abs(other / one - 1.0) < 0.01 for other in usable))
    same = [
        values[first:last]
        for (_, values), own in zip(recordings, steps, strict=True)
        if abs(own / step - 1.0) < 0.01
        for first, last in runs(np.isfinite(values))
    ]
    return _welch(same, step)


def _welch(stretches: list[FloatArray], step: float) -> Spectrum | None:
    """Mean square over half-overlapping Hann segments of all stretches without gaps."""
    longest = max((stretch.size for stretch in stretches), default=0)
    segment = min(longest, max(256, round(_SEGMENT_SECONDS / step)))
    if segment < 32:
        return None
    pieces = np.array(
        [
            stretch[first : first + segment]
            for stretch in stretches
            for first in range(0, stretch.size - segment + 1, segment // 2)
        ]
    )
    window = np.hanning(segment)
    lines = np.fft.rfft((pieces - pieces.mean(axis=1, keepdims=True)) * window)
    density = 2.0 * step * np.mean(np.abs(lines) ** 2, axis=0) / np.sum(window**2)
    frequency = np.asarray(np.fft.rfftfreq(segment, step), dtype=np.float64)
    return Spectrum(frequency[1:], np.sqrt(density[1:]))


def order_spectrum(recordings: list[tuple[FloatArray, FloatArray]]) -> Spectrum | None:
    """Amplitude of the position-locked part of a residual over orders per motor revolution [1/rev].

    Averaging over equal angles first removes what changes with direction or time. The zeros of the recordings may
    differ: their spectra are averaged as squares, without phase. Each recording is its motor angle [rad] and residual,
    shape (n,), NaN where left out; None where fewer than three revolutions were travelled.
    """
    lines = [line for angle, residual in recordings if (line := _angle_line(angle, residual)) is not None]
    if not lines:
        return None
    orders = np.geomspace(max(0.3, 1.0 / min(line.abscissa[-1] for line in lines)), _HIGHEST_ORDER, 1200)
    squares = [np.interp(orders, *_order_lines(line)) ** 2 for line in lines]
    return Spectrum(orders, np.sqrt(np.mean(squares, axis=0)))


def _angle_line(angle: FloatArray, residual: FloatArray) -> Spectrum | None:
    """Mean residual over equal steps of angle; abscissa in revolutions from the first, NaN where never passed."""
    kept = np.isfinite(angle) & np.isfinite(residual)
    if not np.any(kept):
        return None
    turns = angle[kept] / (2.0 * np.pi)
    turns = turns - turns.min()
    if turns.max() < _FEWEST_REVOLUTIONS:
        return None
    count = min(_LONGEST_ANGLE_GRID, int(turns.max() * _BINS_PER_REVOLUTION))
    index = np.minimum((turns / turns.max() * count).astype(np.int64), count - 1)
    passes = np.bincount(index, minlength=count)
    total = np.bincount(index, weights=residual[kept], minlength=count)
    mean = np.where(passes > 0, total / np.maximum(passes, 1), np.nan)
    return Spectrum((np.arange(count) + 0.5) / count * turns.max(), mean)


def _order_lines(line: Spectrum) -> tuple[FloatArray, FloatArray]:
    """Orders and amplitudes of a line over angle, under a Hann window that is zero where no sample fell."""
    filled = np.isfinite(line.amplitude)
    weight = np.where(filled, np.hanning(line.amplitude.size), 0.0)
    values = np.where(filled, line.amplitude, 0.0)
    centred = values - np.sum(weight * values) / np.sum(weight)
    length = 4 * 2 ** int(np.ceil(np.log2(values.size)))
    step = float(line.abscissa[1] - line.abscissa[0])
    amplitude = 2.0 * np.abs(np.fft.rfft(weight * centred, length)) / np.sum(weight)
    orders = np.asarray(np.fft.rfftfreq(length, step), dtype=np.float64)
    return orders, amplitude


_ORDER_TICKS = (0.5, 1, 2, 5, 10, 20, 40)
_SLOWEST_BAND = 0.1
"""Upper edge [Hz] of a band below which no spectrum is drawn."""

Curve = tuple[str, str, Spectrum]
"""Label, colour and spectrum in shown units."""


def spectrum_figure(diagnosis: Diagnosis, channel: ChannelResult) -> ReportFigure | None:
    """Amplitude spectral density and, where the motor angle is known, amplitude per order; None without enough data."""
    if channel.band_hz[1] < _SLOWEST_BAND:
        return None  # minutes and hours: what is left shows over time, not over frequency
    density = _density_curves(diagnosis, channel)
    orders = _order_curves(diagnosis, channel)
    if not density:
        return None
    figure = new_figure(5.8 if orders else 3.2)
    panels = figure.subplots(2 if orders else 1, 1, squeeze=False)[:, 0]
    _density_panel(panels[0], channel, density)
    if orders:
        _order_panel(panels[1], channel, orders)
    title = f"Spectrum of the residual of {plain(channel.name)}"
    caption = _caption(channel, orders)
    return ReportFigure(f"spectrum_{stem_of(channel.name)}", title, caption, figure)


def _scaled(spectrum: Spectrum, factor: float) -> Spectrum:
    """A spectrum in shown units."""
    return Spectrum(spectrum.abscissa, spectrum.amplitude * factor)


def _density_curves(diagnosis: Diagnosis, channel: ChannelResult) -> list[Curve]:
    """Density of each prediction's residual over all judged recordings."""
    found = [(one, series) for one in diagnosis.recordings if (series := series_of(one, channel.name)) is not None]
    factor = scale_for_error(channel.unit).factor
    curves: list[Curve] = []
    for index in range(1 if diagnosis.nothing_missing else 2):
        drawn = [(recording, residuals(diagnosis, series)[index]) for recording, series in found]
        spectrum = density_spectrum([(recording, values) for recording, (_, _, values) in drawn])
        if spectrum is not None:
            curves.append((*drawn[0][1][:2], _scaled(spectrum, factor)))
    return curves


def _order_curves(diagnosis: Diagnosis, channel: ChannelResult) -> list[Curve]:
    """Amplitude per order of each prediction's residual."""
    found = with_variable(diagnosis, channel.name, "motor_angle")
    factor = scale_for_error(channel.unit).factor
    curves: list[Curve] = []
    for index in range(1 if diagnosis.nothing_missing else 2):
        pairs: list[tuple[FloatArray, FloatArray]] = []
        labels = [("", "")]
        for _, series, angle in found:
            label, colour, values = residuals(diagnosis, series)[index]
            pairs.append((angle, values))
            labels.append((label, colour))
        spectrum = order_spectrum(pairs)
        if spectrum is not None:
            curves.append((*labels[-1], _scaled(spectrum, factor)))
    return curves


def _density_panel(axes: Axes, channel: ChannelResult, curves: list[Curve]) -> None:
    """Density over frequency up to a little above the band, and the level of white noise of the declared size."""
    unit = scale_for_error(channel.unit)
    low, high = channel.band_hz
    for label, colour, spectrum in curves:
        inside = spectrum.abscissa <= (1.5 * high if high > 0.0 else np.inf)
        axes.loglog(spectrum.abscissa[inside], spectrum.amplitude[inside], color=colour, lw=1.1, label=label)
    if channel.noise_rms > 0.0 and np.isfinite(high) and high > low:
        level = channel.noise_rms * unit.factor / np.sqrt(high - low)
        axes.axhline(level, color=NOISE, lw=1.1, ls="--", label="sensor noise")
        _keep_above(axes, 0.1 * level)
    if np.isfinite(high) and high > 0.0:
        axes.axvline(high, color=NOISE, lw=0.9, ls=":", label="edge of the band")
    dress(axes, "frequency [Hz]", f"density [{unit.unit or '1'}/√Hz]")
    legend_above(axes)


def _keep_above(axes: Axes, floor: float) -> None:
    """Do not let the filter's roll-off stretch the scale far under the noise."""
    bottom, top = axes.get_ylim()
    if bottom < floor < top:
        axes.set_ylim(bottom=floor)


def _order_panel(axes: Axes, channel: ChannelResult, curves: list[Curve]) -> None:
    """Amplitude over orders, the strongest one named."""
    unit = scale_for_error(channel.unit).unit
    for label, colour, spectrum in curves:
        axes.loglog(spectrum.abscissa, spectrum.amplitude, color=colour, lw=1.1, label=label)
    peak = _peak(curves[0][2])
    if peak is not None:
        axes.annotate(f"order {significant(peak[0])}", peak, xytext=(6, 2), textcoords="offset points", fontsize=8.5)
    ticks = [tick for tick in _ORDER_TICKS if tick >= curves[0][2].abscissa[0]]
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.set_xticks([], minor=True)
    top = max(float(np.max(spectrum.amplitude)) for _, _, spectrum in curves)
    if top > 0.0:
        _keep_above(axes, 1e-4 * top)
    dress(axes, "order [1/rev]", axis_label("amplitude", unit))
    legend_above(axes)


def _peak(spectrum: Spectrum) -> tuple[float, float] | None:
    """Order and amplitude of a line that stands clear of its surroundings, from order 0.7 on."""
    kept = spectrum.abscissa >= 0.7
    orders, amplitude = spectrum.abscissa[kept], spectrum.amplitude[kept]
    best = int(np.argmax(amplitude))
    near = (orders > orders[best] / 1.6) & (orders < orders[best] * 1.6)
    inside = 0 < best < orders.size - 1
    if not inside or amplitude[best] < 5.0 * float(np.median(amplitude[near])):
        return None
    return float(orders[best]), float(amplitude[best])


def _caption(channel: ChannelResult, orders: list[Curve]) -> str:
    """What to look at, with the strongest order before and after."""
    first = "A resonance or a periodic force stands out as a peak; a residual on the dashed line is sensor noise."
    if not orders:
        return first
    second = "Lower panel: the part of the residual that repeats with the motor angle, in orders per revolution."
    peak = _peak(orders[0][2])
    if peak is None:
        return f"{first} {second} No order stands out."
    unit = scale_for_error(channel.unit).unit
    sizes = [with_unit(significant(_height(curve[2], peak[0])), unit) for curve in orders]
    return f"{first} {second} Order {significant(peak[0])} stands out: amplitude {' → '.join(sizes)}."


def _height(spectrum: Spectrum, order: float) -> float:
    """Amplitude at an order."""
    return float(np.interp(order, spectrum.abscissa, spectrum.amplitude))
