"""Hours of recording hold much that has no name: what it does to declared values and to what warms up."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from feeddrive.diagnosis.calibration import calibrate
from feeddrive.diagnosis.calibration.calibrate import calibrated, weighed_alike
from feeddrive.diagnosis.calibration.known import TOLERANCE
from feeddrive.diagnosis.finding.attempt import refuse_of_no_hours
from feeddrive.diagnosis.finding.scene import scene_of
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.standing import same_samples
from feeddrive.diagnosis.preparation import prepared
from feeddrive.diagnosis.starts import starts
from feeddrive.effects.catalogue import find_effect
from feeddrive.errors import InputError
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import Recording
from feeddrive.recording.long import joined
from feeddrive.typing import FloatArray
from tests.recovery import trend_machine as machine
from tests.recovery.long_production import blocks

HOURS, PLAY = 0.25, 6e-6


@pytest.fixture(scope="module")
def problem(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """A quarter of an hour at 1 kHz, of which 30 s are kept."""
    path = tmp_path_factory.mktemp("hours") / "plant.toml"
    path.write_text(machine.PLANT, encoding="utf-8")
    plant = read_plant(path)
    time, torque, angle, table = np.concatenate(list(blocks(HOURS, 12, PLAY))).T
    channels = {"motor_torque": torque, "motor_angle": angle, "table_position": table}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(joined, "KEPT_ROWS", 30_000)
        patch.setattr(joined, "KEPT", 30.0)
        recording = joined.shortened(Recording("hours", time, channels, 1e-3), plant.chain.motor_radius, 0.75)
    assert joined.is_joined(recording)
    return prepared(plant, [recording], [], 0.75)[0]


def values_of(problem: Problem) -> tuple[FloatArray, FloatArray]:
    """Declared values that were fitted, in deviations, and the rms left of torque and table position [SI]."""
    known = calibrated(problem)
    assert known.calibration is not None
    (evidence,) = known.evidence
    predicted = known.predictor.predict(known.machine(), evidence)
    rows = evidence.fit_rows
    errors = [evidence.measured[name][rows] - predicted[name][rows] for name in evidence.channels]
    return known.calibration.coordinates, np.array([float(np.std(error)) for error in errors])


def test_declared_values_stay_within_their_tolerances(problem: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    """The machine is as declared but for 6 µm of play and a lead map of 4 µm, against 20 nm of noise."""
    weighed, (torque, _) = values_of(problem)
    assert np.max(np.abs(weighed)) < TOLERANCE
    monkeypatch.setattr(calibrate, "is_joined", lambda _: False)
    by_noise, (given_up, _) = values_of(problem)
    assert np.max(np.abs(by_noise)) > TOLERANCE  # stiffness and friction stand in for both
    assert given_up > 2 * torque


def test_channels_are_weighed_by_what_is_left_of_them(problem: Problem) -> None:
    known = calibrated(problem)
    (evidence,) = known.evidence
    residual = known.unwhitened(())
    count = len(residual) // 2
    # values were fitted once more since, by less than a tenth of a deviation: 1.5 % of 0.45 N m, 0.05 N m being left
    np.testing.assert_allclose([np.std(residual[:count]), np.std(residual[count:])], 1.0, rtol=0.13)
    assert evidence.noise == problem.evidence[0].noise  # the sensor is what it was
    other = weighed_alike(problem.evidence[0], known.evidence)
    assert other.left == pytest.approx(evidence.left)
    assert not same_samples(problem, known)
    half = replace(evidence, left={name: 0.5 * one for name, one in evidence.left.items()})
    assert half.within(evidence).left == evidence.left == evidence.within(half).left  # the lesser weight


def test_what_warms_up_is_looked_for_over_the_hours(problem: Problem) -> None:
    ((first, second),) = starts.thermal_growth(scene_of(problem, ()))
    (evidence,) = problem.evidence
    lasted = float(np.ptp(evidence.recording.time[evidence.fit_rows]))
    assert lasted > 3 * np.sum(evidence.fit_rows) * evidence.recording.sample_time  # most of it was left out
    assert first.values["time_constant"] == pytest.approx(0.15 * lasted, rel=1e-3)
    assert second.values["time_constant"] == pytest.approx(0.6 * lasted, rel=1e-3)


def test_growth_that_one_stretch_alone_shows_is_none(problem: Problem) -> None:
    """It would be a lead map over the places of that stretch."""
    growth = find_effect("thermal_growth")
    ends = joined.first_stretch(problem.evidence[0].recording)
    assert 5.0 < ends < 30.0
    with pytest.raises(InputError, match="first stretch"):
        refuse_of_no_hours(problem, [growth.of(strain=1e-5, time_constant=0.5 * ends)])
    with pytest.raises(InputError, match="lead error"):  # a longer one is asked of its size
        refuse_of_no_hours(problem, [growth.of(strain=1e-5, time_constant=2 * ends)])
    whole = replace(problem.evidence[0].recording, flaws=())
    brief = replace(problem, evidence=(replace(problem.evidence[0], recording=whole),))
    refuse_of_no_hours(brief, [growth.of(strain=1e-5, time_constant=0.5)])


def test_growth_is_what_the_same_place_has_at_other_hours(problem: Problem) -> None:
    """Beside a lead map of any shape: none where nothing grows, however well places and hours go together."""
    (evidence,) = problem.evidence
    lasted = float(np.ptp(evidence.recording.time))
    growth = find_effect("thermal_growth").of(strain=3e-5, time_constant=lasted)
    effects = [find_effect("backlash").of(width=PLAY), growth]
    with pytest.raises(InputError, match="lead error"):
        refuse_of_no_hours(problem, effects)
    x, since = evidence.measured["table_position"], evidence.recording.time - evidence.recording.time[0]
    grown = x * (1 - 3e-5 * np.expm1(-since / lasted))
    other = replace(evidence, measured={**evidence.measured, "table_position": grown})
    refuse_of_no_hours(replace(problem, evidence=(other,)), effects)


def test_play_is_what_the_same_place_has_in_both_directions(problem: Problem) -> None:
    """6 µm are there, against 4 µm of lead map; once they are declared, none is left for another play."""
    play = find_effect("backlash")
    refuse_of_no_hours(problem, [play.of(width=1.2 * PLAY)])
    there = replace(problem, plant=problem.plant.with_effects(play.of(width=PLAY)))
    (evidence,) = there.evidence
    left = evidence.measured["table_position"] - there.predictor.predict(there.plant, evidence)["table_position"]
    declared = problem.predictor.predict(problem.plant, evidence)["table_position"]
    without = replace(evidence, measured={**evidence.measured, "table_position": declared + left})
    with pytest.raises(InputError, match="lead error"):
        refuse_of_no_hours(replace(problem, evidence=(without,)), [play.of(width=1e-6)])


def test_nut_crosses_its_play_before_the_table_follows() -> None:
    """Ahead and behind by half the play, where it was at rest, and between only while the motor crosses."""
    _, _, angle, table = np.concatenate(list(blocks(0.1, 12, PLAY))).T
    moved = machine.LEAD / (2 * math.pi) * angle
    ahead = table - moved - machine.lead_map(moved)
    turned = np.flatnonzero(np.diff(np.sign(np.diff(moved))))
    assert turned.size
    way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(moved)))])
    since = way - way[np.maximum.accumulate(np.where(np.isin(np.arange(len(way)), turned), np.arange(len(way)), 0))]
    held = (since > 1.5 * PLAY) | (np.diff(moved, prepend=moved[0]) == 0)
    # 20 nm of noise, and what the spring gives way by under 90 N and 120 kg
    given = (machine.COULOMB + machine.VISCOUS * 0.25 + machine.MASS * 0.6) / machine.STIFFNESS
    assert np.all(np.abs(ahead[held]) > 0.5 * PLAY - 0.1e-6)
    assert np.all(np.abs(ahead) < 0.5 * PLAY + given + 0.1e-6)
