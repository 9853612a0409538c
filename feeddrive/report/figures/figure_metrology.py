"""One figure for every kind of figure of metrology."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from feeddrive.metrology.circular import Circular
from feeddrive.metrology.evaluate import Evaluated
from feeddrive.metrology.following import Settling
from feeddrive.metrology.loops import ForceLoop, FrictionPoint, TorqueLoop
from feeddrive.metrology.positioning import EDITION, Positioning
from feeddrive.metrology.response import Response, StepResponse, linear_response
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
from feeddrive.report.figures.thinning import envelope
from feeddrive.report.words.number_text import significant, with_unit
from feeddrive.simulate.scenario.scenario import SERIES, ScenarioResult
from feeddrive.typing import ComplexArray, FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.projections.polar import PolarAxes

_MOST_STOPS = 40
_LABELLED = 8
_RIM = 0.35
"""Share of a polar drawing's radius that the deviations fill on either side."""


def micrometres(value: float) -> str:
    """A length for captions."""
    return with_unit(significant(1e6 * value), "µm")


def settling_figure(result: ScenarioResult, one: Evaluated) -> ReportFigure:
    """Deviation from the target after each arrival, with the window."""
    window = float(one.evaluation.settings["window"])
    stops = [stop for stop in result.scenario.trajectory.stops if stop.direction and stop.leave > stop.arrival]
    figure = new_figure(3.4)
    axes = figure.subplots()
    axes.axhspan(-1e6 * window, 1e6 * window, color="#e8f1f8")
    for stop in stops[:_MOST_STOPS]:
        near = (result.time >= stop.arrival - 0.2 * (stop.leave - stop.arrival)) & (result.time < stop.leave)
        deviation = 1e6 * stop.direction * (result.series["table_position"][near] - stop.target)
        label = f"{1e3 * stop.target:.6g} mm {'from below' if stop.direction > 0 else 'from above'}"
        axes.plot(*envelope(1e3 * (result.time[near] - stop.arrival), deviation, 2000), linewidth=0.9, label=label)
    settled = cast(tuple[Settling, ...], one.figure)
    times = [point.time for point in settled if math.isfinite(point.time)]
    largest = max([4e6 * window, *(1.2e6 * point.overshoot for point in settled)])
    axes.set_ylim(-largest, largest)
    dress(axes, "time after the set-point's arrival [ms]", "beyond target [µm]")
    if len(stops) <= _LABELLED:
        legend_above(axes, 4)
    slowest = f"{1e3 * max(times):.3g} ms" if times else "never"
    text = f"Window ±{micrometres(window)} shaded; slowest settling {slowest} of {len(times)} of {len(settled)} stops"
    return ReportFigure("settling", "Settling at the targets", text, figure)


def positioning_figure(result: ScenarioResult, one: Evaluated) -> ReportFigure:
    """Deviation over target, both directions with ±2 s."""
    p = cast(Positioning, one.figure)
    figure = new_figure(3.8)
    axes = figure.subplots()
    sides = ((p.mean_up, p.deviation_up, AFTER, "along +"), (p.mean_down, p.deviation_down, BEFORE, "along −"))
    for mean, spread, colour, label in sides:
        axes.plot(1e3 * p.target, 1e6 * mean, "o-", color=colour, markersize=3, linewidth=1.0, label=label)
        low, high = 1e6 * (mean - 2 * spread), 1e6 * (mean + 2 * spread)
        axes.fill_between(1e3 * p.target, low, high, color=colour, alpha=0.18, linewidth=0)
    dress(axes, "target [mm]", "deviation [µm]", f"actual minus target, mean and ± 2 s, {EDITION}")
    legend_above(axes, 2)
    figures = (("A", p.accuracy), ("E", p.systematic), ("M", p.mean_range), ("B", p.reversal_value),
               ("R", p.repeatability))  # fmt: skip
    text = ", ".join(f"{name} {micrometres(value)}" for name, value in figures)
    return ReportFigure("positioning", "Accuracy and repeatability of positioning", text, figure)


def circular_figure(result: ScenarioResult, one: Evaluated) -> ReportFigure:
    """Radial deviation around the circle, magnified, and over the angle."""
    c = cast(Circular, one.figure)
    figure = new_figure(4.2)
    left, right = figure.add_subplot(1, 2, 1, projection="polar"), figure.add_subplot(1, 2, 2)
    largest = max(float(np.max(np.abs(c.radial))), 1e-12)
    step = max(1, len(c.angle) // 4000)
    polar = cast("PolarAxes", left)
    polar.plot(c.angle[::step], 1 + _RIM * c.radial[::step] / largest, color=AFTER, linewidth=0.8)
    polar.plot(np.linspace(0, 2 * math.pi, 361), np.ones(361), color=NOISE, linewidth=0.8, linestyle="--")
    polar.set_ylim(0, 1 + 1.1 * _RIM)
    polar.set_yticks([])
    # the axis that moves reverses at the top and at the bottom, as sin of the angle does
    polar.tick_params(labelsize=8)
    polar.set_title(f"nominal circle dashed, its rim ±{micrometres(largest / _RIM * _RIM)}", fontsize=9, loc="left")
    degrees = np.degrees(np.mod(c.angle[::step], 2 * math.pi))
    order = np.argsort(degrees, kind="stable")
    right.plot(degrees[order], 1e6 * c.radial[::step][order], ".", color=AFTER, markersize=1.2)
    right.set_xticks([0, 90, 180, 270, 360])
    dress(right, "angle [°], the axis reverses at 90° and 270°", "radial deviation [µm]")
    glitches = f"{micrometres(c.glitch[0])} at + and {micrometres(c.glitch[1])} at − (positive outwards)"
    second = "the second axis is ideal, of the same gain and lag"
    text = f"Circular deviation G {micrometres(c.deviation)}, quadrant glitches {glitches}; {second}"
    return ReportFigure("circular", "Circular test of one axis", text, figure)


def friction_figure(result: ScenarioResult, one: Evaluated) -> ReportFigure:
    """Mean torque over velocity, both directions."""
    points = cast(tuple[FrictionPoint, ...], one.figure)
    figure = new_figure(3.6)
    axes = figure.subplots()
    for side, colour, label, style in ((1, AFTER, "along +", "o-"), (-1, BEFORE, "along −, sign turned", "s--")):
        some = [point for point in points if side * point.velocity > 0]
        speed, torque = ([60 * side * p.velocity for p in some], [side * p.torque for p in some])
        spread = [point.spread for point in some]
        filled = "full" if side > 0 else "none"
        axes.errorbar(speed, torque, spread, fmt=style, color=colour, markersize=6 - 2 * side, linewidth=1, capsize=2,
                      label=label, fillstyle=filled)  # fmt: skip
    _plain_logarithm(axes)
    highest = max((abs(point.torque) + point.spread for point in points), default=0.0)
    axes.set_ylim(0, 1.1 * highest if highest > 0 else None)
    dress(axes, "velocity [m/min]", "torque at the motor [N m]", "mean and standard deviation at constant velocity")
    legend_above(axes, 2)
    factor = 1 / result.scenario.plant.chain.motor_radius
    right = axes.secondary_yaxis("right", functions=(_times(factor), _times(1 / factor)))
    right.set_ylabel("as a force at the table [N]", fontsize=9)
    right.tick_params(labelsize=8.5, color="#888888")
    right.spines["right"].set_color("#888888")
    text = "Friction over velocity; the force is the torque times 2π / lead, without any efficiency"
    return ReportFigure("friction_map", "Friction map", text, figure)


def _times(factor: float) -> Callable[[Any], Any]:
    return lambda values: np.asarray(values, dtype=float) * factor


def force_loop_figure(result: ScenarioResult, one: Evaluated) -> ReportFigure:
    """Displacement over force."""
    loop = cast(ForceLoop, one.figure)
    start, period = (float(one.evaluation.settings[key]) for key in ("start", "period"))
    chosen = (result.time >= start) & (result.time < start + period)
    figure = new_figure(3.6)
    axes = figure.subplots()
    position = result.series["table_position"][chosen]
    axes.plot(result.series["cutting_force"][chosen], 1e6 * (position - position[0]), color=AFTER, linewidth=1)
    dress(axes, "force on the table [N]", "displacement [µm]")
    text = (f"Stiffness {with_unit(significant(1e-6 * loop.stiffness), 'N/µm')}, lost motion "
            f"{micrometres(loop.width)}, work of a loop {with_unit(significant(1e3 * loop.work), 'mJ')}")  # fmt: skip
    return ReportFigure("force_loop", "Force and displacement", text, figure)


def torque_loop_figure(result: ScenarioResult, one: Evaluated) -> ReportFigure:
    """Motor torque over table position."""
    loop = cast(TorqueLoop, one.figure)
    start, period = (float(one.evaluation.settings[key]) for key in ("start", "period"))
    chosen = (result.time >= start) & (result.time < start + period)
    figure = new_figure(3.6)
    axes = figure.subplots()
    position = result.series["table_position"][chosen]
    factor, unit = (1e6, "µm") if loop.stroke < 1e-3 else (1e3, "mm")
    axes.plot(factor * (position - position.min()), result.series["motor_torque"][chosen], color=AFTER, linewidth=1)
    dress(axes, f"table position, from its lowest [{unit}]", "motor torque [N m]")
    friction = f"{with_unit(significant(loop.friction), 'N m')}, {with_unit(significant(loop.force), 'N')} at the table"
    text = f"Friction {friction}; the torque turns within {micrometres(loop.reversal)} after a reversal"
    return ReportFigure("torque_loop", "Torque over slow reversals", text, figure)


_SHOWN: dict[str, tuple[float, str]] = {
    "m": (1e3, "mm"), "m/s": (60.0, "m/min"), "rad/s": (30 / math.pi, "rev/min"), "rad": (0.5 / math.pi, "rev"),
}  # fmt: skip


def step_figure(result: ScenarioResult, one: Evaluated) -> ReportFigure:
    """The series about its step."""
    figures, settings = cast(StepResponse, one.figure), one.evaluation.settings
    name, at = str(settings["channel"]), float(settings["at"])
    factor, unit = _SHOWN.get(SERIES[name], (1.0, SERIES[name]))
    settled = math.isfinite(figures.settling)
    lasts = 4 * figures.settling if settled else float(result.time[-1]) - at
    span = max(lasts, 20 * result.scenario.sample_time)
    near = (result.time >= at - 0.15 * span) & (result.time <= at + span)
    figure = new_figure(3.4)
    axes = figure.subplots()
    axes.plot(1e3 * (result.time[near] - at), factor * result.series[name][near], color=AFTER, linewidth=1.1)
    axes.axhline(factor * figures.final, color=NOISE, linewidth=0.8, linestyle="--")
    dress(axes, "time after the step [ms]", f"{name.replace('_', ' ')} [{unit}]")
    text = (f"Rise 10 to 90 % in {1e3 * figures.rise:.3g} ms, overshoot {100 * figures.overshoot:.3g} %, "
            + (f"within 2 % after {1e3 * figures.settling:.3g} ms" if settled else "not settled"))  # fmt: skip
    return ReportFigure("step", "Step response", text, figure)


def response_figure(result: ScenarioResult, one: Evaluated) -> ReportFigure:
    """Magnitude, phase and coherence of a measured frequency response, and what the linear plant says."""
    r, settings = cast(Response, one.figure), one.evaluation.settings
    given, output = str(settings["input"]), str(settings["output"])
    figure = new_figure(6.0)
    top, middle, bottom = figure.subplots(3, 1, sharex=True, height_ratios=[3, 2, 1])
    linear = linear_response(result, given, output, r.frequency)
    if linear is not None:
        _response_curve(top, middle, r.frequency, linear, BEFORE, "linear, about the mean velocity", 2.6)
    _response_curve(top, middle, r.frequency, r.response, MEASURED, "as measured on the axis", 0.9)
    bottom.plot(r.frequency, r.coherence, color=MEASURED, linewidth=0.9)
    units = f"{SERIES[output]} per {SERIES[given]}"
    dress(top, "", f"magnitude [dB, {units}]", f"{output} over {given}".replace("_", " "))
    legend_above(top, 2)
    dress(middle, "", "phase [°]")
    middle.set_yticks([-180, -90, 0, 90, 180])
    dress(bottom, "frequency [Hz]", "coherence")
    bottom.set_ylim(0, 1.05)
    _plain_logarithm(bottom)
    text = f"{r.averages} averages; friction, reversals and limits are in what is measured, not in the linear curve"
    return ReportFigure("response", "Frequency response", text, figure)


def _response_curve(
    top: Axes,
    middle: Axes,
    frequency: FloatArray,
    response: ComplexArray | FloatArray,
    colour: str,
    label: str,
    width: float,
) -> None:
    options: dict[str, Any] = {"color": colour, "linewidth": width}
    top.plot(frequency, 20 * np.log10(np.abs(response)), label=label, **options)
    phase = np.degrees(np.angle(response))
    phase[1:][np.abs(np.diff(phase)) > 180] = np.nan  # no stroke from -180 to 180
    middle.plot(frequency, phase, **options)


def _plain_logarithm(axes: Axes) -> None:
    """A logarithmic abscissa with 10, 100, 1000 in place of powers."""
    from matplotlib.ticker import FuncFormatter, NullFormatter

    axes.set_xscale("log")
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
