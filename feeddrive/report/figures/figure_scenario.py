"""Figures of a finished scenario: the motion over time, and one figure for every figure of metrology it asks for."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.metrology.evaluate import Evaluated
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
from feeddrive.report.thinning import envelope
from feeddrive.simulate.scenario.scenario_result import ScenarioResult
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
