"""Figure of a servo cycle repeated over hours: temperatures, position error, drag torque and preload."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

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
from feeddrive.report.figures.figure_thermal import time_axis
from feeddrive.simulate.warm.warm_up_result import WarmUpRun
from feeddrive.thermal.full.full_model import FRONT, NUT, REAR, SHAFT
from feeddrive.typing import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_GREEN, _PINK = "#009e73", "#cc79a7"
_PARTS = {
    NUT: ("nut", BEFORE),
    SHAFT: ("shaft at the nut", AFTER),
    FRONT: ("front bearing", _GREEN),
    REAR: ("rear bearing", _PINK),
}


def warm_axis_figure(run: WarmUpRun) -> ReportFigure:
    """Four panels over the run's time."""
    factor, label = time_axis(float(run.time[-1]))
    time = factor * run.time
    figure = new_figure(9.4)
    heat, error, torque, preload = figure.subplots(4, 1, sharex=True, height_ratios=(3, 3, 2.6, 1.8))
    _temperatures(heat, run, time)
    _errors(error, run, time)
    _torques(torque, run, time)
    preload.plot(time, 1e-3 * run.figure_of_cycle("preload"), ".-", color=MEASURED)
    dress(preload, label, "preload [kN]", "preload of the nut; the marks are the cycles that were simulated")
    preload.set_xlim(0, time[-1])
    return ReportFigure("warm_axis", "An axis that warms up", _caption(run), figure)


def _temperatures(axes: Axes, run: WarmUpRun, time: FloatArray) -> None:
    for name, (words, colour) in _PARTS.items():
        axes.plot(time, run.temperature(name), color=colour, label=words)
    shades = (NOISE, "#5c5c5c", "#b08d57", "#7f7f00")
    for body, shade in zip(run.thermal.bodies, shades * len(run.thermal.bodies), strict=False):
        axes.plot(time, run.temperature(body.name), color=shade, ls="--", label=body.name.replace("_", " "))
    dress(axes, "", "temperature [°C]")
    legend_above(axes, 4)


def _errors(axes: Axes, run: WarmUpRun, time: FloatArray) -> None:
    for i, colour in zip(np.argsort(run.stops), (AFTER, BEFORE, _GREEN, _PINK) * len(run.stops), strict=False):
        axes.plot(time, 1e6 * run.stop_errors[:, i], color=colour, label=f"table at {1e3 * run.stops[i]:.4g} mm")
    dress(axes, "", "position error [µm]", "table position less target, at rest")
    legend_above(axes, 4)


def _torques(axes: Axes, run: WarmUpRun, time: FloatArray) -> None:
    axes.plot(time, run.figure_of_cycle("nut_torque"), color=BEFORE, label="nut")
    axes.plot(time, run.figure_of_cycle("bearing_torque"), color=_GREEN, label="bearings")
    axes.set_ylim(0, None)
    dress(axes, "", "drag torque [N m]", "at the screw, mean over the way of a cycle")
    legend_above(axes, 4)


def _caption(run: WarmUpRun) -> str:
    nut, errors = run.figure_of_cycle("nut_torque"), run.stop_errors
    worst = int(np.argmax(np.abs(errors[-1])))
    return (
        f"After {run.time[-1] / 3600:.3g} h the table is {1e6 * errors[-1, worst]:.1f} µm off at "
        f"{1e3 * run.stops[worst]:.4g} mm, and the nut drags with {nut[-1]:.3g} in place of {nut[0]:.3g} N m. "
        f"{run.cycles} cycles of {run.cycle_duration:.3g} s were simulated; of the work in "
        f"{100 * abs(run.energy.imbalance):.2g} % is not accounted for."
    )
