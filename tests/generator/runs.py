"""A programme run on a machine with planted effects: exact signals, what is recorded, and what an effect changes."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from tests.generator.beside import beside
from tests.generator.constants import Constants, declared_constants, packed
from tests.generator.effects import Effect, PlantedEffects
from tests.generator.lateness import as_recorded, lateness
from tests.generator.loop import Sampling, closed_loop
from tests.generator.machines import Machine
from tests.generator.recording import measured, sampling_of, state_at_rest
from tests.generator.state import State
from tests.generator.transmission import nut_forces, side_of

Array = npt.NDArray[np.float64]
Channels = dict[str, Array]


@dataclass(frozen=True)
class Run:
    """What the machine did, at the cycles of its loop.

    torque: commanded (n,) [N m]. states, read: (n, WIDTH) at the cycles, and when the recorder reads.
    """

    machine: Machine
    constants: Constants
    effects: tuple[Effect, ...]
    setpoint: Array
    torque: Array
    states: Array
    read: Array

    @property
    def rows(self) -> slice:
        """Cycles that are recorded."""
        return slice(0, None, self.machine.every)

    def exact(self) -> tuple[Array, Array, Array]:
        """Return torque, motor angle and table position of the rows without sensor errors, (rows,) each."""
        late = lateness(self.machine.axis.sample_time, self.constants).rows
        torque, angle, position = as_recorded(self.torque, self.states, self.read, late, self.constants)
        return torque[self.rows], angle[self.rows], position[self.rows]

    def recorded(self, seed: int, torque_factor: float = 1.0) -> Channels:
        """Return the channels of the recording; the torque is that of the current over `torque_factor`."""
        torque, angle, position = self.exact()
        time = np.arange(len(torque)) * self.machine.row_time
        sensed = measured(torque / torque_factor, angle, position, self.machine.axis.sensors, seed)
        if not self.machine.scale:
            del sensed["table_position"]
        return {"time": time, "setpoint": self.setpoint[self.rows]} | sensed


def longest_step(c: Constants, axis_speed: float) -> float:
    """Return a step of the integrator [s] that resolves the fastest oscillation and the steepest friction."""
    mass, r = c.table_mass, c.transmission
    axial = math.sqrt(c.axial_stiffness * (1.0 / mass + r**2 / c.screw_inertia))
    torsional = math.sqrt(c.torsional_stiffness * (1.0 / c.screw_inertia + 1.0 / (c.motor_inertia * c.ratio**2)))
    guide = 2.0 * (c.guide_coulomb + abs(c.stribeck_force) + abs(c.bump_peak)) / c.guide_velocity / mass
    drag = 1.5 * (c.nut_coulomb + c.bearing_coulomb) / c.drag_speed / c.screw_inertia
    damped = c.axial_damping * (1.0 / mass + r**2 / c.screw_inertia)
    bristle = 0.0
    if c.bristle_stiffness > 0.0:
        bristle = c.bristle_stiffness * 1.2 * axis_speed / (0.4 * c.guide_coulomb)
    return min(0.6 / math.hypot(axial, torsional), 1.2 / (guide + drag + damped), 0.25 / max(bristle, 1e-9), 1e-4)


def run(machine: Machine, effects: tuple[Effect, ...], setpoint: Array, injected: Array) -> Run:
    """Return the run; FloatingPointError where it diverges."""
    constants, s = _planted(machine, effects)
    start = at_rest(setpoint[0], constants)
    torque, states, read = closed_loop(setpoint, injected, start, s, constants)
    if not np.all(np.isfinite(states)):
        raise FloatingPointError("the simulated machine diverged")
    return Run(machine, constants, effects, setpoint, torque, states, read)


def steps_of(machine: Machine, effects: tuple[Effect, ...], cycles: int) -> float:
    """Return how many steps of the integrator a run of so many cycles takes."""
    s = _planted(machine, effects)[1]
    return cycles * s.sample_time / s.longest_step


def _planted(machine: Machine, effects: tuple[Effect, ...]) -> tuple[Constants, Sampling]:
    constants = PlantedEffects(effects).planted(declared_constants(machine.axis))
    return constants, sampling_of(machine.axis, constants, longest_step(constants, machine.axis.top_speed))


FURTHER = 20
"""Doublings of the stretch in which a hanging table is looked for: a million times that of the law."""


def at_rest(setpoint: float, c: Constants) -> State:
    """Return the state that `state_at_rest` does, the weight hanging in the springs and lying on a flank of the play.

    A table that falls through its free play as a recording begins would tell of the play in those milliseconds alone.
    """
    state = state_at_rest(setpoint, c)
    if c.fall == 0.0:
        return state
    weight = (c.table_mass + c.mode_mass) * c.fall - c.counterbalance

    def lowered(by: float) -> State:
        return state._replace(position=state.position - by)

    def left_to_carry(by: float) -> float:
        there = lowered(by)
        return weight - nut_forces(there, side_of(there, c), packed(c))[2]

    softest = c.axial_stiffness * min(c.preload_ratio, 1.0) * (1.0 - abs(c.stroke_share))
    furthest = 2.0 * (c.gap + abs(weight) / softest)
    for _ in range(FURTHER):  # a relative of a law may be softer than the law
        if left_to_carry(-furthest) * left_to_carry(furthest) <= 0.0:
            break
        furthest *= 2.0
    else:
        raise FloatingPointError("no stretch of the springs carries the weight")
    return lowered(float(brentq(left_to_carry, -furthest, furthest, xtol=1e-15)))


def changes(one: Run, without: tuple[Effect, ...], machine: Machine | None = None) -> tuple[Array, Array]:
    """Return how much torque [N m] and table position [m] at the rows differ from those of the plant with `without`.

    Under the same motor motion, as it is recorded; (rows,) each. `machine`: of that plant, where its values are other.
    """
    other = PlantedEffects(without).planted(declared_constants((machine or one.machine).axis))
    longest = min(longest_step(c, one.machine.axis.top_speed) for c in (one.constants, other))
    s = sampling_of(one.machine.axis, one.constants, longest)
    starts = (at_rest(one.setpoint[0], one.constants), at_rest(one.setpoint[0], other))
    asked, position = beside(one.torque, *starts, s, one.constants, other)
    torque, angle, table = one.exact()
    late = one.states[one.rows, 0] - angle
    d_torque, d_position = torque - asked[one.rows], table - position[one.rows]
    if one.constants.angle_lateness > 0.0 or one.constants.torque_lateness > 0.0:
        # The other plant would be led by the recorded angle, which is behind, or read later beside a late torque.
        d_position = d_position + one.machine.radius * late
        d_torque = d_torque + transmitted(one.machine, late, one.machine.row_time)[0]
    return d_torque, d_position


def impedance(machine: Machine, hertz: Array) -> tuple[Array, Array]:
    """Return torque [N m/rad] and table position [m/rad] per motor angle of the linear chain, (n,) complex each."""
    a = machine.axis
    s = 2j * math.pi * hertz
    r = a.transmission
    torsion = a.torsional_stiffness + a.torsional_damping * s
    spring = a.axial_stiffness + a.axial_damping * s
    table = a.table_mass * s**2 + a.guide_viscous * s + spring
    load = a.screw_inertia * s**2 + r**2 * spring - r**2 * spring**2 / table
    screw = torsion / (torsion + load) / a.ratio
    torque = a.motor_inertia * s**2 + torsion * (1.0 / a.ratio - screw) / a.ratio
    return torque, r * spring / table * screw


def transmitted(machine: Machine, angle: Array, row_time: float) -> tuple[Array, Array]:
    """Return what a small error of the motor angle (n,) [rad] makes of predicted torque and table position, (n,)."""
    hertz = np.fft.rfftfreq(len(angle), row_time)
    spectrum = np.fft.rfft(angle)
    torque, position = impedance(machine, hertz)
    return np.fft.irfft(torque * spectrum, len(angle)), np.fft.irfft(position * spectrum, len(angle))


def steady(one: Run) -> bool:
    """Whether the loop neither hunts nor stands at its limit, and follows its set-point."""
    limit = one.machine.axis.controller.torque_limit
    at_limit = float(np.mean(np.abs(one.torque) > 0.999 * limit))
    resting = one.torque[: max(20, round(0.4 / one.machine.axis.sample_time))]
    hunting = float(np.std(resting[len(resting) // 2 :]))
    span = float(np.ptp(one.setpoint)) + 1e-3
    behind = float(np.max(np.abs(one.states[:, 0] * one.machine.radius - one.setpoint)))
    return at_limit < 0.002 and hunting < 0.05 * limit and behind < 0.3 * span


def softened(machine: Machine, share: float) -> Machine:
    """Return the machine with `share` of its gains."""
    control = machine.axis.controller
    return machine.with_axis(
        controller=dataclasses.replace(
            control,
            position_gain=share * control.position_gain,
            speed_gain=share * control.speed_gain,
            integral_time=control.integral_time / share,
        )
    )
