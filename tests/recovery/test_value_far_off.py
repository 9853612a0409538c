"""A declared value that is off by far, where all others have run to stand in for it."""

from __future__ import annotations

from pathlib import Path

import pytest

from feeddrive.diagnosis.calibration.beyond import beyond_tolerance
from feeddrive.diagnosis.calibration.calibrate import calibrated
from feeddrive.diagnosis.calibration.value_slopes import with_new_slopes
from feeddrive.diagnosis.finding.refitting import at_rest, with_softer_spring
from feeddrive.diagnosis.finding.search import _likelier_value
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.preparation import prepared
from feeddrive.effects.chain.stiffness_deviation import StiffnessDeviation
from feeddrive.effects.transmission.preload_loss import PreloadLoss
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.recording import read_recording

DATA = Path(__file__).resolve().parents[1] / "data" / "bench"
TRUE = 0.45
RUN_TO = {"screw_inertia": -5.0, "axial_stiffness": 6.9, "torsional_stiffness": 16.0, "table.coulomb": 4.7}
"""Deviations, as a search has left them on a drawn machine."""


def as_declared(tmp_path: Path, factor: float) -> Plant:
    """The bench whose axial stiffness is a factor times the one that is declared."""
    text = (plants_folder() / "bench_axis.toml").read_text(encoding="utf-8")
    own, other = 'axial_stiffness = "244.7 N/µm"', f'axial_stiffness = "{244.7 / factor:.9g} N/µm"'
    assert own in text
    path = tmp_path / "machine.toml"
    path.write_text(text.replace(own, other).replace("simulated recordings", "data sheets"), encoding="utf-8")
    return read_plant(path)


def run_off(tmp_path: Path) -> Problem:
    """The bench with another stiffness declared, and its values where a search has left them."""
    plant = as_declared(tmp_path, TRUE)
    begun = prepared(plant, [read_recording(DATA / "null_train.csv.gz")], [], 1.0)[0]
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


@pytest.mark.parametrize("factor", [TRUE, 1.0])
def test_lost_preload_that_is_soft_under_every_force_becomes_the_softer_spring(tmp_path: Path, factor: float) -> None:
    """A preload lost within a force that is never met says only a factor; of a stiffness as declared it says none."""
    plant = as_declared(tmp_path, factor)
    problem = calibrated(prepared(plant, [read_recording(DATA / "null_train.csv.gz")], [], 1.0)[0])
    lost = fit(problem, (PreloadLoss.of(ratio=0.5, force=1e5),), iterations=4)
    softer = with_softer_spring(problem, lost, lost.effects)
    if factor == 1.0:
        assert softer is None
        return
    assert softer is not None
    problem, found = at_rest(*softer)
    (spring,) = found.effects
    assert isinstance(spring, StiffnessDeviation)
    # the truth, but for what the other stiffness may take of it, and nothing but noise and quantisation is left
    assert spring.values["factor"] == pytest.approx(TRUE, rel=0.03)
    assert problem.plain_error(found.effects) < 1.3
    assert with_softer_spring(softer[0], softer[1], softer[1].effects) is None  # no preload is lost in it
