"""A torque in steps coarser than its noise: what they make is told from friction, and no name comes of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.diagnosis.motion.torque_steps import with_open_steps
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from tests.recovery.fleet.case import case
from tests.recovery.planted import axis_plant, pair


def bench_in_steps(step: float) -> AxisEvidence:
    """The bench, which lacks nothing, with its torque rounded."""
    plant, recording = axis_plant("bench"), pair("bench", "null")[0]
    torque = step * np.round(recording["motor_torque"] / step)
    rounded = replace(recording, channels={**recording.channels, "motor_torque": torque})
    return with_open_steps(prepare(rounded, plant, 1.0), plant, AxisPredictor())


def torque_left(evidence: AxisEvidence) -> float:
    """Square of what is left of the torque beside the plant as declared, over its noise, of every sample."""
    rows = evidence.thinned(evidence.fit_rows)
    error = AxisPredictor().predict(axis_plant("bench"), evidence)["motor_torque"] - evidence.measured["motor_torque"]
    nothing = np.zeros(len(error))
    weighed = evidence.weighted({"motor_torque": error, "table_position": nothing}, rows)
    return float(weighed @ weighed) / np.count_nonzero(rows)


def test_what_coarse_steps_make_of_a_right_prediction_is_not_compared() -> None:
    evidence = bench_in_steps(0.5)
    assert evidence.rounding is not None
    # noise of 0.038 N m is a thirteenth of a step, and a torque beyond the band toggles rows as noise of a fifth does:
    # exp(-2 pi² 0.2²) is 0.45 of the first wave, which holds 0.6 of the square
    share = evidence.rounding.size / (0.5 / np.sqrt(12))
    assert 0.45 * np.sqrt(0.6) < share < 1.0
    # of the square of the rounding at least what comes again is not compared
    assert torque_left(evidence) < (1 - share**2) * torque_left(replace(evidence, rounding=None))


def test_steps_that_the_noise_breaks_up_make_nothing() -> None:
    """Noise of 0.038 N m is more than steps of 0.002, and of 0.1 leaves exp(-2 pi² 0.38²) of rounding, 6 %."""
    assert bench_in_steps(0.002).rounding is None
    evidence = bench_in_steps(0.1)
    assert evidence.rounding is not None
    # three times the 6 % of the first wave, Δ / (sqrt(2) π)
    assert evidence.rounding.size < 0.18 * 0.1 / (np.sqrt(2) * np.pi)


@pytest.mark.parametrize("share", [0.02, 0.05])
def test_steady_speeds_are_not_called_friction(share: float, tmp_path: Path) -> None:
    """Strokes at steady speeds, torque in 50 or 20 steps: a Stribeck drop of 25 N stood at odds of a million."""
    drawn = case(10_514)
    step = share * float(np.ptp(drawn.fit["motor_torque"]))
    for rows in (drawn.fit, drawn.judge):
        rows["motor_torque"] = step * np.round(rows["motor_torque"] / step)
    plant_file, fitted, judged = drawn.write(tmp_path)
    found, _ = diagnose(read_plant(plant_file), [read_recording(fitted)], [read_recording(judged)])
    assert found.effects == ()
    (torque,) = found.channels
    # what is left is what rounding alone makes, known to the scatter of some thirty steady torques
    assert torque.after.rms < 1.2 * step / np.sqrt(12)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [701_379, 701_513, 703_698])
def test_a_machine_that_lacks_nothing_has_no_name_behind_coarse_steps(seed: int, tmp_path: Path) -> None:
    """A ripple and a drag of a seventh were named, which repeat what rounding makes at every passage."""
    plant_file, fitted, judged = case(seed).write(tmp_path)
    found, _ = diagnose(read_plant(plant_file), [read_recording(fitted)], [read_recording(judged)])
    assert found.effects == ()
