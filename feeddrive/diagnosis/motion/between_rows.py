"""What a drive does between two rows, and a recording does not tell: no comparison is to rest on it.

    δT = β h² T'' / 12,                0 <= β <= 1
    δx = ρ r h² θ'' / (2 π)²,          ρ of a tenth (`RIPPLE`)

| symbol | meaning | unit |
|---|---|---|
| h | time between rows | s |
| T'' | second derivative of the torque that the declared plant needs | N m/s² |
| r, θ'' | travel per angle, acceleration of the motor | m/rad, rad/s² |
| ρ | ripple of the torque at the rate of the rows over what accelerates | 1 |

A torque is compared as held for a whole row (`band.held`), which takes sin u / u of every frequency, u = ω h / 2. One
that changes all the time and is read at its rows lacks as much, β = 1/2; the mean over a row lacks it twice, β = 1. A
drive whose position loop runs at the rate of the rows and its torque faster moves the motor at that rate as well: in
all rows alike, so that they show no vibration, but an angle off by what accelerates. Where no noise hides them, masses
and inertias of both signs make the same. So β has a deviation of one and ρ of a tenth. What else faster cycles make is
a delay, which has a name.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.plant.plant import Plant

RIPPLE = 0.1
"""Deviation of ρ: a cascade with feed-forward, four torques to a row, was simulated with 0.04."""


def with_open_rows(evidence: AxisEvidence, plant: Plant, predictor: AxisPredictor) -> AxisEvidence:
    """The evidence without what a drive may do between its rows, beside the declared plant."""
    predicted = predictor.predict(plant, evidence)
    none = {name: np.zeros(len(series)) for name, series in predicted.items()}
    parts = []
    torque = predicted.get("motor_torque")
    if torque is not None and np.all(np.isfinite(torque)):
        parts.append({**none, "motor_torque": np.concatenate([[0.0], np.diff(torque, 2) / 12, [0.0]])})
    if "table_position" in predicted:
        acceleration = evidence.motion.acceleration[evidence.motion.samples] * evidence.recording.sample_time**2
        moved = RIPPLE / (2 * math.pi) ** 2 * plant.chain.motor_radius * acceleration
        parts.append({**none, "table_position": evidence.in_band(moved)})
    return replace(evidence, between_rows=tuple(parts))
