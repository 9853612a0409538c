"""A case of the fleet as a problem: read from its files, its declared values fitted within their tolerances."""

from __future__ import annotations

from pathlib import Path

from feeddrive.diagnosis.calibration.calibrate import calibrated
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.preparation import prepared
from feeddrive.diagnosis.suspicion.logged import declared_hold
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from tests.recovery.fleet.case import case


def calibrated_case(seed: int, folder: Path) -> Problem:
    """Write a case and return its fitted recording, ready for the search."""
    plant_file, fitted, judged = case(seed).write(folder)
    plant, recordings = read_plant(plant_file), [read_recording(path) for path in (fitted, judged)]
    hold = declared_hold(plant, recordings)
    return calibrated(prepared(plant, recordings[:1], recordings[1:], 0.75, hold)[0])
