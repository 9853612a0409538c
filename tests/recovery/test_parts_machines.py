"""Machines described by their parts, against recordings that finite elements made of them."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.errors import InputError
from feeddrive.files import find_plant
from feeddrive.plant.analysis.lumping import lump
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import Recording
from tests.generator.screw_elements import Recorder, drive_of
from tests.recovery.parts_runs import made, softer

SECONDS, JUDGED = 9.0, 7.0

# What a right prediction leaves is noise: within 4 % of its rms over the 2 B T = 2000 independent values, a few of
# which the encoder adds; the chain of few coordinates itself may miss a tenth of the scale's noise in the chirp.
TORQUE, TABLE = 1.05, 1.12


def floor(recording: Recording, name: str) -> dict[str, tuple[float, float]]:
    """Channel to rms of the error of the declared machine, and of the sensor noise that the generator added."""
    plant, how = read_plant(find_plant(name)), Recorder()
    evidence = prepare(recording, plant, 1.0)
    predicted = AxisPredictor().predict(plant, evidence)
    noise = {"motor_torque": how.torque_noise, "table_position": math.hypot(how.scale_noise, how.scale_step / 12**0.5)}
    found = {}
    for channel in evidence.channels:
        left = (evidence.measured[channel] - predicted[channel])[evidence.counted]
        found[channel] = float(np.std(left)), noise[channel] * evidence.band.noise_gain
    return found


@pytest.mark.parametrize("name", ["kimm_testbed", "hsr_axis", "vertical_axis"])
def test_the_declared_machine_leaves_noise(name: str) -> None:
    """Gear, weight, load-dependent drag, nut place and distributed screw: all of it is in the prediction."""
    left = floor(made(name, SECONDS, False, 1), name)
    for channel, most in (("motor_torque", TORQUE), ("table_position", TABLE)):
        error, noise = left[channel]
        assert error < most * noise, channel


@pytest.mark.parametrize("name", ["kimm_testbed", "hsr_axis", "vertical_axis"])
def test_what_few_coordinates_miss_is_no_evidence(name: str) -> None:
    """Recorded without noise, 60 elements differ by less than one deviation of the noise, all samples together.

    So no fitted value moves by more than one of its own deviations: intervals may know noise alone.
    """
    plant = read_plant(find_plant(name))
    noise = prepare(made(name, SECONDS, False, 1), plant, 1.0).noise
    ideal = (("torque_noise", 0.0), ("scale_noise", 0.0), ("scale_step", 1e-15), ("encoder", 1e-12))
    evidence = replace(prepare(made(name, SECONDS, False, 1, ideal), plant, 1.0), noise=noise)
    predicted, rows = AxisPredictor().predict(plant, evidence), evidence.thinned(evidence.fit_rows)
    missed = evidence.weighted({key: evidence.measured[key] - predicted[key] for key in noise}, rows)
    assert missed @ missed < 1.0


def shifted(recording: Recording, by: float, name: str) -> Recording:
    """The recording of an encoder that counts from another place [m]."""
    angle = recording["motor_angle"] - by / read_plant(find_plant(name)).chain.motor_radius
    return replace(recording, channels={**recording.channels, "motor_angle": angle})


def test_the_nut_stands_where_the_table_was_recorded() -> None:
    """An incremental encoder starts at zero wherever the table is; the stiffness is that of the table's place."""
    recording = made("kimm_testbed", SECONDS, False, 1)
    right = floor(recording, "kimm_testbed")
    left = floor(shifted(recording, 0.05, "kimm_testbed"), "kimm_testbed")
    for channel, (error, _) in left.items():
        # The same prediction but for the rounding of other angles and cells of position.
        assert error == pytest.approx(right[channel][0], rel=1e-3)


def test_a_nut_off_the_screw_is_refused() -> None:
    plant = read_plant(find_plant("kimm_testbed"))
    recording = made("kimm_testbed", SECONDS, False, 1)
    kept = {key: value for key, value in recording.channels.items() if key != "table_position"}
    without = shifted(replace(recording, channels=kept), 0.5, "kimm_testbed")
    with pytest.raises(InputError, match=r"the nut is not on the screw.*record table_position"):
        diagnose(plant, [without])
    far = {**recording.channels, "table_position": recording["table_position"] + 2.0}
    with pytest.raises(InputError, match=r"the nut is not on the screw.*zero and unit of table_position"):
        diagnose(plant, [replace(recording, channels=far)])


@pytest.mark.parametrize(("part", "planted", "place", "factor"), [
    ("nut", 0.8, "nut", 0.8),
    ("near", 0.7, "bearing", 0.7),
    # shaft of 69930 and coupling of 27000 N m/rad in series, the coupling at three quarters
    ("coupling", 0.75, "drive", (1 / 69930 + 1 / 27000) / (1 / 69930 + 1 / 20250)),
])  # fmt: skip
def test_a_fit_of_the_part_reaches_the_noise(part: str, planted: float, place: str, factor: float) -> None:
    plant = read_plant(find_plant("kimm_testbed"))
    recording = made("kimm_testbed", SECONDS, False, 1, softer(drive_of(find_plant("kimm_testbed")), part, planted))
    evidence, predictor = prepare(recording, plant, 1.0), AxisPredictor()
    start = EFFECTS["stiffness_deviation"].of(place=place, factor=1.0)
    found = fit(Problem(plant, (evidence,), predictor), [start]).effects[0]
    # Asked for are 5 %; dampers go with the stiffness in the elements and stay in the plant.
    assert found.values["factor"] == pytest.approx(factor, rel=0.02)
    predicted = predictor.predict(plant.with_effects(found), evidence)["table_position"]
    left = float(np.std((evidence.measured["table_position"] - predicted)[evidence.counted]))
    assert left < TABLE * math.hypot(Recorder().scale_noise, Recorder().scale_step / 12**0.5) * evidence.band.noise_gain


@cache
def diagnosed(name: str, part: str, factor: float) -> Diagnosis:
    changes = softer(drive_of(find_plant(name)), part, factor) if part else ()
    fitted, judged = made(name, SECONDS, False, 1, changes), made(name, JUDGED, True, 2, changes)
    return diagnose(read_plant(find_plant(name)), [fitted], validation=[judged])[0]


@pytest.mark.slow
def test_nothing_is_found_where_nothing_is_planted() -> None:
    result = diagnosed("kimm_testbed", "", 1.0)
    assert [effect.name for effect in result.effects] == []


def with_the_lumped_file(name: str, seed: int, *changes: tuple[str, object]) -> Diagnosis:
    """Recordings of the parts, diagnosed with the three inertias that `feeddrive lump` writes."""
    fitted, judged = made(name, SECONDS, False, seed, changes), made(name, JUDGED, True, seed + 1, changes)
    lumped = lump(read_plant(find_plant(name)))
    return diagnose(lumped.plant, [fitted], validation=[judged])[0]


@pytest.mark.parametrize("name", ["kimm_testbed", "hsr_axis", "vertical_axis"])
def test_what_the_lumping_misses_is_within_what_its_file_says(name: str) -> None:
    recording, plant = made(name, SECONDS, False, 1), lump(read_plant(find_plant(name))).plant
    evidence = prepare(recording, plant, 1.0)
    left = evidence.measured["table_position"] - AxisPredictor().predict(plant, evidence)["table_position"]
    missed = float(np.std(left[evidence.counted]))
    # as a stiffness that is the same everywhere would leave: the rest of the file is as good as it can be
    flat = replace(plant, effects=tuple(e for e in plant.effects if e.name != "stiffness_vs_position"))
    same = evidence.measured["table_position"] - AxisPredictor().predict(flat, evidence)["table_position"]
    assert missed < 0.5 * float(np.std(same[evidence.counted]))
    assert missed < math.hypot(evidence.model_error["table_position"], evidence.noise["table_position"])


@pytest.mark.slow
@pytest.mark.parametrize("name", ["kimm_testbed", "hsr_axis", "vertical_axis"])
def test_nothing_is_found_with_the_lumped_file(name: str) -> None:
    result = with_the_lumped_file(name, 1)
    assert [effect.name for effect in result.effects] == []


@pytest.mark.slow
def test_a_free_play_is_found_with_the_lumped_file() -> None:
    result = with_the_lumped_file("kimm_testbed", 1, ("backlash", 8e-6))
    (effect,) = result.effects
    assert effect.name == "backlash"
    assert effect.parameters["width"].value == pytest.approx(8e-6, rel=0.05)


def held(result: Diagnosis, truth: dict[str, float]) -> None:
    """The interval of every calibrated stiffness holds what was planted; others are as declared."""
    for one in result.calibrated:
        if one.key.endswith("stiffness"):
            low, high = one.ci95
            assert low < truth.get(one.key, 1.0) * one.declared < high, (one.key, low, high, one.declared)


@pytest.mark.slow
def test_a_soft_nut_within_the_tolerance_of_a_catalogue_is_calibrated() -> None:
    """A fifth softer is what a catalogue leaves open: nothing is named; nut and bearing together give way as much."""
    result = diagnosed("kimm_testbed", "nut", 0.8)
    assert [effect.name for effect in result.effects] == []
    values = {one.key: one for one in result.calibrated}
    nut, bearing = values["nut_stiffness"], values["bearing_stiffness"]
    true = 1 / (0.8 * nut.declared) + 1 / bearing.declared
    # the two are alike along the stroke; their sum is known to a tenth of what the tolerances leave open
    assert 1 / nut.value + 1 / bearing.value == pytest.approx(true, rel=0.02)
    held(result, {"nut_stiffness": 0.8})
    assert any(note.startswith("nut stiffness and bearing stiffness: ") for note in result.notes)
    (position,) = (one for one in result.channels if one.name == "table_position")
    assert position.after.rms < 1.2 * position.noise_rms


@pytest.mark.slow
def test_the_intervals_of_a_screw_held_at_both_ends_hold_what_was_planted() -> None:
    """Nut and both bearings are alike there, and all forces and springs together are poorly known."""
    result = diagnosed("hsr_axis", "nut", 0.8)
    assert [effect.name for effect in result.effects] == []
    held(result, {"nut_stiffness": 0.8})


@pytest.mark.slow
@pytest.mark.parametrize(("part", "factor"), [("nut", 0.5), ("near", 0.7)])
def test_what_no_tolerances_explain_is_named(part: str, factor: float) -> None:
    """Nut and bearing are alike: either is named, with an interval in which all of it may be its own."""
    result = diagnosed("kimm_testbed", part, factor)
    (effect,) = result.effects
    assert effect.name == "stiffness_deviation"
    named = effect.parameters["part"].value
    stiffness = {"nut": 1499e6, "bearing": 780e6}
    planted = {"nut": "nut", "near": "bearing"}[part]
    # what the named part would be if all that was planted were its own
    alone = 1 / (1 / stiffness[named] + (1 / factor - 1) / stiffness[planted]) / stiffness[named]
    ends = effect.parameters["factor"].ci95
    assert ends is not None and ends[0] < alone < ends[1]
    if planted == "bearing":
        assert any("does as well as" in note and planted in note for note in result.notes)
    held(result, {})
    (position,) = (one for one in result.channels if one.name == "table_position")
    assert position.after.rms < 1.2 * position.noise_rms
