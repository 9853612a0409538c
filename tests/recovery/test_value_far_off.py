"""A declared value that is off by far, where all others have run to stand in for it."""

from __future__ import annotations

from pathlib import Path

import pytest

from feeddrive.diagnosis.calibration.beyond import beyond_tolerance
from feeddrive.diagnosis.calibration.calibrate import calibrated
from feeddrive.diagnosis.calibration.value_slopes import with_new_slopes
from feeddrive.diagnosis.finding.search import _likelier_value
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.preparation import prepared
from feeddrive.effects.chain.stiffness_deviation import StiffnessDeviation
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording

DATA = Path(__file__).resolve().parents[1] / "data" / "bench"
TRUE = 0.45
RUN_TO = {"screw_inertia": -5.0, "axial_stiffness": 6.9, "torsional_stiffness": 16.0, "table.coulomb": 4.7}
"""Deviations, as a search has left them on a drawn machine."""


def run_off(tmp_path: Path) -> Problem:
    """The bench with another stiffness declared, and its values where a search has left them."""
    text = (plants_folder() / "bench_axis.toml").read_text(encoding="utf-8")
    softer, stiffer = 'axial_stiffness = "244.7 N/µm"', f'axial_stiffness = "{244.7 / TRUE:.9g} N/µm"'
    assert softer in text
    path = tmp_path / "machine.toml"
    path.write_text(text.replace(softer, stiffer).replace("simulated recordings", "data sheets"), encoding="utf-8")
    begun = prepared(read_plant(path), [read_recording(DATA / "null_train.csv.gz")], [], 1.0)[0]
    near = calibrated(begun)
    there = near.calibration
    assert there is not None
    coordinates = there.coordinates.copy()
    for i, value in enumerate(there.values):
        coordinates[i] = RUN_TO.get(value.key, coordinates[i])
    return with_new_slopes(near.at_values(coordinates), ())


def test_a_stiffness_is_found_from_where_all_values_have_run_to(tmp_path: Path) -> None:
    far = run_off(tmp_path)
    asserted = beyond_tolerance(far, fit(far, ()))
    assert asserted is not None
    freed, effect = asserted
    assert isinstance(effect, StiffnessDeviation)
    assert freed.calibration is not None
    # the truth, but for what the other stiffness, within its tolerance, may take of it: asked there it was 0.62
    assert effect.values["factor"] == pytest.approx(TRUE, rel=0.02)
    assert max(abs(freed.calibration.coordinates)) < 2  # the others are as declared, within their tolerances


def test_a_value_far_off_competes_in_a_round(tmp_path: Path) -> None:
    """Where values have run off, the machine with the one that is off is likelier than what a round has at hand."""
    far = run_off(tmp_path)
    here = fit(far, ())
    taken = _likelier_value(far, here, None, 30)
    assert taken is not None
    (_, there), by = taken
    (effect,) = there.effects
    assert isinstance(effect, StiffnessDeviation) and by.gain > 0
    assert effect.values["factor"] == pytest.approx(TRUE, rel=0.02)
    assert _likelier_value(*taken[0], None, 30) is None  # nothing is left to be off
