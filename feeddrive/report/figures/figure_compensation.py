"""What a compensation brings: deviations along the stroke and the circle, before and after; of heat, over time."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, cast

import numpy as np

from feeddrive.compensation.compensate import Compensated
from feeddrive.compensation.temperature import HeatTable
from feeddrive.metrology.circular import Circular
from feeddrive.report.figures.drawing import (
    AFTER,
    BEFORE,
    MEASURED,
    NOISE,
    ReportFigure,
    dress,
    legend_above,
    new_figure,
)
from feeddrive.report.figures.figure_metrology import micrometres

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.projections.polar import PolarAxes

_REPAIRED = "#009e73"
_RIM = 0.35
"""Share of the plot's radius that the largest radial deviation takes."""


def compensation_figures(done: Compensated) -> Iterator[ReportFigure]:
    """The figures of a table, the telling one first."""
    if done.prediction is not None:
        yield circle_figure(done)
    yield deviation_figure(done)


def deviation_figure(done: Compensated) -> ReportFigure:
    """Deviations that the table was made of, the table, and what is left at the simulated targets."""
    figure = new_figure(3.8)
    axes = figure.subplots()
    known, table = done.known, done.table
    for values, style, label in ((known.forward, "-", "known, along +"), (known.reverse, "--", "known, along −")):
        axes.plot(1e3 * known.positions, 1e6 * values, style, color=BEFORE, linewidth=1.0, label=label)
    at = 1e3 * table.positions
    axes.plot(at, 1e6 * table.forward, ".", color=MEASURED, markersize=2.5, label="points of the table")
    axes.plot(at, 1e6 * table.reverse, ".", color=MEASURED, markersize=2.5)
    caption = f"{done.control.title}: {len(table)} points."
    if done.prediction is not None:
        p = done.prediction.after.positioning
        offset = 0.5 * float(np.mean(p.mean_up + p.mean_down))
        for mean, style, label in ((p.mean_up, "o-", "left, along +"), (p.mean_down, "o--", "left, along −")):
            axes.plot(
                1e3 * p.target, 1e6 * (mean - offset), style, color=AFTER, markersize=3, linewidth=1.0, label=label
            )
        before = done.prediction.before.positioning
        caption += (
            f" ISO 230-2, simulated: A {micrometres(before.accuracy)} before, {micrometres(p.accuracy)} after; "
            f"B {micrometres(before.reversal_value)} before, {micrometres(p.reversal_value)} after. What is left is "
            "about its mean."
        )
    dress(axes, "position [mm]", "actual minus target [µm]")
    legend_above(axes, 5 if done.prediction is not None else 3)
    return ReportFigure("compensation", "Deviations and table", caption, figure)


def circle_figure(done: Compensated) -> ReportFigure:
    """Radial deviation of the circle before, after repair and after compensation, on one scale."""
    assert done.prediction is not None
    kinds: list[tuple[str, Circular, str]] = [("before", done.prediction.before.circular, BEFORE)]
    if done.prediction.repaired is not None:
        kinds.append(("after repair", done.prediction.repaired.circular, _REPAIRED))
    kinds.append(("after compensation", done.prediction.after.circular, AFTER))
    largest = max(max(float(np.max(np.abs(one.radial))) for _, one, _ in kinds), 1e-12)
    figure = new_figure(4.4)
    polar = cast("PolarAxes", figure.add_subplot(1, 2, 1, projection="polar"))
    right = figure.add_subplot(1, 2, 2)
    polar.plot(np.linspace(0, 2 * math.pi, 361), np.ones(361), color=NOISE, linewidth=0.8, linestyle="--")
    for label, one, colour in kinds:
        _circle(polar, right, one, colour, label, largest)
    polar.set_ylim(0, 1 + 1.1 * _RIM)
    polar.set_yticks([])
    polar.tick_params(labelsize=8)
    polar.set_title(
        f"nominal circle dashed; {micrometres(largest)} is {_RIM:.0%} of its radius", fontsize=9, loc="left"
    )
    right.set_xticks([0, 90, 180, 270, 360])
    dress(right, "angle [°], the axis reverses at 90° and 270°", "radial deviation [µm]")
    legend_above(right, 3)
    told = ", ".join(f"{label} {micrometres(one.deviation)}" for label, one, _ in kinds)
    text = f"{done.control.title}. Circular deviation G, simulated: {told}. The second axis is ideal."
    return ReportFigure("circle", "Circle before and after", text, figure)


def _circle(polar: PolarAxes, right: Axes, one: Circular, colour: str, label: str, largest: float) -> None:
    step = max(1, len(one.angle) // 4000)
    angle, radial = one.angle[::step], one.radial[::step]
    polar.plot(angle, 1 + _RIM * radial / largest, color=colour, linewidth=0.9)
    degrees = np.degrees(np.mod(angle, 2 * math.pi))
    order = np.argsort(degrees, kind="stable")
    right.plot(degrees[order], 1e6 * radial[order], color=colour, linewidth=0.9, label=label)


def heat_figure(done: HeatTable) -> ReportFigure:
    """Error of the judged motion at the ends of the stroke, before and after."""
    figure = new_figure(3.8)
    axes = figure.subplots()
    hours = (done.times - done.times[0]) / 3600
    for column, style in ((0, "--"), (-1, "-")):
        place = f"{1e3 * done.positions[column]:.4g} mm"
        axes.plot(hours, 1e6 * done.before[:, column], style, color=BEFORE, linewidth=1.0, label=f"before, {place}")
        axes.plot(hours, 1e6 * done.after[:, column], style, color=AFTER, linewidth=1.0, label=f"after, {place}")
    dress(axes, "time [h]", "actual minus target [µm]")
    legend_above(axes, 4)
    share = done.left.rms_after / done.left.rms_before if done.left.rms_before > 0 else math.nan
    text = f"{done.judged}: the table over {done.sensor} leaves {share:.0%} of the rms error."
    return ReportFigure("heat_compensation", "Thermal error with a table over one sensor", text, figure)
