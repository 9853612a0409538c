"""Figures of measured tests as ISO 230 draws them: deviations over the targets, drift over time, the circle."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, cast

import numpy as np

from feeddrive.metrology.circular import Circular
from feeddrive.metrology.measured.measurements import CircleTest, DriftTest, LinearTest
from feeddrive.metrology.measured.plant_share import PlantShare
from feeddrive.metrology.positioning import EDITION
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
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import percent

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.projections.polar import PolarAxes

_RIM = 0.35
"""Share of a polar drawing's radius that the deviations fill on either side."""

_COLOURS = (AFTER, BEFORE, "#009e73", "#cc79a7", "#7f7f00", MEASURED)


def iso230_figures(
    test: LinearTest | DriftTest | CircleTest | Circular, share: PlantShare | None
) -> list[ReportFigure]:
    """The figures of a test, the standard's graph first."""
    if isinstance(test, LinearTest):
        drawn = [_linear(test)]
        return drawn if share is None else [*drawn, _explained(test, share)]
    if isinstance(test, DriftTest):
        return [_drift(test)]
    return [_circle(test)] if isinstance(test, CircleTest) else [_one_axis(test)]


def _linear(test: LinearTest) -> ReportFigure:
    """Every reading, the means, means ± 2 s, and A as the distance of the outermost."""
    figure = new_figure(4.6)
    axes = figure.subplots()
    readings = {"up": (test.up, AFTER, "along +", "^"), "down": (test.down, BEFORE, "along −", "v")}
    place, outer = 1e3 * test.target, []
    for name, side in test.sides.items():
        given, colour, label, mark = readings[name]
        assert given is not None
        axes.plot(np.repeat(place, given.shape[1]), 1e6 * given.ravel(), mark, color=colour, markersize=3.2, alpha=0.45)
        axes.plot(place, 1e6 * side.mean, "o-", color=colour, linewidth=1.3, markersize=3.5, label=f"mean {label}")
        for sign in (2, -2):
            limit = 1e6 * (side.mean + sign * side.deviation)
            outer.append(limit)
            axes.plot(place, limit, "--", color=colour, linewidth=0.8, label="mean ± 2 s" if sign > 0 else None)
    both = test.both
    if both is not None:
        middle = 1e6 * 0.5 * (both.mean_up + both.mean_down)
        axes.plot(place, middle, "-.", color=MEASURED, linewidth=1.0, label="mean of both")
    low, high = float(np.min(outer)), float(np.max(outer))
    _span(axes, low, high, "A")
    dress(axes, "target [mm]", "deviation, actual minus target [µm]")
    legend_above(axes, 5)
    found: tuple[tuple[str, float], ...]
    if both is not None:
        found = (
            ("A", both.accuracy),
            ("E", both.systematic),
            ("M", both.mean_range),
            ("B", both.reversal_value),
            ("R", both.repeatability),
        )
    else:
        (side,) = test.sides.values()
        found = (("A", side.accuracy), ("E", side.systematic), ("R", side.repeatability))
    kind = "Bidirectional" if both is not None else "Unidirectional"
    text = ", ".join(f"{name} {micrometres(value)}" for name, value in found)
    text = f"{text} ({EDITION})"
    return ReportFigure("positioning", f"{kind} accuracy and repeatability of positioning", text, figure)


def _span(axes: Axes, low: float, high: float, name: str) -> None:
    """Two lines across and an arrow between them at the right."""
    for level in (low, high):
        axes.axhline(level, color=NOISE, linewidth=0.8)
    ends = {"arrowstyle": "<->", "color": MEASURED, "linewidth": 0.9}
    axes.annotate(
        "", (1.015, low), (1.015, high), xycoords=axes.get_yaxis_transform(), arrowprops=ends, annotation_clip=False
    )
    axes.text(1.03, 0.5 * (low + high), name, transform=axes.get_yaxis_transform(), fontsize=9, va="center")


def _explained(test: LinearTest, share: PlantShare) -> ReportFigure:
    """Measured means beside the plant's deviations, zero of the scale free."""
    figure = new_figure(3.8)
    axes = figure.subplots()
    predicted = {"up": share.up, "down": share.down}
    sides = test.sides
    zero = float(np.mean([sides[name].mean - predicted[name] for name in sides]))
    for name, colour, label in (("up", AFTER, "along +"), ("down", BEFORE, "along −")):
        if name in sides:
            measured = 1e6 * sides[name].mean
            axes.plot(1e3 * test.target, measured, "o", color=colour, markersize=4, label=f"measured {label}")
            axes.plot(
                1e3 * test.target,
                1e6 * (predicted[name] + zero),
                "-",
                color=colour,
                linewidth=1.2,
                label=f"plant {label}",
            )
    dress(axes, "target [mm]", "mean deviation [µm]")
    legend_above(axes, 4)
    whole, left = micrometres(share.measured.systematic), micrometres(share.left.systematic)
    explained = f"The plant explains {percent(share.left.explains)} of the squared mean deviations"
    text = f"{explained}; E {whole} of which {left} are left. The plant is drawn about the mean of what was measured."
    return ReportFigure("explained", "What the plant explains", text, figure)


def _drift(test: DriftTest) -> ReportFigure:
    """Error over time at each target, the stop, and temperatures where they were read."""
    warm = bool(test.temperatures)
    figure = new_figure(5.6 if warm else 4.2)
    rows = figure.subplots(2 if warm else 1, 1, sharex=True, squeeze=False, height_ratios=(3, 2) if warm else None)
    axes: Axes = rows[0, 0]
    hours = test.times / 3600
    for column, place, colour in zip(test.error.T, test.positions, _COLOURS * len(test.positions), strict=False):
        mark = ".-" if len(hours) <= 80 else "-"
        axes.plot(hours, 1e6 * column, mark, color=colour, linewidth=1.1, label=f"at {1e3 * place:.5g} mm")
    axes.axvline(test.stop / 3600, color=NOISE, linestyle="--", linewidth=0.9)
    axes.axvline(1.0, color=NOISE, linestyle=":", linewidth=0.9)
    dress(axes, "" if warm else "time [h]", "drift of the deviation [µm]", "ISO 230-3:2020; dashed: the axis stops")
    legend_above(axes, 4)
    for (name, values), colour in zip(test.temperatures.items(), _COLOURS * len(test.temperatures), strict=False):
        rows[1, 0].plot(hours, values, color=colour, linewidth=1.0, label=name)
    if warm:
        dress(rows[1, 0], "time [h]", "temperature [°C]")
        legend_above(rows[1, 0], 4)
    heating = test.heating
    worst = max(heating.targets, key=lambda one: one.heating)
    text = (
        f"Largest range while heating {micrometres(worst.heating)} at {1e3 * worst.position:.5g} mm, "
        f"{micrometres(worst.first_hour)} in the first hour (dotted); slope at the stop "
        f"{1e6 * heating.slope:.3g} µm/m"
    )
    return ReportFigure("drift", "Drift of an axis that warms itself", text, figure)


def _circle(test: CircleTest) -> ReportFigure:
    """Each direction about the nominal circle, magnified, and over the angle."""
    figure = new_figure(4.4)
    left, right = cast("PolarAxes", figure.add_subplot(1, 2, 1, projection="polar")), figure.add_subplot(1, 2, 2)
    circles = test.circles
    largest = max(max(float(np.max(np.abs(one.radial))) for one in circles), 1e-12)
    words = {1: ("counter-clockwise", AFTER), -1: ("clockwise", BEFORE)}
    parts = []
    for one in circles:
        label, colour = words[one.direction]
        _magnified(left, one.angle, one.radial, largest, colour)
        _over_angle(right, one.angle, one.radial, colour, label)
        parts.append(
            f"{label}: G {micrometres(one.deviation)}, F {micrometres(one.radial_minimum)} to "
            f"{micrometres(one.radial_maximum)}"
        )
    _rim(left, largest)
    dress(right, "angle [°]", "radial deviation [µm]", "ISO 230-4:2022")
    legend_above(right, 2)
    both = test.bidirectional
    text = "; ".join(parts if both is None else [f"G(b) {micrometres(both)}", *parts])
    return ReportFigure("circle", "Circular test", text, figure)


def _one_axis(test: Circular) -> ReportFigure:
    """One axis, the second one ideal."""
    figure = new_figure(4.4)
    left, right = cast("PolarAxes", figure.add_subplot(1, 2, 1, projection="polar")), figure.add_subplot(1, 2, 2)
    largest = max(float(np.max(np.abs(test.radial))), 1e-12)
    _magnified(left, test.angle, test.radial, largest, AFTER)
    _over_angle(right, test.angle, test.radial, AFTER, "one axis")
    _rim(left, largest)
    dress(right, "angle [°], the axis reverses at 90° and 270°", "radial deviation [µm]", "ISO 230-4:2022")
    text = (
        f"G {micrometres(test.deviation)}, quadrant glitches {micrometres(test.glitch[0])} at + and "
        f"{micrometres(test.glitch[1])} at −, positive outwards; the second axis is ideal, of the same gain and "
        "lag"
    )
    return ReportFigure("circle", "Circular test of one axis", text, figure)


def _magnified(polar: PolarAxes, angle: FloatArray, radial: FloatArray, largest: float, colour: str) -> None:
    step = max(1, len(angle) // 8000)
    polar.plot(angle[::step], 1 + _RIM * radial[::step] / largest, color=colour, linewidth=0.9)


def _over_angle(axes: Axes, angle: FloatArray, radial: FloatArray, colour: str, label: str) -> None:
    degrees = np.degrees(np.mod(angle, 2 * math.pi))
    order = np.argsort(degrees, kind="stable")[:: max(1, len(angle) // 8000)]
    axes.plot(degrees[order], 1e6 * radial[order], ".", color=colour, markersize=1.6, label=label)
    axes.set_xticks([0, 90, 180, 270, 360])


def _rim(polar: PolarAxes, largest: float) -> None:
    polar.plot(np.linspace(0, 2 * math.pi, 361), np.ones(361), color=NOISE, linewidth=0.8, linestyle="--")
    polar.set_ylim(0, 1 + 1.1 * _RIM)
    polar.set_yticks([1 - _RIM, 1, 1 + _RIM])
    polar.set_yticklabels([f"−{1e6 * largest:.3g} µm", "0", f"{1e6 * largest:.3g} µm"], fontsize=7)
    polar.tick_params(labelsize=8)
    polar.set_title("nominal circle dashed", fontsize=9, loc="left")
