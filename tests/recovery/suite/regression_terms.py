"""Terms that a person would offer a sparse regression, and which of them are which effect.

In motion: functions of the table's position, speed and acceleration as the motor angle gives them, of the motor angle
and of time. The measured torque is left out, as it holds the very residual that is to be explained. In a warm-up: the
speed of the screw and its power 5/3, followed with several time constants.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.signal import lfilter

from feeddrive.diagnosis.heat.heat_evidence import HeatEvidence
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from tests.generator.axis import AxisParameters

Terms = dict[str, np.ndarray]
"""Name to its series in the band, (n,)."""

SLOW, FAST = 5e-3, 20e-3
"""Velocities of drops of friction [m/s]."""

STEP = 1e-3
"""Velocity within which the sign is smooth [m/s]; noise at rest would tear a sharp one."""

BUMPS, ORDERS = 6, 8
LAGS = (300.0, 1000.0, 3000.0, 10000.0)
"""Time constants of a warm-up [s]."""


def motion_terms(evidence: AxisEvidence, axis: AxisParameters) -> Terms:
    """The library of motion."""
    band, step = evidence.band, evidence.recording.sample_time
    t, θ = evidence.recording.time, evidence.recording["motor_angle"]
    x = band.filter(axis.transmission * θ)
    v = np.gradient(x, step)
    a = np.gradient(v, step)
    sign = np.tanh(v / STEP)
    force = axis.table_mass * a + axis.guide_coulomb * sign + axis.guide_viscous * v
    raw: Terms = {
        "1": np.ones_like(x), "sign v": sign, "v": v, "|v|": np.abs(v), "v |v|": v * np.abs(v),
        "x": x, "x sign v": x * sign, "a": a, "|a| sign v": np.abs(a) * sign, "a^3": a**3, "jerk": np.gradient(a, step),
        "t": t, "t v": t * v, "t x": t * x, "F": force, "x F": x * force, "sign F": np.sign(force),
        "drop 5 mm/s": np.exp(-((v / SLOW) ** 2)) * sign, "drop 20 mm/s": np.exp(-((v / FAST) ** 2)) * sign,
    }  # fmt: skip
    width = (axis.stroke_high - axis.stroke_low) / BUMPS
    for number in range(BUMPS):
        centre = axis.stroke_low + (number + 0.5) * width
        raw[f"bump {number + 1}"] = np.exp(-(((x - centre) / width) ** 2)) * sign
    for order in range(1, ORDERS + 1):
        raw[f"sin {order} angle"], raw[f"cos {order} angle"] = np.sin(order * θ), np.cos(order * θ)
    return {name: band.filter(series) for name, series in raw.items()}


def heat_terms(evidence: HeatEvidence) -> Terms:
    """The library of a warm-up."""
    rows, step = len(evidence.recording), evidence.recording.sample_time
    t = np.arange(rows) * step
    terms: Terms = {"1": np.ones(rows), "t": t, "N": _padded(evidence.speed, rows)}
    for lag in LAGS:
        share = 1 - np.exp(-step / lag)
        for name, heat in (("N", evidence.speed), ("N^5/3", evidence.speed ** (5 / 3))):
            terms[f"{name} after {lag:g} s"] = _padded(lfilter([share], [1, share - 1], heat), rows)
    return terms


def _padded(series: np.ndarray, rows: int) -> np.ndarray:
    return np.concatenate([np.zeros(rows - len(series)), series])


def terms_of(evidence: Evidence, axis: AxisParameters | None) -> Terms:
    """The library of a recording."""
    if isinstance(evidence, HeatEvidence):
        return heat_terms(evidence)
    assert isinstance(evidence, AxisEvidence) and axis is not None
    return motion_terms(evidence, axis)


def _periodic(values: dict[str, float | str]) -> set[str]:
    order = float(values["order"])
    return {f"{wave} {order:.0f} angle" for wave in ("sin", "cos")} if order == round(order) else set()


def _late(values: dict[str, float | str]) -> set[str]:
    return {"jerk"} if values["channel"] == "motor_torque" else {"v", "jerk"}


Answer = Callable[[dict[str, float | str]], set[str]]

SAME: dict[str, set[str] | Answer] = {
    "coulomb_asymmetry": {"1", "sign v"},
    "viscous_asymmetry": {"|v|"},
    "stribeck": {"drop 5 mm/s", "drop 20 mm/s"},
    "friction_vs_position": {f"bump {number + 1}" for number in range(BUMPS)},
    "viscous_warmup": {"t v"},
    "friction_deviation": {"sign v", "v"},
    "load_dependent_friction": {"|a| sign v"},
    "torque_ripple": _periodic,
    "torque_constant_droop": {"a^3"},
    "constant_force": {"1"},
    "position_spring": {"x"},
    "backlash": {"sign F"},
    "lead_error_periodic": _periodic,
    "lead_error_cumulative": {"x"},
    "thermal_growth": {"t x"},
    "stiffness_deviation": {"F"},
    "stiffness_vs_position": {"x F"},
    "preload_loss": {"sign F"},
    "payload": {"a"},
    "inertia_deviation": {"a"},
    "drive_delay": {"jerk"},
    "channel_delay": _late,
    "motor_heat": {f"N after {lag:g} s" for lag in LAGS},
    "bearing_heat": {f"N^5/3 after {lag:g} s" for lag in LAGS},
    "ambient_drift": {"t"},
}
"""Effect to the terms that are the effect's; the others have none in a library of this kind."""


def same(name: str, values: dict[str, float | str]) -> set[str]:
    """Terms that name an effect; empty where none does."""
    answer = SAME.get(name, set())
    return answer(values) if callable(answer) else answer
