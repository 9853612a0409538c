"""The load side driven by the measured motor motion: what torque and table position the plant expects.

Life that a motion takes from the nuts of a plant's ball screw: the driven plant gives the force, parts the life.

The force of the nut on the table follows from the motor's motion through the plant's own equations (mass, friction,
weight); a cutting force is added as the screw holds it, without the dynamics between. The preload is shared rigidly
(`feeddrive.parts.screw.double_nut`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
from scipy.interpolate import make_interp_spline
from scipy.signal import firwin

from feeddrive.engine.engine import Feed, Machine, machine_of, rested, run_machine
from feeddrive.engine.program import Program, StepReport, joined
from feeddrive.engine.step.linear_part import Layout
from feeddrive.engine.step.step import driven_step
from feeddrive.parts.life.consumed_life import ConsumedLife, consumed_life, rigid_nut_forces
from feeddrive.plant.analysis.rated_life import preload_of
from feeddrive.plant.chain.chain import symbolic
from feeddrive.plant.equations import effect_forces
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import chain_symbols, parameter_symbols, parameter_values, per_structure
from feeddrive.plant.transmission_law import travel_deviation
from feeddrive.typing import FloatArray

TOLERANCE = 1e-10
"""Error of the table position that one step may make [m]: the springs to the motor forget it within milliseconds."""

STRETCH = 2**16
"""Grid steps that are run at a time, about: what the engine is fed and shows takes several times the room of what is
kept of it."""

GRID = 0.5e-3
"""Time between the steps of a motion at most [s]: what friction does in a reversal comes to the motor by the torsion
of the screw, which lets little through beyond 1 kHz."""

TAPS, KAISER = 4, 7.86
"""Samples on either side over which a torque is averaged, and the window's shape: flat to 3e-4 up to a tenth of the
sample rate, and 1e-4 of what comes back to there from nine tenths and beyond (Kaiser, 80 dB)."""

TORQUE = 4
"""Place of the motor torque among what is shown."""

PASSES = 3
"""For the table position at the start; travel per length is below 1e-3, so each gains three digits."""


@dataclass(frozen=True, eq=False)
class MotorMotion:
    """Motor motion on a grid with `substeps` steps per sample; each is a key of its own.

    Attributes:
        time: grid [s], shape (m,).
        angle, speed: on the grid [rad, rad/s].
        acceleration: on the grid [rad/s^2], shape (m,).
        substeps: grid steps per sample.
    """

    time: FloatArray
    angle: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    substeps: int

    @property
    def samples(self) -> slice:
        """The samples within the grid."""
        return slice(None, None, self.substeps)

    def timed(self, time: FloatArray) -> MotorMotion:
        """The motion with its samples at other times [s], (n,)."""
        return replace(self, time=on_grid(time, self.substeps))


@dataclass(frozen=True)
class LoadMotion:
    """What the plant does when its motor moves as given, at the samples, shape (n,).

    Attributes:
        motor_angle, motor_speed: as given [rad, rad/s].
        screw_angle, screw_speed: [rad, rad/s].
        table_position, table_velocity: [m, m/s].
        torque: motor torque needed, without timing effects [N m], as far as samples at this rate tell it: what a
            reversal does between two of them is not taken for something slow.
        force: of the nut on the table [N]; 0 where the structure is rigid.
        report: how the steps went.
    """

    time: FloatArray
    motor_angle: FloatArray
    motor_speed: FloatArray
    screw_angle: FloatArray
    screw_speed: FloatArray
    table_position: FloatArray
    table_velocity: FloatArray
    torque: FloatArray
    force: FloatArray
    report: StepReport

    @property
    def size(self) -> int:
        """Bytes of what the run has computed."""
        own = (self.screw_angle, self.screw_speed, self.table_position, self.table_velocity, self.torque, self.force)
        return sum(series.nbytes for series in own)


def motor_motion(time: FloatArray, angle: FloatArray, substeps: int | None = None) -> MotorMotion:
    """Speed and acceleration of an angle [rad] at even times [s], (n,), by a quintic spline through the samples.

    The grid has `substeps` steps per sample, or as many as make them no longer than `GRID`.
    """
    return motor_motions(time, angle[:, None], substeps)[0]


def motor_motions(time: FloatArray, angles: FloatArray, substeps: int | None = None) -> list[MotorMotion]:
    """Several motions at the same times, (n, k): their splines have one matrix, and one set of basis functions."""
    # about the start of the record, so that the spline's conditioning does not depend on the clock
    spline = make_interp_spline(time - time[0], angles, k=5)
    if substeps is None:
        substeps = max(1, math.ceil((time[1] - time[0]) / GRID - 1e-6))
    fine = np.linspace(0.0, time[-1] - time[0], (len(time) - 1) * substeps + 1)
    angle, speed, acceleration = (np.ascontiguousarray(spline(fine, order).T) for order in range(3))
    return [MotorMotion(fine, *each, substeps) for each in zip(angle, speed, acceleration, strict=True)]


def simulate_driven(plant: Plant, motion: MotorMotion, tolerance: float = TOLERANCE) -> LoadMotion:
    """Load side and motor torque of the plant at the samples of a motor motion, starting at rest without stretch.

    A step may be wrong by `tolerance` [m] at the table. Raises SimulationError for a motion that cannot be followed; it
    says when, and which effect to look at.
    """
    machine, outputs, beginning = _machine(plant)
    values = np.array(parameter_values(plant))
    states = np.zeros(0)
    if machine.program.step.layout.coordinates:
        states = np.array(beginning(motion.angle[0], motion.speed[0], values)).ravel()
    place = rested(machine, states, np.zeros(0))
    step = np.array([motion.time[1] - motion.time[0]])
    count = len(motion.time[motion.samples])
    shown = np.empty((6, count))
    torque = shown[TORQUE] if motion.substeps == 1 else np.empty(len(motion.time))
    first = outputs(place.memory, motion.angle[0], motion.speed[0], motion.acceleration[0], 0.0, values)
    shown[:, 0] = np.array(first).ravel()
    torque[0] = shown[TORQUE, 0]
    length = max(1, STRETCH // motion.substeps)
    reports = []
    for sample in range(0, count - 1, length):
        fed = _fed(motion, sample, length)
        outcome = run_machine(machine, plant, Feed(fed, step, step), place, tolerance)
        shown[:, sample + 1 : sample + 1 + length] = outcome.seen[motion.substeps - 1 :: motion.substeps].T
        begun = sample * motion.substeps + 1
        torque[begun : begun + len(fed)] = outcome.seen[:, TORQUE]
        place = outcome.position
        reports.append(outcome.report)
    shown[TORQUE] = at_rate(torque, motion.substeps)
    at = motion.samples
    phi, rate, x, velocity, needed, force = shown
    kept = motion.time[at], motion.angle[at], motion.speed[at]
    return LoadMotion(*kept, phi, rate, x, velocity, needed, force, joined(reports))


def on_grid(series: FloatArray, substeps: int) -> FloatArray:
    """Samples, (n,), and straight between them, on a grid; (m,)."""
    at = np.arange((len(series) - 1) * substeps + 1) / substeps
    return np.interp(at, np.arange(len(series)), series) if substeps > 1 else series


def at_rate(series: FloatArray, substeps: int) -> FloatArray:
    """A series on a grid of `substeps` a sample, (m,), as samples show it, (n,): without what folds back as slow.

    A drive holds its torque from row to row, and the rows of the motor's angle hold what a jump of friction between
    them did only as far as it moved the motor, that is hardly beyond their own rate. The torque that the plant asks for
    is taken as far, by a zero-phase filter; read at the rows alone, a jump would be early or late by half a row.
    """
    if substeps == 1:
        return series
    taps = firwin(2 * TAPS * substeps + 1, 1 / substeps, window=("kaiser", KAISER))
    filtered: FloatArray = np.convolve(np.pad(series, TAPS * substeps, mode="edge"), taps, mode="valid")
    return filtered[::substeps].copy()


def _fed(motion: MotorMotion, sample: int, count: int) -> FloatArray:
    """What the engine is fed from a sample on, for so many samples or what there are."""
    steps = slice(sample * motion.substeps, (sample + count) * motion.substeps)
    angle, speed = (series[steps.start : steps.stop + 1] for series in (motion.angle, motion.speed))
    acceleration = motion.acceleration[steps.start + 1 : steps.stop + 1]
    time = motion.time[steps.start : steps.stop + 1]
    return np.column_stack([angle[:-1], speed[:-1], angle[1:], speed[1:], acceleration, time[:-1]])


def unfollowed(motion: MotorMotion) -> LoadMotion:
    """A motion of no numbers, for searches that meet values with which the plant cannot be simulated."""
    at = motion.samples
    nothing = np.full(len(motion.time[at]), np.nan)
    report = StepReport(0, 0, 0, 0, 0, np.inf, 0, np.inf, np.inf)
    kept = motion.time[at], motion.angle[at], motion.speed[at]
    return LoadMotion(*kept, nothing, nothing, nothing, nothing, nothing, nothing, report)


@per_structure
def _machine(plant: Plant) -> tuple[Machine, ca.Function, ca.Function]:
    """What runs a structure, its outputs and its start."""
    step = driven_step(plant)
    outputs = _outputs(plant, step.layout)
    memory, own, fed, settings = (ca.SX.sym(*a) for a in (("m", step.layout.memory), ("o", 0), ("f", 6), ("s", 1)))
    values = ca.SX.sym("values", outputs.size1_in(5))
    arguments = [memory, own, fed, settings, values]
    read = outputs(memory, fed[2], fed[3], fed[4], fed[5] + settings[0], values)
    before = ca.Function("feeddrive_before", arguments, [own, fed[:4], ca.SX.zeros(0, 1)])
    after = ca.Function("feeddrive_after", arguments, [read])
    return machine_of(Program(step, before, after, 1, plant.chain.varies)), outputs, _start(plant)


def _start(plant: Plant) -> ca.Function:
    """(theta, theta', parameters) -> free coordinates and rates with no stretch anywhere, travel errors included."""
    symbols = parameter_symbols(plant)
    theta, speed, place = (ca.SX.sym(name) for name in ("theta", "speed", "place"))
    p = chain_symbols(plant, symbols)
    r, motion = p["lead"] / (2 * math.pi), plant.chain.rigid_motion(p)
    turned = theta / motion[0]  # r phi
    delta = travel_deviation(plant, symbols, turned / r, place, ca.SX(0))
    x = turned
    for _ in range(PASSES):
        (found,) = ca.substitute([delta], [place], [x])
        x = turned + found
    slopes = ca.substitute([ca.jacobian(delta, theta), ca.jacobian(delta, place)], [place], [x])
    velocity = speed * (1 / motion[0] + slopes[0]) / (1 - slopes[1])
    shafts = ca.vertcat(*[entry / motion[0] for entry in motion[1:-1]])
    return ca.Function(
        "start", [theta, speed, symbols.vector], [ca.vertcat(theta * shafts, x, speed * shafts, velocity)]
    )


def _outputs(plant: Plant, layout: Layout) -> ca.Function:
    """(memory, theta, theta', theta'', t, parameters) -> [phi, phi', x, x', motor torque, F of the nut].

    The torque is the motor's row of M q'' + C q' + K q = T + f; what rides with the motor on a common hub moves with
    the acceleration that the other rows give it.
    """
    symbols = parameter_symbols(plant)
    chain, p = plant.chain, chain_symbols(plant, symbols)
    memory = ca.SX.sym("memory", layout.memory)
    theta, speed, acceleration, time = (ca.SX.sym(name) for name in ("theta", "speed", "acceleration", "time"))
    free = layout.coordinates
    if chain.elastic:
        q, rate = ca.vertcat(theta, memory[:free]), ca.vertcat(speed, memory[free : 2 * free])
    else:
        q, rate = theta / chain.motor(p)[0], speed / chain.motor(p)[0]
    screw, table = ca.horzcat(*chain.screw(p)), ca.horzcat(*chain.table(p))
    phi, x = ca.mtimes(screw, q), ca.mtimes(table, q)
    z = memory[layout.states : layout.states + layout.bristles]
    found = effect_forces(plant, symbols, q, rate, z, time, None)
    mass, damping, stiffness = (symbolic(m(p, x)) for m in (chain.mass, chain.damping, chain.stiffness))
    unmoved = ca.mtimes(damping, rate) + ca.mtimes(stiffness, q) - found.on_coordinates  # M q'' = motor torque - this
    if chain.elastic:
        others = ca.solve(ca.sparsify(mass[1:, 1:]), -unmoved[1:] - mass[1:, 0] * acceleration)
        row = ca.vertcat(acceleration, others)
    else:
        row = acceleration / chain.motor(p)[0]
    torque = (ca.mtimes(mass[0, :], row) + unmoved[0]) / chain.motor(p)[0]
    if not chain.elastic:
        x = x + travel_deviation(plant, symbols, phi, x, time)
    result = ca.vertcat(phi, ca.mtimes(screw, rate), x, ca.mtimes(table, rate), torque, found.transmitted)
    return ca.Function("outputs", [memory, theta, speed, acceleration, time, symbols.vector], [result])


def used_life(
    plant: Plant, time: FloatArray, motor_angle: FloatArray, cutting_force: FloatArray | None = None
) -> ConsumedLife | None:
    """Life that the two nuts have used along a motion at even times [s], (n,), under a force on the table [N], (n,).

    Noise of the motor angle [rad], (n,), counts as rolling, so a recorded one is smoothed before. None where the file
    declares no `ball_screw.dynamic_rating`, or nothing is elastic, so that no force of a nut is known. Raises
    SimulationError for a motion that cannot be followed.
    """
    rating = plant.data["ball_screw.dynamic_rating"].value if "ball_screw.dynamic_rating" in plant.data else None
    if rating is None or not plant.chain.elastic:
        return None
    run = simulate_driven(plant, motor_motion(time, motor_angle))
    force = run.force if cutting_force is None else run.force - cutting_force
    return consumed_life(run.screw_angle, rigid_nut_forces(force, preload_of(plant)), rating)
