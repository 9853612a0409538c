"""Quantities over the recordings: every value, what was found with its band, dates of changes, limits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.report.figures.drawing import AFTER, BEFORE, LEFT_OUT, MEASURED, NOISE, ReportFigure, dress, new_figure
from feeddrive.report.words.number_text import scale_for_value
from feeddrive.trend.series_evidence import JUMP, ODD, SLOPE
from feeddrive.trend.watch import Trend
from feeddrive.trend.watched_quantities import Quantity
from feeddrive.typing import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_HEIGHT = 1.75
_PANELS = 6
"""Quantities in one figure: a page of a printer."""


def trend_figures(trend: Trend) -> list[ReportFigure]:
    """The quantities in figures of a few panels, those that changed first; then the maps that all have in common."""
    shown = [one for one in trend.quantities if np.isfinite(one.values).any()]
    order = sorted(shown, key=lambda one: (not _changed(trend, one), not one.watched))
    parts = [order[i : i + _PANELS] for i in range(0, len(order), _PANELS)]
    figures = [_figure(trend, part, number) for number, part in enumerate(parts, 1)]
    return [*figures, *_maps(trend)]


def _changed(trend: Trend, quantity: Quantity) -> bool:
    course = trend.courses.get(quantity.name)
    return course is not None and any(one.atom.kind != ODD for one in course.found)


def _figure(trend: Trend, part: list[Quantity], number: int) -> ReportFigure:
    figure = new_figure(_HEIGHT * len(part) + 0.5)
    rows = figure.subplots(len(part), 1, sharex=True, squeeze=False)
    times, label = _times(trend)
    for axes, quantity in zip(rows[:, 0], part, strict=True):
        _panel(axes, trend, quantity, times)
    rows[-1, 0].set_xlabel(label, fontsize=9)
    text = (
        "Dots: one recording each. Line: what was found, with its 95 % band. Dashed: dates of changes, shaded "
        "where they may lie. Grey lines: limits."
    )
    title = "Over the recordings" if number == 1 else "Over the recordings, continued"
    return ReportFigure(f"trend_{number}", title, text, figure)


def _times(trend: Trend) -> tuple[FloatArray, str]:
    span = float(trend.days[-1] - trend.days[0])
    begin = f"{trend.begin:%Y-%m-%d %H:%M}"
    return (trend.days, f"days since {begin}") if span > 3 else (24 * trend.days, f"hours since {begin}")


def _panel(axes: Axes, trend: Trend, quantity: Quantity, times: FloatArray) -> None:
    here = np.isfinite(quantity.values)
    largest = float(np.max(np.abs(quantity.values[here])))
    scale = scale_for_value(largest, quantity.unit)
    factor, unit = (1e6, "µm/m") if quantity.unit == "m/m" else (scale.factor, scale.unit)
    axes.plot(times[here], factor * quantity.values[here], ".", color=MEASURED, markersize=3, alpha=0.6)
    course, limit = trend.courses.get(quantity.name), trend.limits.get(quantity.name)
    per_day = float(times[-1] / trend.days[-1]) if trend.days[-1] > 0 else 1.0
    if course is not None and len(course.fitted) == here.sum():
        jumps = [(per_day * one.atom.date, one.size) for one in course.found if one.atom.kind == JUMP]
        begins = [per_day * one.atom.date for one in course.found if one.atom.kind == SLOPE]
        at, line, band = with_steps(times[here], course.fitted, course.band, jumps, begins)
        line, band = factor * line, 1.96 * factor * band
        axes.plot(at, line, color=AFTER, linewidth=1.2)
        axes.fill_between(at, line - band, line + band, color=AFTER, alpha=0.2, linewidth=0)
    for one in course.found if course is not None else ():
        if one.atom.kind != ODD:
            axes.axvspan(*(per_day * day for day in one.dates), color=LEFT_OUT, zorder=0)
            axes.axvline(per_day * one.atom.date, color=BEFORE, linestyle="--", linewidth=0.9)
    if limit is not None:
        low, high = axes.get_ylim()
        for edge in (limit.low, limit.high):
            if math.isfinite(edge) and low - 2 * (high - low) < factor * edge < high + 2 * (high - low):
                axes.axhline(factor * edge, color=NOISE, linewidth=0.9)
    dress(axes, "", f"[{unit}]", quantity.words)


def with_steps(
    times: FloatArray,
    line: FloatArray,
    band: FloatArray,
    jumps: Sequence[tuple[float, float]],
    begins: Sequence[float] = (),
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Times, line and band to draw, (m,), with the value before each jump where it begins: no ramp from there on.

    Given at the recordings, (n,); a jump has the time of the first recording after it and its size, and a slope that
    begins between two recordings bends the line there.
    """
    for date in begins:
        after = int(np.searchsorted(times, date))
        if 0 < after < len(times) and date < times[after]:
            times, line = np.insert(times, after, date), np.insert(line, after, line[after - 1])
            band = np.insert(band, after, band[after - 1])
    for date, size in sorted(jumps):
        after = int(np.searchsorted(times, date))
        if 0 < after < len(times):
            times, before = np.insert(times, after, times[after]), line[after] - size
            line, band = np.insert(line, after, before), np.insert(band, after, band[after])
    return times, line, band


def _maps(trend: Trend) -> list[ReportFigure]:
    """What all recordings have in common over position."""
    figures = []
    for channel, pooled in trend.pooled.items():
        figure = new_figure(2.8)
        axes = figure.subplots()
        factor, unit = (1e6, "µm") if channel == "table_position" else (1.0, "N")
        names = ("lead", "reversal") if channel == "table_position" else ("force", "friction")
        for values, name, colour in zip(pooled.maps, names, (AFTER, BEFORE), strict=True):
            axes.plot(1e3 * pooled.places, factor * values, color=colour, linewidth=1.1, label=name)
        dress(axes, "position [mm]", f"beyond the plant [{unit}]", channel.replace("_", " "))
        axes.legend(fontsize=8.5, frameon=False)
        text = "Common to all recordings, and taken out before changes are looked for"
        figures.append(ReportFigure(f"map_{channel}", "Map over position", text, figure))
    return figures
