"""Recordings of a rigid axis written down in closed form: motion a sum of sines, torque by Newton's law.

    T = r (M a + (Fc + P exp(-((x - c) / w)^2)) tanh(v / v0) + b v + F0) + noise,   r = lead / 2 pi

The torque of a sample is that at the middle of its hold. Nothing of the package takes part.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from feeddrive.recording import Recording

LEAD, MASS, COULOMB, VISCOUS, SMOOTH = 5e-3, 60.0, 40.0, 250.0, 1e-3
STEP, NOISE = 2e-3, 2e-3

PLANT = f"""format = "feeddrive-plant/1"
name = "rigid axis"
structure = "rigid"

[ball_screw]
lead = "{LEAD * 1e3} mm"

[table]
mass = "{MASS} kg"

[[effect]]
name = "guide_friction"
port = "table"
coulomb = "{COULOMB} N"
smoothing_velocity = "{SMOOTH * 1e3} mm/s"
viscous = "{VISCOUS} N s/m"
"""


@dataclass(frozen=True)
class Truth:
    """What one recording has otherwise.

    Factors on friction, a mass [kg], a force [N], a ripple [N m] of order 3, a tight place: peak [N], centre and half
    width [m].
    """

    coulomb: float = 1.0
    viscous: float = 1.0
    mass: float = 0.0
    force: float = 0.0
    ripple: float = 0.0
    bump: tuple[float, float, float] = (0.0, 0.0, 1.0)
    seed: int = 1


def rigid_run(name: str, truth: Truth, seconds: float = 12.0, slow: float = 1.0, step: float = STEP) -> Recording:
    """A recording with a row every `step` [s]; `slow` stretches its motion in time, for another mix of speeds."""
    time = np.arange(round(seconds / step)) * step
    position, _, _ = _motion(time, slow)
    _, speed, acceleration = _motion(time + 0.5 * step, slow)
    middle, _, _ = _motion(time + 0.5 * step, slow)
    r = LEAD / (2 * math.pi)
    peak, centre, width = truth.bump
    level = truth.coulomb * COULOMB + peak * np.exp(-(((middle - centre) / width) ** 2))
    friction = level * np.tanh(speed / SMOOTH) + truth.viscous * VISCOUS * speed
    torque = r * ((MASS + truth.mass) * acceleration + friction + truth.force)
    torque += truth.ripple * np.sin(3 * middle / r)
    torque += NOISE * np.random.default_rng(truth.seed).standard_normal(len(time))
    return Recording(name, time, {"motor_torque": torque, "motor_angle": position / r}, step)


def _motion(time: np.ndarray, slow: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Position [m], velocity and acceleration: long strokes, and faster ones on top."""
    position, speed, acceleration = (np.zeros_like(time) for _ in range(3))
    for amplitude, period in ((0.08, 3.1), (0.012, 0.93)):
        omega = 2 * math.pi / (period * slow)
        position = position + amplitude * np.sin(omega * time)
        speed = speed + amplitude * omega * np.cos(omega * time)
        acceleration = acceleration - amplitude * omega**2 * np.sin(omega * time)
    return position, speed, acceleration
