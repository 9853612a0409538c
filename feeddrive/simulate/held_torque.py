"""A plant whose motor torque is held over every sample: one macro step per sample, and the run under a given torque.

A macro step asks a command for the torque of its sample and then takes a few steps of the plant with it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np

from feeddrive.errors import InputError
from feeddrive.plant.equations import chain_symbols, parameter_symbols, parameter_values, travel_deviation
from feeddrive.plant.plant import Plant
from feeddrive.simulate.loop import Loop, loop_of
from feeddrive.simulate.step import Layout, StepModel, torque_step
from feeddrive.simulate.structure import per_structure
from feeddrive.simulate.timing import Timing, timing_of
from feeddrive.typing import Expression, FloatArray

SUBSTEPS = 8
"""Steps per sample: an axis with tanh friction at 1 kHz is within 1 nm of the exact motion (4 steps: 1.5 nm)."""

Command = Callable[[Expression, Expression, Expression], tuple[Expression, Expression]]
"""(what is fed at the sample, readings, settings) -> (controller output, motor torque [N m]).

The readings: motor angle [rad], motor speed [rad/s], table position [m], table velocity [m/s].
"""


@dataclass(frozen=True)
class SampledPlant:
    """A macro step (memory, [fed, time], constants) -> (memory after, [output, torque, readings, correction])."""

    model: StepModel
    step: ca.Function
    loop: Loop


@dataclass(frozen=True)
class SampledRun:
    """What happens at the samples, shape (n,).

    Attributes:
        time: [s] as given.
        output: of the controller, in its unit.
        torque: motor torque commanded at the sample, before any delay [N m].
        motor_angle: [rad].
        position, velocity: of the table [m, m/s].
        correction: last Newton correction of the effect forces, largest over the run [N or N m].
    """

    time: FloatArray
    output: FloatArray
    torque: FloatArray
    motor_angle: FloatArray
    position: FloatArray
    velocity: FloatArray
    correction: float


@dataclass(frozen=True)
class TorqueRun:
    """Motion of a plant under a given motor torque, at the samples, shape (n,); see `SampledRun` for the units."""

    time: FloatArray
    torque: FloatArray
    position: FloatArray
    velocity: FloatArray
    motor_angle: FloatArray
    correction: float


def simulate_torque(
    plant: Plant, time: FloatArray, torque: FloatArray, initial_position: float = 0.0, initial_velocity: float = 0.0,
    substeps: int = SUBSTEPS,
) -> TorqueRun:  # fmt: skip
    """Motion of the plant under a motor torque held over every sample; before the start its first value acts.

    Args:
        plant: with its values.
        time: sample times, evenly spaced [s], shape (n,).
        torque: motor torque from each sample to the next [N m], shape (n,).
        initial_position: of the table [m]; the transmission starts without force.
        initial_velocity: of the table [m/s].
        substeps: plant steps per sample.

    Returns:
        The motion.

    Raises:
        InputError: times that are not evenly spaced, lengths that differ, or a motion that does not stay finite.
    """
    before = float(torque[0]) if len(torque) else 0.0
    start = initial_state(plant, initial_position, initial_velocity)
    run = run_samples(plant, held, np.zeros(0), time, torque, start, before, substeps)
    return TorqueRun(run.time, run.torque, run.position, run.velocity, run.motor_angle, run.correction)


def held(fed: Expression, readings: Expression, settings: Expression) -> tuple[Expression, Expression]:
    """The command that passes on the torque it is fed."""
    return fed, fed


def run_samples(
    plant: Plant, command: Command, settings: FloatArray, time: FloatArray, fed: FloatArray, start: FloatArray,
    torque_before: float, substeps: int,
) -> SampledRun:  # fmt: skip
    """The plant under a command, sample by sample.

    Args:
        plant: with its values.
        command: a function of a module, so that its machine can be kept.
        settings: of the command, shape (s,).
        time: sample times, evenly spaced [s], shape (n,).
        fed: what the command is fed at each sample, shape (n,).
        start: state of the chain, coordinates and rates, from `initial_state`.
        torque_before: motor torque before the start [N m].
        substeps: plant steps per sample.

    Returns:
        The run.

    Raises:
        InputError: as `simulate_torque`.
    """
    sample = _sample_time(plant, time, fed, substeps)
    timing = timing_of(plant, sample, substeps)
    machine = sampled_plant(plant, command, len(settings), timing.substeps, timing.late, len(timing.parts))
    memory = np.zeros(machine.step.size1_in(0))
    memory[: len(start)] = start
    memory[len(memory) - timing.past :] = torque_before
    inputs = np.column_stack([fed, time - time[0]])
    _, seen = machine.loop(memory, inputs, constants_of(machine, plant, timing, sample, settings))
    if not np.isfinite(seen).all():
        at = time[int(np.argmin(np.isfinite(seen).all(axis=1)))]
        raise InputError(f"the simulated motion does not stay finite after {at:g} s", plant.name, "use more substeps")
    output, torque, angle, _, position, velocity, correction = np.ascontiguousarray(seen.T)
    return SampledRun(time, output, torque, angle, position, velocity, float(correction.max()))


def initial_state(plant: Plant, position: float, velocity: float) -> FloatArray:
    """Coordinates and rates [SI] with the table at `position` [m] and `velocity` [m/s] and no stretch anywhere."""
    symbols = parameter_symbols(plant)
    phi, x = ca.SX.sym("phi"), ca.SX.sym("x")
    delta = travel_deviation(plant, symbols, phi, x, 0.0)
    slopes = [delta, ca.jacobian(delta, phi), ca.jacobian(delta, x)]
    travel = ca.Function("travel", [phi, x, symbols.vector], slopes)
    values, r = parameter_values(plant), plant.chain.radius
    angle = position / r
    for _ in range(20):  # delta' is far below r: each pass gains some three digits
        angle = (position - float(travel(angle, position, values)[0])) / r
    _, by_angle, by_position = (float(value) for value in travel(angle, position, values))
    if not plant.chain.elastic:
        return np.array([r * angle, velocity])
    speed = velocity * (1 - by_position) / (r + by_angle)
    return np.array([angle, angle, position, speed, speed, velocity])


def constants_of(
    machine: SampledPlant, plant: Plant, timing: Timing, sample: float, settings: FloatArray
) -> FloatArray:
    """Constants of a macro step: settings of the command, then those of the plant step for each part of the sample."""
    parts = [machine.model.constants(plant, part * sample / timing.substeps) for part in timing.parts]
    return np.concatenate([settings, *parts])


@per_structure
def sampled_plant(plant: Plant, command: Command, settings: int, substeps: int, late: int, parts: int) -> SampledPlant:
    """The macro step of a plant under a command with so many settings, and its loop; arguments as in `Timing`."""
    model = torque_step(plant)
    size, count = model.layout.memory, model.function.size1_in(3)
    duration = count - len(parameter_values(plant)) - 1  # where the constants of a step hold its length
    past = late + parts - 1
    # calls in an MX graph: the plant step is generated once, however many substeps there are
    memory, inputs = ca.MX.sym("memory", size + past), ca.MX.sym("inputs", 2)
    constants = ca.MX.sym("constants", settings + parts * count)
    chosen, *of_part = ca.vertsplit(constants, [0, *(settings + i * count for i in range(parts + 1))])
    readings = _readings(plant, model.layout)(memory[:size], inputs[1], of_part[0][duration + 1 :])
    output, torque = command(inputs[0], readings, chosen)
    torques = ca.vertcat(memory[size:], torque)  # oldest first
    state, time, correction = memory[:size], inputs[1], ca.MX(0)
    for i, fixed in enumerate(of_part):
        for _ in range(substeps):
            state, change = model.function(state, ca.vertcat(torques[i], 0), time, fixed)
            time = time + fixed[duration]
            correction = ca.fmax(correction, change)
    after = ca.vertcat(state, torques[1:]) if past else state
    seen = ca.vertcat(output, torque, readings, correction)
    step = ca.Function("feeddrive_step", [memory, inputs, constants], [after, seen])
    return SampledPlant(model, step, loop_of(step))


def _readings(plant: Plant, layout: Layout) -> ca.Function:
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


def _sample_time(plant: Plant, time: FloatArray, fed: FloatArray, substeps: int) -> float:
    """Sample time [s] of an even grid.

    Raises:
        InputError: fewer than two samples, uneven times, lengths that differ, values that are not finite, no substeps.
    """
    if len(time) < 2 or len(time) != len(fed):
        raise InputError(f"{len(time)} times and {len(fed)} values", plant.name, "give two samples or more of each")
    if substeps < 1:
        raise InputError(f"{substeps} substeps", plant.name, "use 1 or more")
    if not (np.isfinite(time).all() and np.isfinite(fed).all()):
        raise InputError("a time or an input is not a number", plant.name, "leave out or fill these samples")
    sample = float(time[-1] - time[0]) / (len(time) - 1)
    uneven = np.abs(time - time[0] - sample * np.arange(len(time))).max()
    if sample <= 0 or uneven > 1e-3 * sample:
        raise InputError("the times are not evenly spaced", plant.name, "resample them")
    return sample
