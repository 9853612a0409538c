"""The plant under a sampled controller: what a servo drive does, tick by tick.

At every tick the sensors are read, the controller is called, and its torque, within the limit, is held until the next.
The torque loop follows it after a dead time with a first-order lag, which is a state of the exact propagation:

    T'(t) = (u(t - dead time) - T(t)) / lag

| symbol | meaning | unit |
|---|---|---|
| u, T | torque command and motor torque | N m |

Sensors that declare a resolution are read in whole steps of it. The tick is an integer that counts on over resumed
runs.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from feeddrive.effects.base import DriveEffect
from feeddrive.engine.engine import Feed, Machine, rested, run_machine
from feeddrive.engine.program import TOLERANCE, Position, StepReport
from feeddrive.engine.timing import Timing
from feeddrive.errors import InputError
from feeddrive.plant.analysis.ode import state_names
from feeddrive.plant.equations import bristle_count
from feeddrive.plant.motor_torque import warn_beyond_top
from feeddrive.plant.plant import Plant
from feeddrive.servo.sampled_plant import SampledController
from feeddrive.simulate.controlled.controlled_machine import TorqueLoop, machine_for, resolutions_of
from feeddrive.simulate.held_torque import initial_state
from feeddrive.typing import FloatArray

__all__ = [
    "ControlledRun",
    "ControlledState",
    "TorqueLoop",
    "fed_of",
    "machine_for",
    "resting_state",
    "simulate_controlled",
    "state_from",
    "told_run",
]


@dataclass(frozen=True)
class ControlledState:
    """Everything a run needs to go on; a resumed run is the run that was never stopped, bit for bit.

    Attributes:
        tick: of the next sample.
        position: of the engine.
    """

    tick: int
    position: Position

    @property
    def vector(self) -> FloatArray:
        """The state as plain numbers, for a file; see `state_from`."""
        at = self.position
        return np.concatenate([[self.tick, at.level, at.cell, len(at.memory)], at.memory, at.own])


def state_from(vector: FloatArray) -> ControlledState:
    """The state that `ControlledState.vector` has written."""
    tick, level, cell, count = (int(number) for number in vector[:4])
    return ControlledState(tick, Position(vector[4 : 4 + count].copy(), vector[4 + count :].copy(), level, cell))


@dataclass(frozen=True)
class ControlledRun:
    """What happens at the ticks, shape (n,); what is measured is given as it is, before the sensors' steps.

    Attributes:
        time: of the ticks [s].
        command: torque asked for by the controller, within the limit [N m].
        torque: of the motor at the tick, constant times current [N m].
        motor_angle, motor_speed: [rad, rad/s].
        table_position, table_velocity: [m, m/s].
        signals: of the controller, by its names.
        states: of the plant, shape (n, k), in the order of `state_names` [SI].
        state_names: coordinates, their rates, bristles, as in `feeddrive.plant.analysis.linear`.
        end: state behind the last sample.
        report: how the steps went.
    """

    time: FloatArray
    command: FloatArray
    torque: FloatArray
    motor_angle: FloatArray
    motor_speed: FloatArray
    table_position: FloatArray
    table_velocity: FloatArray
    signals: Mapping[str, FloatArray]
    states: FloatArray
    state_names: tuple[str, ...]
    end: ControlledState
    report: StepReport = field(repr=False)


def simulate_controlled(
    plant: Plant,
    controller: SampledController,
    reference: FloatArray,
    load: FloatArray | None = None,
    torque_loop: TorqueLoop | None = None,
    start: ControlledState | None = None,
    quantised: bool = True,
    tolerance: float = TOLERANCE,
) -> ControlledRun:
    """The plant under a sampled controller.

    Args:
        plant: with its values; its torque limit and the resolution of its sensors apply.
        controller: what is called at every tick.
        reference: what it is fed, shape (n, number of its references), SI.
        load: cutting force on the table along + motion, held over each sample [N], shape (n,); none if None.
        torque_loop: lag and dead time of the motor torque; it follows at once if None.
        start: from `resting_state` or another run's `end`; at rest at 0 if None.
        quantised: whether the sensors' resolutions count.
        tolerance: error of the table position that a step may make [m].

    Returns:
        The run.

    Raises:
        InputError: shapes that do not fit, values that are not finite.
        SimulationError: a motion that cannot be followed; says when, and which effect to look at.
    """
    loop = torque_loop or TorqueLoop()
    steps = resolutions_of(plant, controller) if quantised else {}
    machine, timing = machine_for(plant, controller, loop, steps)
    begin = start or _at_rest(machine, timing, plant, controller, 0.0, 0.0)
    fed = fed_of(plant, controller, reference, load, begin.tick)
    _refuse_foreign(machine, begin, plant)
    settings = np.concatenate([controller.parameters, list(steps.values()), [plant.torque_limit]])
    feed = Feed(fed, controller.sample_time * np.array(timing.parts), settings, loop.lag)
    outcome = run_machine(machine, plant, feed, begin.position, tolerance)
    end = ControlledState(begin.tick + len(fed), outcome.position)
    return told_run(plant, controller, fed[:, -1], outcome.seen, end, outcome.report)


def resting_state(
    plant: Plant,
    controller: SampledController,
    torque_loop: TorqueLoop | None = None,
    position: float = 0.0,
    velocity: float = 0.0,
) -> ControlledState:
    """The state before tick 0: no stretch, no torque, the controller at its initial state; table in m and m/s."""
    machine, timing = machine_for(plant, controller, torque_loop or TorqueLoop(), resolutions_of(plant, controller))
    return _at_rest(machine, timing, plant, controller, position, velocity)


def _at_rest(
    machine: Machine, timing: Timing, plant: Plant, controller: SampledController, position: float, velocity: float
) -> ControlledState:
    own = np.concatenate([controller.initial, np.zeros(timing.past)])
    return ControlledState(0, rested(machine, initial_state(plant, position, velocity), own))


def fed_of(
    plant: Plant, controller: SampledController, reference: FloatArray, load: FloatArray | None, tick: int
) -> FloatArray:
    """References, cutting force, tick and time per sample."""
    count = len(reference)
    wanted = (count, len(controller.references))
    if count < 1 or np.shape(reference) != wanted:
        names = ", ".join(controller.references)
        raise InputError(
            f"references of shape {np.shape(reference)}", plant.name, f"give one column for each of {names}"
        )
    force = np.zeros(count) if load is None else np.asarray(load, dtype=float)
    if force.shape != (count,):
        raise InputError(f"{count} references and a load of shape {force.shape}", plant.name, "give as many of each")
    fed = np.empty((count, wanted[1] + 3))
    fed[:, :-3], fed[:, -3], fed[:, -2] = reference, force, np.arange(tick, tick + count)
    np.multiply(fed[:, -2], controller.sample_time, out=fed[:, -1])
    if not np.isfinite(fed).all():
        raise InputError("a reference or the load is not a number", plant.name, "leave out or fill these samples")
    return fed


def _refuse_foreign(machine: Machine, start: ControlledState, plant: Plant) -> None:
    sizes = machine.program.sizes
    if (len(start.position.memory), len(start.position.own)) != (sizes["N_MEMORY"], sizes["N_OWN"]):
        mend = "resume with the plant, controller and torque loop that it was made with"
        raise InputError("a start state of another plant or controller", plant.name, mend)


def told_run(
    plant: Plant,
    controller: SampledController,
    time: FloatArray,
    seen: FloatArray,
    end: ControlledState,
    report: StepReport,
) -> ControlledRun:
    names = state_names(plant)
    count = 2 * len(plant.chain.coordinates) + bristle_count(plant)
    signals = dict(zip(controller.signals, seen[:, 6 + count :].T, strict=True))
    command, torque, angle, speed, position, velocity = seen[:, :6].T
    if plant.effects_of(DriveEffect):
        warn_beyond_top(plant, torque)
    states = seen[:, 6 : 6 + count]
    return ControlledRun(time, command, torque, angle, speed, position, velocity, signals, states, names, end, report)
