"""Figures of compensations: circle and deviations before and after, and the thermal error with what each leaves."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, cast

import numpy as np
from scipy.ndimage import uniform_filter1d

from feeddrive.compensation.compensate import Compensated
from feeddrive.compensation.temperature import HeatTable
from feeddrive.errors import InputError
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
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import percent

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
        f"nominal circle dashed; {micrometres(largest)} is {percent(_RIM)} of its radius", fontsize=9, loc="left"
    )
    right.set_xticks([0, 90, 180, 270, 360])
    dress(right, "angle [°], the axis reverses at 90° and 270°", "radial deviation [µm]")
    legend_above(right, 3)
    listed = ", ".join(f"{label} {micrometres(one.deviation)}" for label, one, _ in kinds)
    text = f"{done.control.title}. Circular deviation G, simulated: {listed}. The second axis is ideal."
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
    text = f"{done.judged}: the table over {done.sensor} leaves {percent(share)} of the rms error."
    return ReportFigure("heat_compensation", "Thermal error with a table over one sensor", text, figure)


_COLOURS = ("#d55e00", "#e69f00", "#0072b2", "#009e73", "#cc79a7", "#56b4e9", "#444444")
_HOUR, _MICRO = 3600.0, 1e6
_WINDOW = 600.0


def axis_heating_figure(
    times: FloatArray, positions: FloatArray, error: FloatArray, temperatures: Mapping[str, FloatArray], stop: float
) -> ReportFigure:
    """Error at both ends and in the middle of the travel, and temperatures, over time.

    Args:
        times: (k,) [s].
        positions: of the nut, ascending, (p,) [m].
        error: (k, p) [m].
        temperatures: label to its series, (k,) each [degC].
        stop: when the axis stopped [s].

    Raises:
        InputError: series that do not fit the times and positions.
    """
    _refuse_misfit(times, positions, {"error": error})
    figure = new_figure(5.6)
    upper, lower = figure.subplots(2, 1, sharex=True)
    for column, colour in zip(_ends_and_middle(positions), (_COLOURS[2], MEASURED, _COLOURS[0]), strict=True):
        upper.plot(times / _HOUR, error[:, column] * _MICRO, color=colour, lw=1.6, label=_at(positions[column]))
    dress(upper, "", "error, actual minus commanded [µm]")
    legend_above(upper, 3)
    for (label, values), colour in zip(temperatures.items(), _COLOURS * 3, strict=False):
        lower.plot(times / _HOUR, values, color=colour, lw=1.4, label=label)
    dress(lower, "time [h]", "temperature [°C]")
    legend_above(lower, 4)
    _mark_stop(upper, stop, "axis stops")
    _mark_stop(lower, stop, "")
    caption = (
        "Error of the table at both ends of the travel and in the middle while the axis goes to and fro, and after it "
        "stopped. The difference between the ends is the growth of the screw within the travel, the rest that between "
        "the front bearing and the travel."
    )
    return ReportFigure("iso230_3_heating", "Heating by moving the axis, and cooling down", caption, figure)


def compensation_figure(
    times: FloatArray, positions: FloatArray, error: FloatArray, compensations: Mapping[str, FloatArray], stop: float
) -> ReportFigure:
    """Rms over the stroke without and with each compensation, and what is left at the far end, over time.

    Args:
        times: (k,) [s].
        positions: of the nut, ascending, (p,) [m].
        error: true, (k, p) [m].
        compensations: label to the error that it estimates, (k, p) each [m].
        stop: when the axis stopped [s].

    Raises:
        InputError: series that do not fit the times and positions.
    """
    _refuse_misfit(times, positions, {"error": error, **compensations})
    figure = new_figure(6.2)
    upper, lower = figure.subplots(2, 1, sharex=True)
    upper.semilogy(times / _HOUR, _rms(times, error), color=MEASURED, lw=1.8, label="no compensation")
    for (label, estimate), colour in zip(compensations.items(), _COLOURS * 3, strict=False):
        upper.semilogy(times / _HOUR, _rms(times, error - estimate), color=colour, lw=1.4, label=label)
        lower.plot(times / _HOUR, (error - estimate)[:, -1] * _MICRO, color=colour, lw=1.4)
    upper.yaxis.set_major_formatter("{x:g}")
    dress(upper, "", "rms over the stroke and 10 min [µm]")
    legend_above(upper, 3)
    lower.axhline(0.0, color=NOISE, lw=0.8)
    dress(lower, "time [h]", f"error left {_at(positions[-1])} [µm]")
    _mark_stop(upper, stop, "")
    _mark_stop(lower, stop, "")
    caption = (
        "Above: root mean square of the error over the stroke and ten minutes, on a logarithmic scale. Below: what "
        "each compensation leaves at the far end of the travel, true minus estimated. Dashed: the axis stops."
    )
    return ReportFigure("thermal_compensation", "What each compensation leaves of the thermal error", caption, figure)


def stroke_figure(
    times: FloatArray, positions: FloatArray, error: FloatArray, estimate: FloatArray, moments: Sequence[float]
) -> ReportFigure:
    """True and estimated error along the stroke at some moments.

    Args:
        times: (k,) [s].
        positions: of the nut, ascending, (p,) [m].
        error, estimate: (k, p) each [m].
        moments: seconds since the start; the last row before each is drawn.

    Raises:
        InputError: series that do not fit the times and positions, or a moment before the first time.
    """
    _refuse_misfit(times, positions, {"error": error, "estimate": estimate})
    figure = new_figure(3.8)
    axes = figure.subplots()
    for moment, colour in zip(moments, _COLOURS * 3, strict=False):
        row = int(np.searchsorted(times, moment * (1 + 1e-12), side="right")) - 1
        if row < 0:
            raise InputError(f"{moment:g} s lies before the first time", "moments", "write a later moment")
        axes.plot(positions * 1e3, error[row] * _MICRO, color=colour, lw=1.8, label=_clock(float(times[row])))
        axes.plot(positions * 1e3, estimate[row] * _MICRO, "x", color=colour, ms=5)
    dress(axes, "nut from the front bearing [mm]", "error, actual minus commanded [µm]")
    legend_above(axes, 6)
    caption = (
        "Error along the stroke at some moments: lines are the machine's, crosses the observer's. Within a short "
        "travel it is nearly straight, which is why an offset and a slope compensate it."
    )
    return ReportFigure("thermal_error_stroke", "Thermal error along the stroke", caption, figure)


def _ends_and_middle(positions: FloatArray) -> tuple[int, int, int]:
    return 0, int(np.argmin(np.abs(positions - (positions[0] + positions[-1]) / 2))), len(positions) - 1


def _at(position: float) -> str:
    return f"at {position * 1e3:.0f} mm"


def _clock(time: float) -> str:
    return f"{int(time // _HOUR)} h {int(time % _HOUR) // 60:02d} min"


def _rms(times: FloatArray, error: FloatArray) -> FloatArray:
    """Root mean square over the stroke and ten minutes about each time, (k,) [µm]."""
    rows = max(round(_WINDOW / float(np.median(np.diff(times)))), 1)
    return np.asarray(np.sqrt(uniform_filter1d(np.mean(error**2, axis=1), rows, mode="nearest")) * _MICRO)


def _mark_stop(axes: Axes, stop: float, text: str) -> None:
    axes.axvline(stop / _HOUR, color=NOISE, lw=1.0, ls="--")
    axes.set_xlim(left=0.0)
    if text:
        axes.annotate(
            text,
            (stop / _HOUR, 0.06),
            xycoords=("data", "axes fraction"),
            xytext=(4, 0),
            textcoords="offset points",
            fontsize=8.5,
            color="#555555",
        )


def _refuse_misfit(times: FloatArray, positions: FloatArray, series: Mapping[str, FloatArray]) -> None:
    for name, values in series.items():
        if np.shape(values) != (len(times), len(positions)):
            what = f"{name} of shape {np.shape(values)} at {len(times)} times and {len(positions)} positions"
            raise InputError(what, "figure", "give a row a time and a column a position")
