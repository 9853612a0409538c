"""A light axis with a steep screw drag, on which one step a sample of the plain scheme is 26 um wrong."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from feeddrive.effects.friction.guide_friction import GuideFriction
from feeddrive.effects.friction.shaft_drag import NutDrag
from feeddrive.plant.chain.chain import ThreeInertias
from feeddrive.plant.plant import Plant
from feeddrive.simulate.held_torque import initial_state, simulate_torque
from feeddrive.typing import FloatArray

VALUES = {
    "lead": 0.005, "motor_inertia": 4e-5, "screw_inertia": 2e-5, "torsional_stiffness": 800.0,
    "torsional_damping": 2e-3, "axial_stiffness": 60e6, "axial_damping": 1500.0, "table_mass": 15.0,
}  # fmt: skip
GUIDE = {"coulomb": 15.0, "smoothing_velocity": 2e-4, "viscous": 60.0}
DRAG = {"coulomb": 0.05, "smoothing_speed": 0.05, "viscous": 1e-3}
RATES = (0.5, 1.0, 2.0, 4.0, 8.0)
DURATION = 0.2


def light() -> Plant:
    """The axis with its friction."""
    return Plant("light", ThreeInertias(VALUES), (GuideFriction.of(**GUIDE), NutDrag.of(**DRAG)))


def torque_at(time: FloatArray) -> FloatArray:
    """Torque that moves it both ways, through stiction [N m]."""
    torque: FloatArray = 0.25 * np.sin(2 * np.pi * 11 * time) + 0.1 * np.sin(2 * np.pi * 37 * time)
    return torque


def slopes(y: FloatArray, torque: float) -> FloatArray:
    """Rates of angle, angle, position and their rates, written out."""
    v, r = VALUES, VALUES["lead"] / (2 * np.pi)
    twist = v["torsional_stiffness"] * (y[0] - y[1]) + v["torsional_damping"] * (y[3] - y[4])
    force = v["axial_stiffness"] * (r * y[1] - y[2]) + v["axial_damping"] * (r * y[4] - y[5])
    drag = DRAG["coulomb"] * np.tanh(y[4] / DRAG["smoothing_speed"])
    drag += DRAG["viscous"] * y[4] * (y[4] ** 2 + 1e-4) ** (-1 / 6)
    friction = GUIDE["coulomb"] * np.tanh(y[5] / GUIDE["smoothing_velocity"]) + GUIDE["viscous"] * y[5]
    rates = ((torque - twist) / v["motor_inertia"], (twist - r * force - drag) / v["screw_inertia"])
    return np.array([y[3], y[4], y[5], *rates, (force - friction) / v["table_mass"]])


def oracle(time: FloatArray, torque: FloatArray) -> FloatArray:
    """Table position at the samples by scipy's Radau, restarted at every sample [m]."""
    state, found = initial_state(light(), 0.0, 0.0), [0.0]
    for i in range(len(time) - 1):
        state = solve_ivp(
            lambda _, y, u=torque[i]: slopes(y, u), (time[i], time[i + 1]), state, method="Radau", rtol=1e-10,
            atol=[1e-12, 1e-12, 1e-14, 1e-10, 1e-10, 1e-12],
        ).y[:, -1]  # fmt: skip
        found.append(float(state[2]))
    return np.array(found)


def light_errors() -> list[tuple[float, float]]:
    """(rate [kHz], largest error of the table [m]) for every rate."""
    result = []
    for rate in RATES:
        time = np.arange(0.0, DURATION, 1e-3 / rate)
        torque = torque_at(time)
        result.append(
            (rate, float(np.abs(simulate_torque(light(), time, torque).position - oracle(time, torque)).max()))
        )
    return result
