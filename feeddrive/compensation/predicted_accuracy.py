"""What a machine will do with a table: positioning after ISO 230-2 and a circle after ISO 230-4, simulated.

The plant runs under its controller, the position loop closed at the motor, with the table applied as the control
applies it (`compensation.applied`). One approach per direction and target: nothing in the simulation scatters, so that
the repeatability R is the reversal alone. Motion is gentle: where there is play, accelerations stay at a quarter of
what friction at the table can hold, or the table would cross the play by its inertia. Friction that is declared without
presliding creeps at rest and would let go of the table at every stop; it is given a bristle for the prediction.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from feeddrive.compensation.applied import AxisLimits, motor_setpoint
from feeddrive.compensation.forms.control import Control
from feeddrive.compensation.lost_motion import LostMotion
from feeddrive.compensation.table import CompensationTable
from feeddrive.effects.base import BristleEffect, Port
from feeddrive.effects.friction.presliding import Presliding
from feeddrive.errors import InputError
from feeddrive.metrology.circular import Circular, circular
from feeddrive.metrology.positioning import Positioning, positioning
from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import Cascade
from feeddrive.servo.cascade_function import REFERENCES, cascade_controller
from feeddrive.simulate.controlled.controlled import TorqueLoop, resting_state, simulate_controlled
from feeddrive.simulate.setpoints.setpoint_motion import Limits, Motion, Pieces, Trajectory
from feeddrive.simulate.setpoints.trajectories import Circle, staircase
from feeddrive.typing import FloatArray

TARGETS = 11
"""ISO 230-2 asks for five targets a metre at least, and five in all."""

_VELOCITY, _FEED, _ACCELERATION = 10.0 / 60.0, 3.0 / 60.0, 1.0  # m/s, m/s, m/s^2
_DWELL, _RADIUS, _AVERAGED, _TURNS, _JERK_TIME = 0.25, 0.05, 0.05, 1.2, 0.05  # s, m, s, 1, s
_SPREAD = 0.6180339887498949
"""Targets are spaced irregularly as the standard asks, by multiples of the golden section: periodic errors show."""

_HELD = 0.25
"""Share of the acceleration that friction holds the table against; the rest is for jerk, vibration, and for friction
that is less than declared."""

BRISTLE = 5e-6
"""Way over which friction turns over where nobody has found it [m]; rolling guides take some micrometres."""

_GENTLEST = 0.01
"""m/s^2: without any friction nothing is gentle enough, and the test must end."""


@dataclass(frozen=True)
class TestMotion:
    """What is driven.

    Attributes:
        steps: staircase over the targets, up and down once.
        circle: one axis of a circle.
    """

    steps: Pieces
    circle: Circle


@dataclass(frozen=True)
class Figures:
    """Figures of a machine.

    Attributes:
        positioning: deviations at the targets and the figures of ISO 230-2; R without scatter.
        circular: figures of ISO 230-4.
    """

    positioning: Positioning
    circular: Circular

    @property
    def contour(self) -> float:
        """Largest deviation from the nominal circle, inwards or outwards [m]."""
        return contour(self.circular)


def contour(circle: Circular) -> float:
    """Largest deviation from the nominal circle, inwards or outwards [m]."""
    return max(abs(circle.radial_maximum), abs(circle.radial_minimum))


def motions(stroke: tuple[float, float], lost: LostMotion) -> TestMotion:
    """The motions of the test on a stroke [m], gentle enough for the play there is."""
    width = stroke[1] - stroke[0]
    hardest = _ACCELERATION if lost.play <= 0 else min(_ACCELERATION, max(_HELD * lost.holding, _GENTLEST))
    even = np.linspace(stroke[0] + 0.05 * width, stroke[1] - 0.05 * width, TARGETS)
    shift = (np.arange(TARGETS) * _SPREAD % 1.0 - 0.5) * 0.4 * (even[1] - even[0])
    shift[[0, -1]] = 0.0
    limits = Limits(_VELOCITY, hardest, hardest / _JERK_TIME, "prediction")
    steps = staircase([float(one) for one in even + shift], 1, 0.02 * width, limits, _DWELL)
    radius = min(_RADIUS, 0.2 * width)
    along = Limits(min(_FEED, math.sqrt(0.5 * hardest * radius)), hardest, hardest / _JERK_TIME, "prediction")
    return TestMotion(steps, Circle(0.5 * (stroke[0] + stroke[1]), radius, _TURNS, along, _DWELL))


def sticking(plant: Plant, lost: LostMotion) -> Plant:
    """The plant whose table friction sticks at rest; as it is where it sticks, has none, or cannot have a bristle."""
    if lost.force <= 0 or any(isinstance(one, BristleEffect) and one.port is Port.TABLE for one in plant.effects):
        return plant
    try:
        return plant.with_effects(Presliding.of(stiffness=lost.force / BRISTLE, damping=0.0, break_away=0.0))
    except InputError:
        return plant


@dataclass(frozen=True)
class Applied:
    """A table on a control, and the limits of the axis for those that ramp."""

    control: Control
    table: CompensationTable
    limits: AxisLimits = field(default_factory=AxisLimits)


_SHARES, _BETWEEN = (0.4, 0.65, 0.9), 0.125
"""Shares of the time in which the table would cross the play by itself: reversals tried first, and those on either side
of the best of them; about the optimum the error changes by less than a tenth between two that are so near."""


def best_reversal(plant: Plant, cascade: Cascade, test: TestMotion, applied: Applied) -> tuple[Applied, float | None]:
    """The time within which the play goes over that leaves the least contour error, for controls that let it be set.

    At a quadrant the axis of the circle leaves its turning point with a = v^2 / R, and crosses a play w by itself in
    t = sqrt(2 w / a). A value that goes over much more quickly drives the nut through the play and throws the table;
    one that takes longer leaves the table behind. The best time lies below t.

    Args:
        plant: with what was found.
        cascade: its controller, closed at the motor.
        test: what is driven.
        applied: table on the control at its usual reversal.

    Returns:
        The table on the control at the best reversal, and the contour error at the usual one [m]; None, and what was
        given, where there is no play, nothing can be set, or nothing is better.
    """
    usual, play = applied.control.reversal, applied.table.play
    if not usual.longest or play <= 0:
        return applied, None
    circle, cycle = test.circle, cascade.sample_time * cascade.position_divider
    alone = math.sqrt(2 * play * circle.radius) / circle.limits.velocity
    tried: dict[float, tuple[float, Applied]] = {}

    def at(share: float) -> float:
        if share not in tried:
            reversal = usual.over(share * alone, cycle) if share else usual
            one = replace(applied, control=replace(applied.control, reversal=reversal))
            tried[share] = (contour(circle_figures(plant, cascade, circle, one)), one)
        return tried[share][0]

    first = min(_SHARES, key=at)
    at(first - _BETWEEN)
    at(first + _BETWEEN)
    before = at(0.0)
    error, best = min(tried.values(), key=lambda one: one[0])
    return (best, before) if error < before else (applied, None)


Extra = Callable[[FloatArray, Motion], tuple[FloatArray, FloatArray]]
"""Time and set-point to what is added to the speed set-point [rad/s] and the torque [N m], as friction values are."""


def figures(plant: Plant, cascade: Cascade, test: TestMotion, applied: Applied | None = None) -> Figures:
    """The figures of a plant under its cascade, closed at the motor, in a test motion, without or with a table."""
    time, position = run(plant, cascade, test.steps, applied)
    found: dict[float, dict[int, float]] = {}
    for stop in test.steps.stops[1:]:
        standing = (time >= stop.leave - _AVERAGED) & (time < stop.leave)
        found.setdefault(stop.target, {})[stop.direction] = float(position[standing].mean()) - stop.target
    both = sorted(target for target, ways in found.items() if len(ways) == 2)
    up, down = (np.array([[found[target][way]] * 2 for target in both]) for way in (1, -1))
    return Figures(positioning(np.array(both), up, down), circle_figures(plant, cascade, test.circle, applied))


def circle_figures(
    plant: Plant, cascade: Cascade, circle: Circle, applied: Applied | None = None, extra: Extra | None = None
) -> Circular:
    """The figures of one axis of a circle; the last whole turn at constant feed counts."""
    time, position = run(plant, cascade, circle, applied, extra)
    angle = circle.angle(time)
    rate = np.gradient(angle, time)
    steady = np.flatnonzero(np.abs(rate - rate.max()) < 1e-6 * rate.max())
    last = angle[steady[-1]]
    chosen = steady[angle[steady] >= last - 2 * math.pi * (1 + 1e-4)]
    return circular(angle[chosen], position[chosen], circle.radius)


def run(
    plant: Plant, cascade: Cascade, trajectory: Trajectory, applied: Applied | None = None, extra: Extra | None = None
) -> tuple[FloatArray, FloatArray]:
    """Time [s] and table position [m] at the ticks of the controller, shape (n,) each."""
    tick, divider = cascade.sample_time, cascade.position_divider
    cycles = math.ceil(trajectory.duration / (tick * divider))
    time: FloatArray = np.arange(cycles * divider, dtype=np.float64) * tick
    motion = trajectory.at(time)
    columns = {"position": motion.position, "velocity": motion.velocity, "acceleration": motion.acceleration}
    if applied is not None:
        slow = slice(None, None, divider)
        commanded = motor_setpoint(
            applied.control, applied.table, motion.position[slow], motion.velocity[slow], tick * divider, applied.limits
        )
        columns["position"] = np.repeat(commanded, divider)
        if applied.control.reversal.ramped:  # the whole command of the motor is differentiated by such a control
            rate = np.diff(commanded - motion.position[slow], prepend=0.0) / (tick * divider)
            rate[0] = 0.0
            columns["velocity"] = motion.velocity + np.repeat(rate, divider)
    if extra is not None:
        columns["speed_excitation"], columns["torque_excitation"] = extra(time, motion)
    nothing = np.zeros(len(time))
    reference = np.column_stack([columns.get(name, nothing) for name in REFERENCES])
    controller, loop = cascade_controller(cascade), TorqueLoop(cascade.current_lag, cascade.dead_time)
    start = resting_state(plant, controller, loop, float(motion.position[0]))
    done = simulate_controlled(plant, controller, reference, None, loop, start)
    return done.time, done.table_position
