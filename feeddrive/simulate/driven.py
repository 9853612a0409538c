"""The load side driven by the measured motor motion: what torque and table position the plant expects.

Life that a motion takes from the nuts of a plant's ball screw: the driven plant gives the force, parts the life.

The force of the nut on the table follows from the motor's motion through the plant's own equations (mass, friction,
weight); a cutting force is added as the screw holds it, without the dynamics between. The preload is shared rigidly
(`feeddrive.parts.screw.double_nut`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np
from scipy.interpolate import make_interp_spline
from scipy.ndimage import uniform_filter1d

from feeddrive.effects.base import TransmissionEffect
from feeddrive.engine.engine import Feed, rested, run_machine
from feeddrive.engine.program import Position, StepReport, joined
from feeddrive.parts.life.consumed_life import ConsumedLife, consumed_life, rigid_nut_forces
from feeddrive.plant.analysis.rated_life import preload_of
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import parameter_values
from feeddrive.simulate.driven_machine import driven_machine, riding_on_flank
from feeddrive.simulate.row_steps import at_rate, at_rows, at_steps, on_grid, step_count
from feeddrive.typing import FloatArray, IntegerArray

TOLERANCE = 1e-10
"""Error of the table position that one step may make [m]: the springs to the motor forget it within milliseconds."""

STRETCH = 2**16
"""Grid steps that are run at a time, about: what the engine is fed and shows takes several times the room of what is
kept of it."""

GRID = 0.5e-3
"""Time between the steps of a motion at most [s]: what friction does in a reversal comes to the motor by the torsion
of the screw, which lets little through beyond 1 kHz."""

TABLE, TORQUE, FORCE = 2, 4, 5
"""Places of the table position, the motor torque, and the nut's force on the table, among what is shown."""

LEANING = 1e-6
"""Stretch beyond a flank [m] that the search for the load's rest on it begins with: within the play is no slope."""

TURNS = 5
"""Steps of that search: one where spring and friction are straight, each doubles the digits where they are not."""


@dataclass(frozen=True, eq=False)
class FlankRests:
    """Samples from which the load is known to ride on one flank of a play, pushed by the motor.

    Attributes:
        samples: rising, shape (k,).
        sides: direction in which the motor pushes, +1 or -1, shape (k,).
        forgotten: samples in which a load on a flank forgets how it came to it.
        period: samples of its ringing there.
        ringing: rms of it that counts as rest [m]; 0 where every rest begins anew.
    """

    samples: IntegerArray
    sides: FloatArray
    forgotten: int = 1
    period: int = 1
    ringing: float = 0.0

    def at_steps(self, every: int) -> FlankRests:
        """The first steps of so many rows that the rests have begun at."""
        forgotten, period = (-(-samples // every) for samples in (self.forgotten, self.period))
        return FlankRests(-(-self.samples // every), self.sides, forgotten, period, self.ringing)


@dataclass(frozen=True, eq=False)
class MotorMotion:
    """Motor motion on a grid with `substeps` steps per sample; each is a key of its own.

    Attributes:
        time: grid [s], shape (m,).
        angle, speed: on the grid [rad, rad/s].
        acceleration: on the grid [rad/s^2], shape (m,).
        substeps: grid steps per sample.
        every: samples that one step of a simulation takes, of a grid without substeps.
    """

    time: FloatArray
    angle: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    substeps: int
    every: int = 1

    @property
    def samples(self) -> slice:
        """The samples within the grid."""
        return slice(None, None, self.substeps)

    def timed(self, time: FloatArray) -> MotorMotion:
        """The motion with its samples at other times [s], (n,)."""
        return replace(self, time=on_grid(time, self.substeps))

    @cached_property
    def steps(self) -> MotorMotion:
        """The motion that a simulation follows, a sample at each of its steps."""
        if self.every == 1:
            return self
        last = self.time[-1] + self.every * (self.time[1] - self.time[0])
        time = np.append(self.time[:: self.every], last)[: step_count(len(self.time), self.every)]
        speed, acceleration = (at_steps(one, self.every, is_rate=True) for one in (self.speed, self.acceleration))
        return MotorMotion(time, at_steps(self.angle, self.every), speed, acceleration, self.substeps)


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

    def torque_at(self, motion: MotorMotion) -> FloatArray:
        """Torque at the samples of the motion whose steps this is at, (n,)."""
        return self.torque if motion.every == 1 else at_rows(self.torque, motion.every, len(motion.angle))

    def table_at(self, motion: MotorMotion, radius: float) -> FloatArray:
        """Table position at the samples of that motion, (n,), by what it is beyond `radius` [m/rad] times the angle."""
        if motion.every == 1:
            return self.table_position
        beyond = at_rows(self.table_position - radius * self.motor_angle, motion.every, len(motion.angle))
        position: FloatArray = radius * motion.angle + beyond
        return position

    def at(self, motion: MotorMotion, radius: float) -> LoadMotion:
        """All of it at the samples of that motion."""
        if motion.every == 1:
            return self
        phi, rate, velocity, force = (
            at_rows(one, motion.every, len(motion.angle))
            for one in (self.screw_angle, self.screw_speed, self.table_velocity, self.force)
        )
        position, torque = self.table_at(motion, radius), self.torque_at(motion)
        given = motion.time, motion.angle, motion.speed
        return LoadMotion(*given, phi, rate, position, velocity, torque, force, self.report)


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


def simulate_driven(
    plant: Plant, motion: MotorMotion, tolerance: float = TOLERANCE, rests: FlankRests | None = None
) -> LoadMotion:
    """Load side and motor torque of the plant at the samples of a motor motion, starting at rest without stretch.

    A step may be wrong by `tolerance` [m] at the table. Where the load of a plant with play is known to rest on a
    flank it begins anew on it. A motor that is given takes no power from a bounce: a landing that the encoder's error
    has shifted goes on bouncing where the machine rests (multiple shooting: Bock and Plitt, IFAC Proceedings 17 (1984)
    1603). Raises SimulationError for a motion that cannot be followed; it says when, and which effect to look at.
    """
    return simulate_steps(plant, motion, tolerance, rests).at(motion, plant.chain.motor_radius)


def simulate_steps(
    plant: Plant, motion: MotorMotion, tolerance: float = TOLERANCE, rests: FlankRests | None = None
) -> LoadMotion:
    """`simulate_driven` at the steps of the motion alone.

    A step of k rows may be wrong by a k-th: slopes are differences of runs, and show where the engine changes its
    steps. Those of rows are hardly ever halved; where a spring bends, longer ones with the tolerance of rows made some
    slopes several times as uncertain.
    """
    if motion.every > 1:
        rests = rests and rests.at_steps(motion.every)
        return simulate_steps(plant, motion.steps, tolerance / motion.every, rests)
    machine, outputs, beginning = driven_machine(plant)
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
    anew = _anew(plant, rests)

    def resting(sample: int) -> bool:
        if rests is None:
            return False
        past = slice(max(0, sample + 1 - rests.forgotten - rests.period), sample + 1)
        behind = shown[TABLE, past] - plant.chain.motor_radius * motion.angle[motion.samples][past]
        return _rests_there(behind, shown[FORCE, past], anew[sample], rests)

    begun_at = sorted({*range(0, count - 1, max(1, STRETCH // motion.substeps)), *anew})
    reports = []
    for sample, end in zip(begun_at, [*begun_at[1:], count - 1], strict=True):
        if sample in anew and not resting(sample):
            at = sample * motion.substeps
            given = motion.angle[at], motion.speed[at], motion.acceleration[at], motion.time[at]
            rigid = np.array(beginning(*given[:2], values)).ravel()
            riding = riding_on_flank(plant, machine.program.step.layout)
            place = _on_flank(place, rigid, anew[sample], riding, (*given, values))
            shown[:, sample] = np.array(outputs(place.memory, *given, values)).ravel()
            torque[at] = shown[TORQUE, sample]
        length = end - sample
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


def _rests_there(behind: FloatArray, force: FloatArray, place: float, rests: FlankRests) -> bool:
    """Whether a simulated load rests on the flank of that place as the recorded one does.

    It goes on then: begun anew it would ride on the flank without what the motor excites, which no rest is free of.

    Args:
        behind: way of the table behind the motor, for as long as a contact takes to forget and a period before [m],
            (n,).
        force: of the nut on the table there [N], (n,).
        place: of the nut against the table [m].
        rests: which say what counts as rest.
    """
    ringing, half = behind - uniform_filter1d(behind, rests.period), rests.period // 2
    inner = ringing[half : len(ringing) - half]
    quiet = len(inner) > 0 and float(np.mean(inner**2)) < rests.ringing**2
    return quiet and float(np.mean(force)) * place > 0


def _anew(plant: Plant, rests: FlankRests | None) -> dict[int, float]:
    """Sample to the place of the nut against the table in which a plant with play begins anew there [m]."""
    play = sum(e.free_play(e.values) for e in plant.effects if isinstance(e, TransmissionEffect) and e.has_play)
    if rests is None or not plant.chain.elastic or not float(play) > 0:
        return {}
    places = rests.sides * (0.5 * float(play) + LEANING)
    return dict(zip(rests.samples.tolist(), places.tolist(), strict=True))


def _on_flank(
    place: Position,
    rigid: FloatArray,
    stretch: float,
    riding: ca.Function,
    given: tuple[float, float, float, float, FloatArray],
) -> Position:
    """The load where it moves with the motor on a flank; its bristles slide on as they do.

    Args:
        place: where the run is; kept where the load does not come to rest on that flank.
        rigid: coordinates and rates without stretch, (2 n,).
        stretch: of the nut to begin with [m].
        riding: from `riding_on_flank`.
        given: of the motor angle, speed and acceleration, time, parameters.
    """
    memory, free = place.memory.copy(), len(rigid) // 2
    memory[: 2 * free] = rigid
    memory[:free] -= stretch * np.array(riding(memory, *given)[2]).ravel()
    for _ in range(TURNS):
        error, slope, _ = (np.array(one) for one in riding(memory, *given))
        if not (np.isfinite(error).all() and np.isfinite(slope).all()):
            return place
        moved = np.linalg.lstsq(slope, error[:, 0], rcond=None)[0]
        memory[:free] -= moved
        if np.max(np.abs(moved)) <= TOLERANCE:
            return Position(memory, place.own, place.level)
    return place


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
