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
from functools import lru_cache

import casadi as ca
import numpy as np

from feeddrive.errors import InputError
from feeddrive.plant.equations import bristle_count, parameter_symbols
from feeddrive.plant.linear import state_names
from feeddrive.plant.motor_torque import acting_torque, warn_beyond_top
from feeddrive.plant.plant import Plant
from feeddrive.servo.sampled import MEASUREMENTS, SampledController
from feeddrive.simulate.engine import Feed, Machine, machine_of, rested, run_machine
from feeddrive.simulate.held_torque import initial_state, readings_of
from feeddrive.simulate.program import TOLERANCE, Position, Program, StepReport
from feeddrive.simulate.step import torque_step
from feeddrive.simulate.structure import per_structure
from feeddrive.simulate.timing import Timing, timing_of
from feeddrive.typing import Expression, FloatArray


@dataclass(frozen=True)
class TorqueLoop:
    """How the motor torque follows its command.

    Attributes:
        lag: time constant [s]; 0 for none.
        dead_time: [s], of any length.

    Raises:
        InputError: a negative time.
    """

    lag: float = 0.0
    dead_time: float = 0.0

    def __post_init__(self) -> None:
        for name, value in (("lag", self.lag), ("dead time", self.dead_time)):
            if not 0 <= value < float("inf"):
                raise InputError(f"{name} {value:g} s", "torque loop", "give a time of 0 s or more")


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
    """What happens at the ticks, shape (n,); what is measured is told as it is, before the sensors' steps.

    Attributes:
        time: of the ticks [s].
        command: torque asked for by the controller, within the limit [N m].
        torque: of the motor at the tick, constant times current [N m].
        motor_angle, motor_speed: [rad, rad/s].
        table_position, table_velocity: [m, m/s].
        signals: of the controller, by its names.
        states: of the plant, shape (n, k), in the order of `state_names` [SI].
        state_names: coordinates, their rates, bristles, as in `feeddrive.plant.linear`.
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
    plant: Plant, controller: SampledController, reference: FloatArray, load: FloatArray | None = None,
    torque_loop: TorqueLoop | None = None, start: ControlledState | None = None, quantised: bool = True,
    tolerance: float = TOLERANCE,
) -> ControlledRun:  # fmt: skip
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
    begin = start or resting_state(plant, controller, loop)
    fed = fed_of(plant, controller, reference, load, begin.tick)
    _refuse_foreign(machine, begin, plant)
    settings = np.concatenate([controller.parameters, list(steps.values()), [plant.torque_limit]])
    feed = Feed(fed, controller.sample_time * np.array(timing.parts), settings, loop.lag)
    outcome = run_machine(machine, plant, feed, begin.position, tolerance)
    end = ControlledState(begin.tick + len(fed), outcome.position)
    return told_run(plant, controller, fed[:, -1], outcome.seen, end, outcome.report)


def resting_state(
    plant: Plant, controller: SampledController, torque_loop: TorqueLoop | None = None, position: float = 0.0,
    velocity: float = 0.0,
) -> ControlledState:  # fmt: skip
    """The state before tick 0: no stretch, no torque, the controller at its initial state.

    Args:
        plant: with its values.
        controller: that will run.
        torque_loop: as for the run.
        position: of the table [m].
        velocity: of the table [m/s].
    """
    machine, timing = machine_for(plant, controller, torque_loop or TorqueLoop(), resolutions_of(plant, controller))
    own = np.concatenate([controller.initial, np.zeros(timing.past)])
    return ControlledState(0, rested(machine, initial_state(plant, position, velocity), own))


def machine_for(
    plant: Plant, controller: SampledController, loop: TorqueLoop, steps: Mapping[str, float], tangents: bool = False
) -> tuple[Machine, Timing]:
    """The machine of a controlled run and how its torque meets the samples."""
    timing = timing_of(plant, controller.sample_time, loop.dead_time)
    key = ControllerKey(controller.function, controller.measurements, tuple(steps))
    return controlled_machine(plant, key, loop.lag > 0, timing.late, len(timing.parts), tangents), timing


@lru_cache(maxsize=64)
def _written(function: ca.Function) -> str:
    """The function as text, once per function: runs of one controller follow one another."""
    return function.serialize()


class ControllerKey:
    """A controller's equations; two functions with the same content are one."""

    def __init__(self, function: ca.Function, measurements: tuple[str, ...], quantised: tuple[str, ...]) -> None:
        self.function, self.measurements, self.quantised = function, measurements, quantised
        self._content = (_written(function), measurements, quantised)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ControllerKey) and self._content == other._content

    def __hash__(self) -> int:
        return hash(self._content)


@per_structure
def controlled_machine(
    plant: Plant, key: ControllerKey, lagging: bool, late: int, parts: int, tangents: bool
) -> Machine:
    """What runs a plant under a controller; `late` and `parts` as in `Timing`."""
    step, function = torque_step(plant, lagging), key.function
    layout, past, kept = step.layout, late + parts - 1, function.size1_in(0)
    references = function.size1_in(1)
    memory, own = ca.SX.sym("memory", layout.memory), ca.SX.sym("own", kept + past)
    fed = ca.SX.sym("fed", references + 3)
    settings = ca.SX.sym("settings", function.size1_in(4) + len(key.quantised) + 1)
    symbols = parameter_symbols(plant)
    values = symbols.vector
    readings = readings_of(plant, layout)(memory, fed[references + 2], values)
    measured = _measured(key, readings, settings[function.size1_in(4) :])
    after, asked, signals = function(
        own[:kept], fed[:references], measured, fed[references + 1], settings[: function.size1_in(4)]
    )
    limit = settings[settings.numel() - 1]
    command = ca.fmin(ca.fmax(asked, -limit), limit)
    torques = ca.vertcat(own[kept:], command)  # oldest first
    asked_for = [torques[i] for i in range(parts)]
    given = asked_for if lagging else [acting_torque(plant, symbols, torque) for torque in asked_for]
    held = ca.vertcat(*[ca.vertcat(torque, fed[references]) for torque in given])
    acting = memory[layout.states - 1] if lagging else torques[0]
    states = ca.vertcat(memory[: 2 * layout.coordinates], memory[layout.states : layout.states + layout.bristles])
    seen = ca.vertcat(command, acting, readings, states, signals)
    arguments = [memory, own, fed, settings, values]
    own_after = ca.vertcat(after, torques[1:] if past else ca.SX.zeros(0, 1))
    before = ca.Function("feeddrive_before", arguments, [own_after, held, seen])
    nothing = ca.Function("feeddrive_after", arguments, [ca.SX.zeros(0, 1)])
    return machine_of(Program(step, before, nothing, parts, plant.chain.varies, tangents))


def _measured(key: ControllerKey, readings: Expression, steps: Expression) -> Expression:
    """What the controller reads, in whole steps where a sensor has them."""
    columns = []
    for name in key.measurements:
        reading = readings[list(MEASUREMENTS).index(name)]
        if name in key.quantised:
            step = steps[key.quantised.index(name)]
            reading = step * ca.floor(reading / step + 0.5)
        columns.append(reading)
    return ca.vertcat(*columns)


def resolutions_of(plant: Plant, controller: SampledController) -> dict[str, float]:
    """Measurement to resolution, of those that have one."""
    declared = {sensor.channel: sensor.resolution for sensor in plant.sensors}
    return {name: declared[name] for name in controller.measurements if declared.get(name, 0.0) > 0}


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
    if not (np.isfinite(reference).all() and np.isfinite(force).all()):
        raise InputError("a reference or the load is not a number", plant.name, "leave out or fill these samples")
    ticks = np.arange(tick, tick + count, dtype=float)
    return np.column_stack([reference, force, ticks, ticks * controller.sample_time])


def _refuse_foreign(machine: Machine, start: ControlledState, plant: Plant) -> None:
    sizes = machine.program.sizes
    if (len(start.position.memory), len(start.position.own)) != (sizes["N_MEMORY"], sizes["N_OWN"]):
        mend = "resume with the plant, controller and torque loop that it was made with"
        raise InputError("a start state of another plant or controller", plant.name, mend)


def told_run(
    plant: Plant, controller: SampledController, time: FloatArray, seen: FloatArray, end: ControlledState,
    report: StepReport,
) -> ControlledRun:  # fmt: skip
    names = state_names(plant)
    count = 2 * len(plant.chain.coordinates) + bristle_count(plant)
    signals = dict(zip(controller.signals, np.ascontiguousarray(seen[:, 6 + count :].T), strict=True))
    command, torque, angle, speed, position, velocity = np.ascontiguousarray(seen[:, :6].T)
    warn_beyond_top(plant, torque)
    states = seen[:, 6 : 6 + count]
    return ControlledRun(
        time, command, torque, angle, speed, position, velocity, signals, states, names, end, report
    )  # fmt: skip
