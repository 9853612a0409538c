"""Recordings made ready for the plant that they are of: motion and torque, or temperatures and growth."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from feeddrive.diagnose.evidence import Evidence, prepare
from feeddrive.diagnose.fit import Problem
from feeddrive.diagnose.heat_evidence import left_out_channels, prepare_heat, within_range
from feeddrive.diagnose.heat_prediction import heat_predictor
from feeddrive.diagnose.prediction import AxisPredictor
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording, check_against_lead
from feeddrive.thermal.plant import ThermalPlant

Prepared = tuple[Problem, list[Evidence], tuple[str, ...]]
"""The problem, what is judged, and what is to be said."""


def prepared(
    plant: Plant | ThermalPlant, recordings: Sequence[Recording], validation: Sequence[Recording], split: float
) -> Prepared:
    """The problem, and what it is judged on.

    Args:
        plant: as declared.
        recordings: fitted; without `validation` their last part is judged.
        validation: judged only.
        split: share that is fitted where there is no `validation`.

    Raises:
        InputError: recordings that cannot be used with this plant.
    """
    if isinstance(plant, ThermalPlant):
        return _prepared_heat(plant, recordings, validation, split)
    for recording in (*recordings, *validation):
        _refuse_heat(recording)
        check_against_lead(recording, 2 * np.pi * plant.chain.motor_radius, recording.name)
    fitted = tuple(prepare(recording, plant, 1.0 if validation else split) for recording in recordings)
    judged: list[Evidence] = [prepare(recording, plant, 0.0) for recording in validation] or list(fitted)
    return Problem(plant, fitted, AxisPredictor()), judged, ()


def _prepared_heat(
    plant: ThermalPlant, recordings: Sequence[Recording], validation: Sequence[Recording], split: float
) -> Prepared:
    fitted = tuple(prepare_heat(recording, plant, 1.0 if validation else split) for recording in recordings)
    others = [prepare_heat(recording, plant, 0.0) for recording in validation]
    wide, told = within_range(plant, (*fitted, *others))
    lost = [f"{r.name}: {c} is not predicted" for r in (*recordings, *validation) for c in left_out_channels(r, plant)]
    judged: list[Evidence] = [*others] or [*fitted]
    return Problem(wide, fitted, heat_predictor(wide)), judged, (*told, *lost)


def _refuse_heat(recording: Recording) -> None:
    moving = any(name in recording for name in ("motor_torque", "motor_current", "motor_angle", "table_position"))
    if not moving and "screw_speed" in recording:
        mend = "name a plant that declares heat alone, such as thermal_bench"
        raise InputError("a recording of temperatures, and the plant declares motion", recording.name, mend)
