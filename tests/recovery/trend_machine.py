"""Recordings of an elastic axis written down in closed form, day after day: quasi-static, slow against its resonances.

    F = M a + Fc tanh(v / v0) + b v                       force of the nut on the table
    x = r theta + lead(x) - g/2 side - F / k              side: +1 where F pushes along +
    T = J theta'' + (drag tanh(v / v0) + friction map(x) sign v) + r F

Nothing of the package takes part. All that differs from day to day is in `State`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from feeddrive.recording import Recording

Array = npt.NDArray[np.float64]

LEAD, INERTIA, MASS, COULOMB, VISCOUS, SMOOTH, DRAG, STIFFNESS = 10e-3, 3e-3, 120.0, 90.0, 250.0, 1e-3, 0.30, 200e6
STEP = 2e-3

PLANT = f"""format = "feeddrive-plant/1"
name = "watched axis"
structure = "three_inertias"

[motor]
inertia = "{0.8 * INERTIA} kg m^2"

[ball_screw]
lead = "{LEAD * 1e3} mm"
inertia = "{0.2 * INERTIA} kg m^2"

[transmission]
torsional_stiffness = "400000 N m/rad"
torsional_damping = "0.1 N m s/rad"
axial_stiffness = "{STIFFNESS * 1e-6} N/µm"
axial_damping = "8000 N s/m"

[table]
mass = "{MASS} kg"
stroke = ["0 mm", "500 mm"]

[[effect]]
name = "guide_friction"
port = "table"
coulomb = "{COULOMB} N"
smoothing_velocity = "{SMOOTH * 1e3} mm/s"
viscous = "{VISCOUS} N s/m"

[[effect]]
name = "nut_drag"
port = "screw"
coulomb = "{DRAG} N m"
smoothing_speed = "{SMOOTH * 2 * math.pi / LEAD} rad/s"
viscous = "0 N m/(rad/s)^(2/3)"
"""


@dataclass(frozen=True)
class State:
    """The machine on one day.

    Attributes:
        preload: share of the new one; drag goes with it, stiffness with its cube root.
        play: [m].
        offset, slope: of the scale against the motor [m, m/m].
        drag: factor on the nut's drag, of lubrication and temperature.
        mass: on the table beyond the declared one [kg].
        seed: of the sensors' noise.
        scale_step: of the scale [m].
        start: where the strokes begin in their period, as nobody presses the button at the same moment [1].
    """

    preload: float = 1.0
    play: float = 0.0
    offset: float = 0.0
    slope: float = 0.0
    drag: float = 1.0
    mass: float = 0.0
    seed: int = 0
    scale_step: float = 10e-9
    start: float = 0.0


def recording(state: State, name: str = "day", seconds: float = 8.0, channels: tuple[str, ...] = ()) -> Recording:
    """A recording of long strokes with shorter, faster ones on top; torque noise 0.02 N m, scale noise 20 nm."""
    r = LEAD / (2 * math.pi)
    random = np.random.default_rng(state.seed)
    time: Array = np.arange(round(seconds / STEP), dtype=np.float64) * STEP
    moved, _, _ = _motion(time + state.start)
    _, v, a = _motion(time + state.start)
    middle, v_mid, a_mid = _motion(time + state.start + 0.5 * STEP)
    force = _force(v, a, state)
    stiffness = STIFFNESS * state.preload ** (1 / 3)
    table = moved + lead_map(moved) + state.offset + state.slope * moved
    table = table - 0.5 * state.play * np.tanh(force / 1.0) - force / stiffness
    table = table + 20e-9 * random.standard_normal(len(time))
    drag = DRAG * state.preload * state.drag * np.tanh(v_mid / SMOOTH) * (1 + friction_map(middle))
    torque = INERTIA * a_mid / r + drag + r * _force(v_mid, a_mid, state)
    torque = torque + 0.02 * random.standard_normal(len(time))
    every = {
        "motor_torque": torque,
        "motor_angle": np.round(moved / r / 1e-6) * 1e-6,
        "table_position": np.round(table / state.scale_step) * state.scale_step,
    }
    return Recording(name, time, {key: every[key] for key in channels or every}, STEP)


def _force(v: Array, a: Array, state: State) -> Array:
    return (MASS + state.mass) * a + COULOMB * np.tanh(v / SMOOTH) + VISCOUS * v


def lead_map(x: Array) -> Array:
    """Lead error over position, the same every day: 4 µm over the stroke and 1 µm once a revolution [m]."""
    return 4e-6 * np.sin(2 * math.pi * x / 0.7) + 1e-6 * np.sin(2 * math.pi * x / LEAD + 0.4)


def friction_map(x: Array) -> Array:
    """A tight place, as a share of the drag."""
    return 0.35 * np.exp(-(((x - 0.33) / 0.05) ** 2))


def _motion(time: Array) -> tuple[Array, Array, Array]:
    """Position [m], speed and acceleration about the middle of the stroke."""
    position, speed, acceleration = np.full_like(time, 0.25), np.zeros_like(time), np.zeros_like(time)
    for amplitude, period in ((0.19, 3.7), (0.03, 0.83)):
        omega = 2 * math.pi / period
        position = position + amplitude * np.sin(omega * time)
        speed = speed + amplitude * omega * np.cos(omega * time)
        acceleration = acceleration - amplitude * omega**2 * np.sin(omega * time)
    return position, speed, acceleration
