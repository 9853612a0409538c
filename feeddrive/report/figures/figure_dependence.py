"""Figure of a residual against what may cause it: table velocity, table position, motor angle in one revolution."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.diagnosis.judging.result import ChannelResult, ChannelSeries, Diagnosis, JudgedRecording
from feeddrive.report.figures.drawing import NOISE, ReportFigure, dress, legend_above, new_figure
from feeddrive.report.figures.selection import residuals, stem_of, with_variable
from feeddrive.report.figures.thinning import Bins, balanced, binned, thin
from feeddrive.report.words.number_text import Scale, axis_label, fixed, scale_for_error, scale_for_signal
from feeddrive.report.words.words import joined, plain, variable_words
from feeddrive.typing import BoolArray, FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_VARIABLES = ("table_velocity", "table_position", "motor_angle", "screw_speed", "nut_rise")
_UNITS = {"table_velocity": "m/s", "table_position": "m", "screw_speed": "rad/s", "nut_rise": "K"}
_MOST_POINTS = 1200
_FEW = 3000
_TURN = 2.0 * np.pi


@dataclass(frozen=True)
class _Cloud:
    """One prediction's residual against one variable, pooled over recordings; variable and residual of shape (n,)."""

    label: str
    colour: str
    variable: FloatArray
    residual: FloatArray
    bins: Bins


@dataclass(frozen=True)
class _Row:
    """One row of the figure: the variable's axis label, the clouds in shown units, and the noise in shown units."""

    words: str
    label: str
    clouds: list[_Cloud]
    error: Scale
    noise: float


def dependence_figure(diagnosis: Diagnosis, channel: ChannelResult) -> ReportFigure | None:
    """Residual of a channel against each variable: points, median and 10-90 % band; None where there is no variable.

    The left column shows before and after on one scale, the right column what is left, enlarged.
    """
    rows = [row for variable in _VARIABLES if (row := _row(diagnosis, channel, variable)) is not None]
    if not rows:
        return None
    columns = len(rows[0].clouds)
    figure = new_figure(2.55 * len(rows))
    grid = figure.subplots(len(rows), columns, squeeze=False)
    for row, axes in zip(rows, grid, strict=True):
        _panel(axes[0], row, row.clouds)
        if columns == 2:
            _panel(axes[1], row, row.clouds[1:])
            _enlarge(axes[1], row)
    title = f"What the residual of {plain(channel.name)} depends on"
    return ReportFigure(f"dependence_{stem_of(channel.name)}", title, _caption(rows), figure)


def _row(diagnosis: Diagnosis, channel: ChannelResult, variable: str) -> _Row | None:
    """Pooled samples of one variable, or None where no recording has it or it never changes."""
    found = with_variable(diagnosis, channel.name, variable)
    if not found:
        return None
    values = np.concatenate([one for _, _, one in found])
    pools = [residuals(diagnosis, series) for _, series, _ in found]
    error = scale_for_error(channel.unit)
    words, label, shown, edges = _axis(variable, values)
    if edges is None:
        return None
    clouds = []
    for index, (name, colour, _) in enumerate(pools[0]):
        residual = np.concatenate([pool[index][2] for pool in pools]) * error.factor
        kept = np.isfinite(residual) & np.isfinite(shown)
        points = shown[kept], residual[kept]
        forward = None if variable == "table_velocity" else _forward(found)
        bins = binned(*points, edges) if forward is None else balanced(*points, forward[kept], edges)
        clouds.append(_Cloud(name, colour, *points, bins))
    return _Row(words, label, clouds, error, channel.noise_rms * error.factor)


def _forward(found: list[tuple[JudgedRecording, ChannelSeries, FloatArray]]) -> BoolArray | None:
    """Whether the table moves in + direction, pooled; None where a recording has no position."""
    velocities = [recording.variables.get("table_velocity") for recording, _, _ in found]
    known = [velocity for velocity in velocities if velocity is not None]
    return np.concatenate(known) > 0.0 if len(known) == len(found) else None


def _axis(variable: str, values: FloatArray) -> tuple[str, str, FloatArray, FloatArray | None]:
    """Words, axis label, shown values and bin edges of a variable; no edges where it does not change."""
    finite = values[np.isfinite(values)]
    if finite.size == 0 or float(np.ptp(finite)) == 0.0:
        return "", "", values, None
    if variable == "motor_angle":
        shown = np.mod(values, _TURN) / _TURN * 360.0
        return "motor angle", "motor angle in one revolution [°]", shown, np.linspace(0.0, 360.0, 73)
    words = variable_words(variable)
    largest = float(np.max(np.abs(finite)))
    scale = scale_for_signal(variable, largest, _UNITS[variable])
    label = axis_label(words, scale.unit)
    if variable == "table_velocity":
        # An even number of bins from -max to max: none straddles standstill, where friction changes sign.
        edges = np.linspace(-largest, largest, 41)
    else:
        # slow recordings have hundreds of samples, not tens of thousands
        edges = np.linspace(finite.min(), finite.max(), 61 if finite.size > _FEW else 13)
    return words, label, values * scale.factor, edges * scale.factor


def _panel(axes: Axes, row: _Row, clouds: list[_Cloud]) -> None:
    """Points, band and median of the given clouds."""
    for cloud in clouds:
        part = thin(cloud.variable.size, _MOST_POINTS)
        few = cloud.variable.size <= _FEW
        size, depth = (3.0, 0.5) if few else (1.6, 0.2)
        axes.plot(cloud.variable[part], cloud.residual[part], ".", color=cloud.colour, ms=size, alpha=depth, mew=0.0)
        bins = cloud.bins
        axes.fill_between(bins.centre, bins.low, bins.high, color=cloud.colour, alpha=0.25, lw=0.0)
        alone = _alone(np.isfinite(bins.low))  # between two thin bins neither a band nor a line can be drawn
        axes.vlines(bins.centre[alone], bins.low[alone], bins.high[alone], color=cloud.colour, alpha=0.25, lw=4.0)
        label = f"{cloud.label} {_share(bins.share)}"
        axes.plot(bins.centre, bins.median, "o-", color=cloud.colour, ms=2.6, lw=1.8, label=label)
    dress(axes, row.label, axis_label("residual", row.error.unit))
    if row.words == "motor angle":
        axes.set_xticks(range(0, 361, 90))
    legend_above(axes)


def _alone(known: BoolArray) -> BoolArray:
    """Bins, (n,), neither of whose neighbours is known."""
    beside = np.concatenate([[False], known, [False]])
    alone: BoolArray = known & ~beside[:-2] & ~beside[2:]
    return alone


def _share(share: float) -> str:
    """Share of the squared residual that the median curve explains, for the legend."""
    return f"({fixed(100.0 * share, 0)} % by this)" if np.isfinite(share) else ""


def _enlarge(axes: Axes, row: _Row) -> None:
    """Scale the panel of what is left to its own band, with the noise as dashed lines."""
    bins = row.clouds[1].bins
    tops = [np.nanmax(np.abs(edge)) for edge in (bins.low, bins.high) if np.any(np.isfinite(edge))]
    noise = row.noise if np.isfinite(row.noise) and row.noise > 0.0 else 0.0
    limit = 1.5 * max([*tops, 1.5 * noise])
    if limit > 0.0:
        axes.set_ylim(-limit, limit)
    if noise > 0.0:
        for level in (-noise, noise):
            axes.axhline(level, color=NOISE, lw=0.9, ls="--")


def _caption(rows: list[_Row]) -> str:
    """What to look at, with the shares that the medians explain."""
    strongest = [row.words for row in rows if row.clouds[0].bins.share > 0.2]
    seen = f" Here it depends on {joined(strongest)}." if strongest else " Here no strong dependence is seen."
    look = (
        "Line and dots: median, over position and angle the mean of both directions' medians; band and bars: 10 to "
        "90 %. A line that is curved or stepped is something that the model lacks."
    )
    share = "In brackets: the share of the squared residual that the line alone explains."
    if len(rows[0].clouds) == 1:
        return f"{look}{seen} {share}"
    right = "Right: what is left, enlarged, with the sensor noise (± rms) dashed; it should be flat."
    return f"Left: before and after. {look}{seen.replace('Here', 'Before,')} {share} {right}"
