"""A torque in steps coarser than its noise: what they make is told from friction, and no name comes of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.diagnosis.motion.torque_steps import coarse_step, steps_of_torque
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from tests.recovery.fleet.case import case
from tests.recovery.planted import axis_plant, pair


def bench_in_steps(step: float) -> Problem:
    """The bench, which lacks nothing, with its torque rounded."""
    plant, recording = axis_plant("bench"), pair("bench", "null")[0]
    torque = step * np.round(recording["motor_torque"] / step)
    rounded = replace(recording, channels={**recording.channels, "motor_torque": torque})
    return Problem(plant, (prepare(rounded, plant, 1.0),), AxisPredictor())


def test_what_coarse_steps_make_is_what_is_left_of_a_right_prediction() -> None:
    problem = bench_in_steps(0.5)
    (evidence,) = problem.evidence
    assert coarse_step(evidence) == pytest.approx(0.5)  # type: ignore[arg-type]
    made = steps_of_torque(problem, ())
    assert made is not None
    # noise of 0.038 N m, and a torque beyond the band, flip some roundings; by chance they are alike to a fiftieth
    (torque,), (left,) = (
        [rows["motor_torque"] for rows in problem.by_channel(one)] for one in (made, problem.residual(()))
    )
    assert float(torque @ left) > 0.5 * float(np.linalg.norm(torque) * np.linalg.norm(left))


def test_steps_that_the_noise_breaks_up_make_nothing() -> None:
    """Noise of 0.038 N m is more than steps of 0.002, and of 0.1 leaves exp(-2 pi² 0.38²) of rounding, 6 %."""
    problem = bench_in_steps(0.002)
    assert coarse_step(problem.evidence[0]) == 0.0  # type: ignore[arg-type]
    assert steps_of_torque(problem, ()) is None
    problem = bench_in_steps(0.1)
    assert coarse_step(problem.evidence[0]) == pytest.approx(0.1)  # type: ignore[arg-type]
    made = steps_of_torque(problem, ())
    assert made is not None
    left = problem.residual(())
    # three times the 6 % of a rounding whose square is what is left
    assert float(made @ made) < 0.18**2 * float(left @ left)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [701_379, 701_513])
def test_a_machine_that_lacks_nothing_has_no_name_behind_coarse_steps(seed: int, tmp_path: Path) -> None:
    """A ripple and a drag of a seventh were named, which repeat what rounding makes at every passage."""
    plant_file, fitted, judged = case(seed).write(tmp_path)
    found, _ = diagnose(read_plant(plant_file), [read_recording(fitted)], [read_recording(judged)])
    assert found.effects == ()
