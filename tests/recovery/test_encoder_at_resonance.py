"""The encoder's error where a resonance magnifies it: how much it counts, and which machine shows it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.calibration.calibrate import showing_encoder
from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion import encoder_error
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.encoder_error import SMALL
from feeddrive.diagnosis.motion.preparing import weighed_by
from feeddrive.plant.analysis.modes import braked_modes
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from tests.recovery.fleet.case import ENCODER_NULLS, case
from tests.recovery.fleet.problem import calibrated_case

RINGING = ENCODER_NULLS + 17_752
"""A machine of 442 kg with 17 bits and a scale of 0.5 µm, at 2 kHz, that lacks nothing."""


@pytest.fixture(scope="module")
def problem(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return calibrated_case(RINGING, tmp_path_factory.mktemp("ringing"))


def test_a_damping_is_not_drawn_up_by_what_the_steps_make_at_a_pole(problem: Problem) -> None:
    """With all frequencies counted alike it is, by two deviations of its tolerance: less than half of that is left."""
    known = problem.calibration
    assert known is not None
    (damping,) = (c for one, c in zip(known.values, known.coordinates, strict=True) if one.key == "axial_damping")
    assert abs(damping) < 1.0


def test_frequencies_of_much_error_count_for_little_and_others_as_before(
    problem: Problem, monkeypatch: pytest.MonkeyPatch
) -> None:
    (evidence,) = problem.evidence
    assert isinstance(evidence, AxisEvidence)
    with_play = weighed_by(evidence, problem.machine(()), plays=True)
    weighed = weighed_by(evidence, problem.machine(()))
    assert isinstance(with_play, AxisEvidence) and isinstance(weighed, AxisEvidence)
    hertz = np.fft.rfftfreq(len(evidence.recording), evidence.recording.sample_time)
    (pole,) = (p for p in braked_modes(problem.plant, 0.0).poles if 0 < p.imag < 2 * np.pi * evidence.band.edge)
    torque, bare = weighed.gains["motor_torque"], with_play.gains["motor_torque"]
    assert np.all(torque <= bare)
    at_pole = np.abs(hertz - abs(pole) / (2 * np.pi)) < 2.0
    assert np.max(torque[at_pole] / bare[at_pole]) < 0.5  # more than a tenth of what was recorded is error there
    low = (hertz > 1.0) & (hertz < 10.0)
    assert np.min(torque[low] / bare[low]) > 0.99
    assert weighed.kept["motor_torque"] < with_play.kept["motor_torque"] <= 1.0
    monkeypatch.setattr(
        encoder_error, "_share_of_recorded", lambda recorded, density, time: np.full(len(density), SMALL)
    )
    halved = weighed_by(evidence, problem.machine(()))
    assert isinstance(halved, AxisEvidence)
    np.testing.assert_allclose(halved.gains["motor_torque"], 0.5 * bare)  # a share of a tenth by definition


def test_a_damping_above_the_declared_one_does_not_hide_the_error(problem: Problem) -> None:
    known = problem.calibration
    assert known is not None
    grown = problem.at_values(np.where([one.is_damping for one in known.values], 3.0, 0.5))
    chain, declared = showing_encoder(grown, ()).chain_values(), problem.plant.chain_values()
    assert chain["axial_damping"] == pytest.approx(declared["axial_damping"])
    assert chain["table_mass"] > declared["table_mass"]
    fallen = problem.at_values(np.full(len(known.values), -1.0))
    assert showing_encoder(fallen, ()).chain_values()["axial_damping"] < declared["axial_damping"]
    assert showing_encoder(replace(problem, calibration=None), ()).chain_values() == declared


@pytest.mark.slow
def test_a_mass_that_moves_the_pole_is_inside_its_interval(tmp_path: Path) -> None:
    """One and a half times the declared table more, 20 bits and a scale of 5 µm: where the pole of the machine counted
    as that of the declared one, the damping went to eleven times what it is, and the mass 2.7 deviations off."""
    plant, fitted, judged = case(703_583).write(tmp_path)
    result, _ = diagnose(read_plant(plant), [read_recording(fitted)], [read_recording(judged)])
    (one,) = result.effects
    assert one.name == "payload"
    low, high = one.parameters["mass"].ci95  # type: ignore[misc]
    assert low < 42.28 < high
    assert high - low < 0.25 * 42.28  # one that holds half of the table as well would say nothing
