"""Single numbers of a finished run, for sweeps: name and SI unit of each.

Following error and motor torque of the whole run, then the figures that the scenario asks for; a figure's own order is
that of importance. Frequency responses give none.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from feeddrive.metrology.circular import Circular
from feeddrive.metrology.evaluate import Figure, evaluate
from feeddrive.metrology.following import Following, Settling, following
from feeddrive.metrology.loops import ForceLoop, FrictionPoint, TorqueLoop
from feeddrive.metrology.positioning import Positioning
from feeddrive.metrology.response import StepResponse
from feeddrive.simulate.scenario.scenario import SERIES, ScenarioResult
from feeddrive.simulate.sweep.sweep_unit import Metric

_UNITS: dict[type, dict[str, str]] = {
    Following: {"maximum": "m", "rms": "m", "mean": "m"},
    Settling: {"time": "s", "overshoot": "m", "deviation": "m"},
    Positioning: {
        "accuracy": "m",
        "repeatability": "m",
        "reversal_value": "m",
        "systematic": "m",
        "mean_range": "m",
        "mean_reversal": "m",
        "accuracy_up": "m",
        "accuracy_down": "m",
        "repeatability_up": "m",
        "repeatability_down": "m",
        "systematic_up": "m",
        "systematic_down": "m",
    },
    Circular: {"deviation": "m", "radial_maximum": "m", "radial_minimum": "m", "gain": "1", "lag": "rad"},
    FrictionPoint: {"torque": "N m", "velocity": "m/s", "spread": "N m", "force": "N"},
    ForceLoop: {"stiffness": "N/m", "width": "m", "work": "J", "displacement": "m"},
    TorqueLoop: {"friction": "N m", "reversal": "m", "offset": "N m", "force": "N", "stroke": "m"},
    StepResponse: {"settling": "s", "overshoot": "1", "rise": "s"},
}
"""Figure to its numbers and their SI units."""


def run_metrics(result: ScenarioResult) -> dict[str, Metric]:
    """All single numbers of a run, such as `following_error.rms` [m] and `settling.1.time` [s].

    Points of a figure are counted from 1; figures of a kind that is asked for again are called `kind_2`, and so on.

    Raises:
        InputError: a figure that the run cannot give.
    """
    found: dict[str, Metric] = {}
    seen: dict[str, int] = {}
    for one in evaluate(result):
        kind = one.evaluation.kind
        seen[kind] = seen.get(kind, 0) + 1
        stem = kind if seen[kind] == 1 else f"{kind}_{seen[kind]}"
        found |= dict(_of_figure(stem, one.figure))
        if isinstance(one.figure, StepResponse):
            found[f"{stem}.final"] = Metric(one.figure.final, SERIES[str(one.evaluation.settings["channel"])])
    whole = following(result.series["setpoint"], result.series["table_position"])
    torque = result.series["motor_torque"]
    return {
        **found,
        **dict(_numbers("following_error", whole)),
        "motor_torque.maximum": Metric(float(np.abs(torque).max()), "N m"),
        "motor_torque.rms": Metric(float(np.sqrt(np.mean(torque**2))), "N m"),
    }


def _of_figure(stem: str, figure: Figure) -> Iterator[tuple[str, Metric]]:
    if isinstance(figure, tuple):
        if figure and isinstance(figure[0], Settling):
            yield from _worst(stem, [point for point in figure if isinstance(point, Settling)])
        for number, point in enumerate(figure, 1):
            yield from _numbers(f"{stem}.{number}", point)
        return
    yield from _numbers(stem, figure)
    if isinstance(figure, Circular):
        for side, value in zip(("plus", "minus"), figure.glitch, strict=True):
            yield f"{stem}.glitch_{side}", Metric(value, "m")


def _worst(stem: str, points: list[Settling]) -> Iterator[tuple[str, Metric]]:
    """Worst of all arrivals: the longest settling, infinite if one never settles, and the largest overshoot."""
    yield f"{stem}.time", Metric(max(point.time for point in points), "s")
    yield f"{stem}.overshoot", Metric(max(point.overshoot for point in points), "m")


def _numbers(stem: str, figure: Any) -> Iterator[tuple[str, Metric]]:
    for name, unit in _UNITS.get(type(figure), {}).items():
        value = float(getattr(figure, name))
        yield f"{stem}.{name}", Metric(value if not math.isnan(value) else math.inf, unit)
