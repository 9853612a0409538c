"""The figures that a scenario asks for, from its finished run; all in SI units, ready for JSON."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from feeddrive.errors import InputError
from feeddrive.metrology.circular import Circular, circular
from feeddrive.metrology.following import Following, Settling, following, settling
from feeddrive.metrology.loops import ForceLoop, FrictionPoint, TorqueLoop, force_loop, friction_map, torque_loop
from feeddrive.metrology.positioning import EDITION, Positioning, positioning
from feeddrive.metrology.response import Response, StepResponse, measured_response, periodic_response, step_response
from feeddrive.simulate.scenario.scenario import Evaluation, ScenarioResult
from feeddrive.simulate.setpoints.trajectories import Circle, Wave
from feeddrive.simulate.setpoints.waveforms import Multisine, Prbs, Sweep, Waveform
from feeddrive.typing import BoolArray, FloatArray, IntegerArray

Figure = (
    Following
    | tuple[Settling, ...]
    | Positioning
    | Circular
    | tuple[FrictionPoint, ...]
    | ForceLoop
    | TorqueLoop
    | StepResponse
    | Response
)

_CONSTANT = 1e-9
"""Set acceleration below which a velocity counts as constant [m/s^2]."""


@dataclass(frozen=True)
class Evaluated:
    """A figure and what asked for it."""

    evaluation: Evaluation
    figure: Figure


def evaluate(result: ScenarioResult) -> tuple[Evaluated, ...]:
    """All figures that the scenario asks for, in its order.

    Raises:
        InputError: a figure that the run cannot give; says what it needs.
    """
    return tuple(Evaluated(wanted, _EVALUATORS[wanted.kind](result, wanted)) for wanted in result.scenario.evaluations)


def as_json(evaluated: Evaluated) -> dict[str, Any]:
    """A figure as plain values; infinite and missing numbers are None."""
    figure = evaluated.figure
    content: dict[str, Any] = {"kind": evaluated.evaluation.kind, **evaluated.evaluation.settings}
    if isinstance(figure, tuple):
        content["points"] = [_plain(asdict(point)) for point in figure]
    elif isinstance(figure, Circular):
        content |= {k: v for k, v in _plain(asdict(figure)).items() if k not in ("angle", "radial")}
    elif isinstance(figure, Response):
        content |= {
            "frequency": _plain(figure.frequency),
            "magnitude": _plain(np.abs(figure.response)),
            "phase": _plain(np.angle(figure.response)),
            "coherence": _plain(figure.coherence),
            "averages": figure.averages,
        }
    else:
        content |= _plain(asdict(figure))
    if isinstance(figure, Positioning):
        content["standard"] = EDITION
    return content


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [_plain(item) for item in value]
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    return value.item() if isinstance(value, np.generic) else value


def _number(evaluation: Evaluation, key: str, default: float) -> float:
    return float(evaluation.settings.get(key, default))


def _following(result: ScenarioResult, wanted: Evaluation) -> Following:
    chosen = _between(result, _number(wanted, "start", 0.0), _number(wanted, "end", math.inf))
    return following(result.series["setpoint"][chosen], result.series["table_position"][chosen])


def _between(result: ScenarioResult, start: float, end: float) -> BoolArray:
    chosen: BoolArray = (result.time >= start) & (result.time < end)
    return chosen


def _settling(result: ScenarioResult, wanted: Evaluation) -> tuple[Settling, ...]:
    window, position = _number(wanted, "window", 0.0), result.series["table_position"]
    end = result.time[-1] + result.scenario.sample_time
    found = [
        settling(result.time, position, stop.target, stop.direction, stop.arrival, min(stop.leave, end), window)
        for stop in result.scenario.trajectory.stops
        if stop.direction and stop.arrival < end and stop.leave > stop.arrival
    ]
    if not found:
        raise InputError("the set-point stops nowhere", "evaluate settling", "choose a trajectory with stops")
    return tuple(found)


def _positioning(result: ScenarioResult, wanted: Evaluation) -> Positioning:
    average, position = _number(wanted, "average", 0.0), result.series["table_position"]
    found: dict[tuple[float, int], list[float]] = {}
    for stop in result.scenario.trajectory.stops[1:]:
        standing = position[_between(result, max(stop.arrival, stop.leave - average), stop.leave)]
        if len(standing):
            found.setdefault((stop.target, stop.direction), []).append(float(standing.mean()) - stop.target)
    both = sorted({target for target, _ in found if (target, 1) in found and (target, -1) in found})
    runs = {len(found[target, side]) for target in both for side in (1, -1)}
    if len(runs) != 1 or min(runs) < 2:
        raise InputError(
            "targets are not approached alike", "evaluate positioning", "use a staircase of two runs or more"
        )
    up, down = (np.array([found[target, side] for target in both]) for side in (1, -1))
    return positioning(np.array(both), up, down)


def _circular(result: ScenarioResult, _: Evaluation) -> Circular:
    circle = result.scenario.trajectory
    if not isinstance(circle, Circle):
        raise InputError("the set-point is no circle", "evaluate circular", 'use kind = "circle"')
    angle = circle.angle(result.time)
    chosen = steady_turn(angle, result.time)
    return circular(angle[chosen], result.series["table_position"][chosen], circle.radius)


def steady_turn(angle: FloatArray, time: FloatArray) -> IntegerArray:
    """The samples of a circle looked at: whole turns at constant feed, without the first where there are more.

    `angle` along the circle [rad] rises over `time` [s], both (n,). Raises InputError where nothing moves.
    """
    rate = np.gradient(angle, time)
    if not rate.max() > 0:
        raise InputError("the run ends before the circle begins", "evaluate circular", "make the run longer")
    steady = np.flatnonzero(np.abs(rate - rate.max()) < 1e-6 * rate.max())
    last = angle[steady[-1]]
    turns = math.floor((last - angle[steady[0]]) / (2 * math.pi) + 1e-9)
    # whole turns at constant feed, the last ones: the first turn after the run-up is still settling
    return steady[angle[steady] > last - 2 * math.pi * max(1, turns - 1)] if turns > 1 else steady


def _friction_map(result: ScenarioResult, wanted: Evaluation) -> tuple[FrictionPoint, ...]:
    motion = result.scenario.trajectory.at(result.time)
    constant = (np.abs(motion.acceleration) < _CONSTANT) & (np.abs(motion.velocity) > 0)
    skipped = round(_number(wanted, "skip", 0.0) / result.scenario.sample_time)
    constant = _without_first(constant, skipped)
    velocity = np.where(constant, motion.velocity, 0.0)
    lead = 2 * math.pi * result.scenario.plant.chain.motor_radius
    return friction_map(velocity, result.series["motor_torque"], lead)


def _without_first(mask: BoolArray, count: int) -> BoolArray:
    """The mask without the first `count` samples of each of its runs, nor the last one."""
    index = np.arange(len(mask))
    begins = mask & ~np.concatenate([[False], mask[:-1]])
    since = index - np.maximum.accumulate(np.where(begins, index, 0))
    kept: BoolArray = mask & (since >= count)
    kept[:-1] &= mask[1:]
    return kept


def _loop(result: ScenarioResult, wanted: Evaluation) -> BoolArray:
    """The samples of a loop from `start` over `period`."""
    start, period = _number(wanted, "start", 0.0), _number(wanted, "period", 0.0)
    chosen = _between(result, start, start + period)
    if chosen.sum() < 10:
        raise InputError("fewer than ten samples in the loop", f"evaluate {wanted.kind}", "choose start and period")
    return chosen


def _force_loop(result: ScenarioResult, wanted: Evaluation) -> ForceLoop:
    chosen = _loop(result, wanted)
    return force_loop(result.series["cutting_force"][chosen], result.series["table_position"][chosen])


def _torque_loop(result: ScenarioResult, wanted: Evaluation) -> TorqueLoop:
    chosen, lead = _loop(result, wanted), 2 * math.pi * result.scenario.plant.chain.motor_radius
    return torque_loop(result.series["table_position"][chosen], result.series["motor_torque"][chosen], lead)


def _step(result: ScenarioResult, wanted: Evaluation) -> StepResponse:
    return step_response(result.time, result.series[str(wanted.settings["channel"])], _number(wanted, "at", 0.0))


def _response(result: ScenarioResult, wanted: Evaluation) -> Response:
    chosen = result.time >= _number(wanted, "start", 0.0)
    given, output = (result.series[str(wanted.settings[key])][chosen] for key in ("input", "output"))
    excitation, tick = result.scenario.excitation, result.scenario.sample_time
    waveform = excitation.waveform if excitation else None
    if isinstance(waveform, Multisine):
        period = round(waveform.period / tick)
        if abs(period * tick - waveform.period) > 1e-9 * waveform.period:
            raise InputError("a period is no whole number of samples", "evaluate response", "change period or rate")
        return periodic_response(given, output, tick, period, waveform.frequencies)
    segment = max(8, round(_number(wanted, "segment", 0.0) / tick))
    trajectory = result.scenario.trajectory
    lowest, highest = _band(waveform or (trajectory.waveform if isinstance(trajectory, Wave) else None))
    return measured_response(given, output, tick, segment).between(lowest, highest)


def _band(waveform: Waveform | None) -> tuple[float, float]:
    """The frequencies that a waveform excites [Hz]; all of them where there is none."""
    if isinstance(waveform, Sweep | Multisine):
        return waveform.low, waveform.high
    return 0.0, 0.45 / waveform.bit if isinstance(waveform, Prbs) else math.inf


_EVALUATORS: dict[str, Callable[[ScenarioResult, Evaluation], Figure]] = {
    "following": _following,
    "settling": _settling,
    "positioning": _positioning,
    "circular": _circular,
    "friction_map": _friction_map,
    "force_loop": _force_loop,
    "torque_loop": _torque_loop,
    "step": _step,
    "response": _response,
}
"""One for every kind of `simulate.scenario_evaluations.KINDS`."""
