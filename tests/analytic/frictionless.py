"""The generator's bench axis without friction and dampers, run without a controller, and its energy."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from tests.generator.axis import BENCH
from tests.generator.constants import Constants, declared_constants
from tests.generator.loop import Sampling, open_loop
from tests.generator.recording import LONGEST_STEP
from tests.generator.state import State

Array = npt.NDArray[np.float64]

SAMPLE = 5e-4

FRICTIONLESS = declared_constants(BENCH)._replace(
    torsional_damping=0.0,
    axial_damping=0.0,
    guide_coulomb=0.0,
    guide_viscous=0.0,
    nut_coulomb=0.0,
    nut_power=0.0,
    bearing_coulomb=0.0,
)

DAMPED = FRICTIONLESS._replace(torsional_damping=BENCH.torsional_damping, axial_damping=BENCH.axial_damping)
"""With the dampers of the springs, which take no momentum."""


def run(constants: Constants, state: State, torque: float, seconds: float) -> Array:
    """Return the states (n + 1, WIDTH) under a constant command [N m]."""
    command = np.full(round(seconds / SAMPLE), torque)
    return open_loop(command, state, Sampling(SAMPLE, LONGEST_STEP, 1e-6, 0.0, 0.0, 1.0, 30.0), constants)


def moving(velocity: float, constants: Constants, position: float = 0.1) -> State:
    """Return the unloaded state at `position` [m] in which everything moves with the table's velocity [m/s]."""
    angle, speed = position / constants.transmission, velocity / constants.transmission
    return State(angle, speed, angle, speed, position, velocity, mass_velocity=velocity)


def momentum(states: Array, c: Constants) -> Array:
    """Return the sum (n,) [N m s] on which springs between the masses have no say: in terms of the screw's angle."""
    table = c.table_mass * states[:, 5] + c.mode_mass * states[:, 8]
    return c.motor_inertia * states[:, 1] + c.screw_inertia * states[:, 3] + c.transmission * table


def total_inertia(c: Constants) -> float:
    """Return what the motor feels of all masses when they move together [kg m^2]."""
    return c.motor_inertia + c.screw_inertia + c.transmission**2 * (c.table_mass + c.mode_mass)


def energy(states: Array, c: Constants) -> Array:
    """Return kinetic energy and that of all springs (n,) [J]."""
    motor, motor_speed, screw, screw_speed, x, v, _, u, w, _ = states.T
    kinetic = (
        c.motor_inertia * motor_speed**2 + c.screw_inertia * screw_speed**2 + c.table_mass * v**2 + c.mode_mass * w**2
    )
    springs = c.torsional_stiffness * (motor - screw) ** 2 + c.spring_stiffness * (x - c.spring_zero) ** 2
    springs += c.mode_mass * c.mode_rate**2 * u**2
    return 0.5 * (kinetic + springs) + nut_energy(screw, x, c)


def nut_energy(screw: Array, x: Array, c: Constants) -> Array:
    """Return the energy (n,) [J] of the spring between nut and table: the area under its force."""
    e = c.transmission * screw + c.travel_amplitude * np.sin(c.travel_order * screw + c.travel_phase)
    size = np.maximum(np.abs(e - (1.0 - c.lead_slope) * x) - 0.5 * c.gap, 0.0)
    along = (x - c.stroke_low) / (c.stroke_high - c.stroke_low)
    k = c.axial_stiffness / (1.0 + c.stroke_share / (1.0 - c.stroke_share) * along)
    edge = c.preload_force / (c.preload_ratio * k)
    beyond = np.maximum(size - edge, 0.0)
    within = np.minimum(size, edge)
    soft = 0.5 * c.preload_ratio * k * within**2
    return np.asarray(soft + c.preload_force * beyond + 0.5 * k * beyond**2)
