"""A plant whose motor torque is held over every sample: under a given torque, or under a command asked at each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np

from feeddrive.engine.engine import Feed, Machine, machine_of, rested, run_machine
from feeddrive.engine.program import TOLERANCE, Program, StepReport
from feeddrive.engine.step.linear_part import Layout
from feeddrive.engine.step.step import torque_step
from feeddrive.engine.timing import timing_of
from feeddrive.errors import InputError
from feeddrive.plant.motor_torque import acting_torque, warn_beyond_top
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import chain_symbols, parameter_symbols, parameter_values, per_structure
from feeddrive.plant.transmission_law import travel_deviation
from feeddrive.typing import Expression, FloatArray

Command = Callable[[Expression, Expression, Expression], tuple[Expression, Expression]]
"""(what is fed at the sample, readings, settings) -> (controller output, motor torque [N m]).

The readings: motor angle [rad], motor speed [rad/s], table position [m], table velocity [m/s].
"""


@dataclass(frozen=True)
class SampledRun:
    """What happens at the samples, shape (n,).

    Attributes:
        time: [s] as given.
        output: of the controller, in its unit.
        torque: motor torque commanded at the sample, before any delay [N m].
        motor_angle: [rad].
        position, velocity: of the table [m, m/s].
        report: how the steps went.
    """

    time: FloatArray
    output: FloatArray
    torque: FloatArray
    motor_angle: FloatArray
    position: FloatArray
    velocity: FloatArray
    report: StepReport


@dataclass(frozen=True)
class TorqueRun:
    """Motion of a plant under a given motor torque, at the samples, shape (n,); see `SampledRun` for the units."""

    time: FloatArray
    torque: FloatArray
    position: FloatArray
    velocity: FloatArray
    motor_angle: FloatArray
    report: StepReport


def simulate_torque(
    plant: Plant,
    time: FloatArray,
    torque: FloatArray,
    initial_position: float = 0.0,
    initial_velocity: float = 0.0,
    tolerance: float = TOLERANCE,
) -> TorqueRun:
    """Motion of the plant under a motor torque held over every sample; before the start its first value acts.

    Args:
        plant: with its values.
        time: sample times, evenly spaced [s], shape (n,).
        torque: motor torque from each sample to the next [N m], shape (n,).
        initial_position: of the table [m]; the transmission starts without force.
        initial_velocity: of the table [m/s].
        tolerance: error of the table position that a step may make [m].

    Returns:
        The motion.

    Raises:
        InputError: times that are not evenly spaced, lengths that differ, or a motion that cannot be followed.
    """
    before = float(torque[0]) if len(torque) else 0.0
    start = initial_state(plant, initial_position, initial_velocity)
    run = run_samples(plant, held, np.zeros(0), time, torque, start, before, tolerance)
    return TorqueRun(run.time, run.torque, run.position, run.velocity, run.motor_angle, run.report)


def held(fed: Expression, readings: Expression, settings: Expression) -> tuple[Expression, Expression]:
    """The command that passes on the torque it is fed."""
    return fed, fed


def run_samples(
    plant: Plant,
    command: Command,
    settings: FloatArray,
    time: FloatArray,
    fed: FloatArray,
    start: FloatArray,
    torque_before: float,
    tolerance: float = TOLERANCE,
) -> SampledRun:
    """The plant under a command, sample by sample.

    Args:
        plant: with its values.
        command: a function of a module, so that its machine can be kept.
        settings: of the command, shape (s,).
        time: sample times, evenly spaced [s], shape (n,).
        fed: what the command is fed at each sample, shape (n,).
        start: state of the chain, coordinates and rates, from `initial_state`.
        torque_before: motor torque before the start [N m].
        tolerance: error of the table position that a step may make [m].

    Returns:
        The run.

    Raises:
        InputError: as `simulate_torque`.
    """
    sample = even_sample_time(plant.name, time, len(fed), fed)
    timing = timing_of(plant, sample)
    machine = _machine(plant, command, len(settings), timing.late, len(timing.parts))
    own = np.full(timing.past, torque_before)
    feed = Feed(np.column_stack([fed, time - time[0]]), sample * np.array(timing.parts), settings)
    outcome = run_machine(machine, plant, feed, rested(machine, start, own), tolerance)
    output, torque, angle, _, position, velocity = np.ascontiguousarray(outcome.seen.T)
    warn_beyond_top(plant, torque)
    return SampledRun(time, output, torque, angle, position, velocity, outcome.report)


def initial_state(plant: Plant, position: float, velocity: float) -> FloatArray:
    """Coordinates and rates [SI] with the table at `position` [m] and `velocity` [m/s] and no stretch anywhere."""
    values, r = parameter_values(plant), plant.chain.radius
    travel = _travel(plant) if plant.has_travel else None
    angle, by_angle, by_position = position / r, 0.0, 0.0
    if travel is not None:
        for _ in range(20):  # delta' is far below r: each pass gains some three digits
            angle = (position - float(travel(angle, position, values)[0])) / r
        _, by_angle, by_position = (float(value) for value in travel(angle, position, values))
    if not plant.chain.elastic:
        return np.array([r * angle, velocity])
    speed = velocity * (1 - by_position) / (r + by_angle)
    motion = np.array(plant.chain.rigid_motion(plant.chain_values()), dtype=float)
    # the shafts turn as for r angle, the table is where it is wanted
    return np.concatenate([r * angle * motion[:-1], [position], r * speed * motion[:-1], [velocity]])


@per_structure
def _travel(plant: Plant) -> ca.Function:
    """(phi, x, parameters) -> travel deviation [m] and its slopes with phi and x."""
    symbols = parameter_symbols(plant)
    phi, x = ca.SX.sym("phi"), ca.SX.sym("x")
    delta = travel_deviation(plant, symbols, phi, x, 0.0)
    return ca.Function("travel", [phi, x, symbols.vector], [delta, ca.jacobian(delta, phi), ca.jacobian(delta, x)])


@per_structure
def _machine(plant: Plant, command: Command, settings: int, late: int, parts: int) -> Machine:
    """What runs a plant under a command with so many settings; further arguments as in `Timing`."""
    return machine_of(torque_program(plant, command, settings, late, parts))


def torque_program(plant: Plant, command: Command, settings: int, late: int, parts: int) -> Program:
    """The program of a plant under a command: torques of earlier samples that still act are its own memory."""
    step = torque_step(plant)
    past = late + parts - 1
    memory, own, fed = ca.SX.sym("memory", step.layout.memory), ca.SX.sym("own", past), ca.SX.sym("fed", 2)
    chosen, symbols = ca.SX.sym("settings", settings), parameter_symbols(plant)
    values = symbols.vector
    readings = readings_of(plant, step.layout)(memory, fed[1], values)
    output, torque = command(fed[0], readings, chosen)
    torques = ca.vertcat(own, torque)  # oldest first
    held_inputs = ca.vertcat(*[ca.vertcat(acting_torque(plant, symbols, torques[i]), 0) for i in range(parts)])
    arguments = [memory, own, fed, chosen, values]
    seen = ca.vertcat(output, torque, readings)
    after_own = torques[1:] if past else own
    before = ca.Function("feeddrive_before", arguments, [after_own, held_inputs, seen])
    after = ca.Function("feeddrive_after", arguments, [ca.SX.zeros(0, 1)])
    return Program(step, before, after, parts, plant.chain.varies)


def readings_of(plant: Plant, layout: Layout) -> ca.Function:
    """(memory, time, parameters) -> readings of a `Command`."""
    symbols = parameter_symbols(plant)
    p = chain_symbols(plant, symbols)
    memory, time = ca.SX.sym("memory", layout.memory), ca.SX.sym("time")
    n = layout.coordinates
    q, rate = memory[:n], memory[n : 2 * n]
    motor, screw, table = (ca.horzcat(*row(p)) for row in (plant.chain.motor, plant.chain.screw, plant.chain.table))
    x = ca.mtimes(table, q)
    if not plant.chain.elastic:
        x = x + travel_deviation(plant, symbols, ca.mtimes(screw, q), x, time)
    readings = ca.vertcat(ca.mtimes(motor, q), ca.mtimes(motor, rate), x, ca.mtimes(table, rate))
    return ca.Function("readings", [memory, time, symbols.vector], [readings])


def even_sample_time(name: str, time: FloatArray, count: int, *series: FloatArray) -> float:
    """Sample time [s] of `count` even times; refuses uneven or fewer than two, other lengths, series not finite.

    `name` is that of the plant, for the message.
    """
    if len(time) < 2 or len(time) != count:
        raise InputError(f"{len(time)} times and {count} values", name, "give two samples or more of each")
    if not all(np.isfinite(values).all() for values in (time, *series)):
        raise InputError("a time or an input is not a number", name, "leave out or fill these samples")
    sample = float(time[-1] - time[0]) / (len(time) - 1)
    uneven = np.abs(time - time[0] - sample * np.arange(len(time))).max()
    if sample <= 0 or uneven > 1e-3 * sample:
        raise InputError("the times are not evenly spaced", name, "resample them")
    return sample
