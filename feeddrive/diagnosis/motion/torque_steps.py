"""Coarse steps of a recorded torque: no comparison is to rest on what rounding makes of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.rounding import rounding_of
from feeddrive.plant.plant import Plant
from feeddrive.recording.checks.flaws import quantisation_step

TORQUE = "motor_torque"


def with_open_steps(evidence: AxisEvidence, plant: Plant, predictor: AxisPredictor) -> AxisEvidence:
    """The evidence without what the steps of its torque may make of it, beside the declared plant."""
    if TORQUE not in evidence.channels:
        return evidence
    torque = evidence.recording[TORQUE]
    step = quantisation_step(torque)
    predicted = predictor.predict(plant, evidence)[TORQUE] if step else torque
    if not step or not np.all(np.isfinite(predicted)):
        return evidence
    rounding = rounding_of(torque, predicted, step, evidence.counted)
    return replace(evidence, rounding=rounding, evened_unsure={})
