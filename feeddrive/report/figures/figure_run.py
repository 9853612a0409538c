"""Figure of a run of the nonlinear machine: position, velocity and torque over the time."""

from __future__ import annotations

from collections.abc import Mapping

from feeddrive.report.figures.drawing import AFTER, BEFORE, ReportFigure, dress, legend_above, new_figure
from feeddrive.report.words.people import scale_for_signal
from feeddrive.typing import FloatArray

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
