"""Figures of motions: a finished scenario, a run of the nonlinear machine, and loops before and after tuning."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.metrology.circular import Circular
from feeddrive.metrology.evaluate import Evaluated
from feeddrive.metrology.loop_trial import LoopTrial, Ran
from feeddrive.report.figures.drawing import AFTER, BEFORE, MEASURED, ReportFigure, dress, legend_above, new_figure
from feeddrive.report.figures.figure_metrology import (
    circular_figure,
    force_loop_figure,
    friction_figure,
    positioning_figure,
    response_figure,
    settling_figure,
    step_figure,
    torque_loop_figure,
)
from feeddrive.report.figures.thinning import envelope
from feeddrive.report.words.number_text import scale_for_signal
from feeddrive.simulate.scenario.scenario import ScenarioResult
from feeddrive.typing import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes


_DRAWERS: dict[str, Callable[[ScenarioResult, Evaluated], ReportFigure]] = {
    "settling": settling_figure,
    "positioning": positioning_figure,
    "circular": circular_figure,
    "friction_map": friction_figure,
    "force_loop": force_loop_figure,
    "torque_loop": torque_loop_figure,
    "step": step_figure,
    "response": response_figure,
}


def scenario_figures(result: ScenarioResult, evaluated: tuple[Evaluated, ...]) -> Iterator[ReportFigure]:
    """The figures of a run, one at a time so that few are in memory at once."""
    yield motion_figure(result)
    seen: dict[str, int] = {}
    for one in evaluated:
        kind = one.evaluation.kind
        if kind in _DRAWERS:
            seen[kind] = seen.get(kind, 0) + 1
            drawn = _DRAWERS[kind](result, one)
            stem = drawn.stem if seen[kind] == 1 else f"{drawn.stem}_{seen[kind]}"
            yield ReportFigure(stem, drawn.title, drawn.caption, drawn.figure)


def motion_figure(result: ScenarioResult) -> ReportFigure:
    """Position, following error, velocity, torque and, where there is one, the force over time."""
    series, time = result.series, result.time
    forced = bool(np.any(series["cutting_force"]))
    figure = new_figure(8.4 if forced else 7.2)
    panels = list(figure.subplots(5 if forced else 4, 1, sharex=True))
    _line(panels[0], time, 1e3 * series["setpoint"], BEFORE, "set-point", 2.4)
    _line(panels[0], time, 1e3 * series["table_position"], MEASURED, "table")
    dress(panels[0], "", "position [mm]", result.scenario.name)
    legend_above(panels[0], 2)
    error = series["setpoint"] - series["table_position"]
    factor, unit = (1e6, "µm") if np.max(np.abs(error)) < 2e-3 else (1e3, "mm")
    _line(panels[1], time, factor * error, AFTER)
    dress(panels[1], "", f"following error [{unit}]", "set-point minus table position")
    _line(panels[2], time, 60 * series["table_velocity"], AFTER)
    dress(panels[2], "", "velocity [m/min]")
    _line(panels[3], time, series["motor_torque"], AFTER)
    dress(panels[3], "", "motor torque [N m]")
    if forced:
        _line(panels[4], time, series["cutting_force"], AFTER)
        dress(panels[4], "", "force on table [N]")
    panels[-1].set_xlabel("time [s]", fontsize=9)
    panels[-1].set_xlim(float(time[0]), float(time[-1]))
    figure.align_ylabels(panels)
    text = "The motion over time. Following error is set-point minus actual position; a deviation has the other sign."
    return ReportFigure("motion", "Motion", text, figure)


def _line(axes: Axes, time: FloatArray, values: FloatArray, colour: str, label: str = "", width: float = 0.9) -> None:
    axes.plot(*envelope(time, values, 2500), color=colour, linewidth=width, label=label or None)


_PANELS = {"table_position": "m", "table_velocity": "m/s", "motor_torque": "N m"}


def run_figure(name: str, time: FloatArray, series: Mapping[str, FloatArray]) -> ReportFigure:
    """Panels of what a run has of position, velocity and torque.

    Args:
        name: of the machine.
        time: [s], shape (n,).
        series: name to samples, SI, shape (n,) each.
    """
    shown = [one for one in _PANELS if one in series]
    figure = new_figure(1.0 + 1.9 * len(shown))
    panels = figure.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
    for axes, one in zip(panels, shown, strict=True):
        scale = scale_for_signal(one, float(abs(series[one]).max()), _PANELS[one])
        if one == "motor_torque" and "command" in series:
            axes.plot(time, scale.factor * series["command"], color=BEFORE, linewidth=0.8, label="command")
            axes.plot(time, scale.factor * series[one], color=AFTER, linewidth=1.0, label="motor")
            legend_above(axes, 2)
        else:
            axes.plot(time, scale.factor * series[one], color=AFTER, linewidth=1.0)
        dress(axes, "time [s]" if axes is panels[-1] else "", f"{one.replace('_', ' ')} [{scale.unit}]")
    return ReportFigure("run", name, "Exact values at the ticks, before any sensor.", figure)


_LOOKS = ((BEFORE, "present"), (AFTER, "recommended"))


def retuned_step_figure(before: Sequence[LoopTrial], after: Sequence[LoopTrial]) -> ReportFigure | None:
    """Table position after a small step, every case; None where no step was run."""
    figure = new_figure(3.2)
    axes = figure.subplots()
    drawn = False
    for some, (colour, name) in zip((before, after), _LOOKS, strict=True):
        for place, one in enumerate(ran.step for ran in some if ran.step is not None):
            series = one.result.series
            axes.plot(
                1e3 * one.result.time,
                1e6 * (series["table_position"] - series["setpoint"][0]),
                color=colour,
                lw=1.0,
                label=name if not place else None,
            )
            drawn = True
    if not drawn:
        return None
    dress(axes, "time [ms]", "table position [µm]", "Step of the position")
    axes.legend(fontsize=8, frameon=False)
    return ReportFigure(
        "retuned_step", "Step of the position", "Every position and payload; friction and limits act.", figure
    )


def retuned_circle_figure(before: Sequence[LoopTrial], after: Sequence[LoopTrial]) -> ReportFigure | None:
    """Radial deviation over the angle of the circle, every case; None where no circle was run."""
    figure = new_figure(3.2)
    axes = figure.subplots()
    drawn = False
    for some, (colour, name) in zip((before, after), _LOOKS, strict=True):
        for place, found in enumerate(_radial(ran.circle) for ran in some if ran.circle is not None):
            axes.plot(*found, color=colour, lw=1.0, label=name if not place else None)
            drawn = True
    if not drawn:
        return None
    dress(axes, "angle along the circle [°]", "radial deviation [µm]", "Circle of 5 mm at 3 m/min")
    axes.legend(fontsize=8, frameon=False)
    caption = "Every position and payload; the axis reverses at 90° and 270°, where friction leaves its glitch."
    return ReportFigure("retuned_circle", "Circle", caption, figure)


def _radial(ran: Ran) -> tuple[np.ndarray, np.ndarray]:
    assert isinstance(ran.figure, Circular)
    angle = np.degrees(ran.figure.angle - ran.figure.angle[0])
    return angle, 1e6 * ran.figure.radial
