"""What is computed the quick way gives the numbers of the plain way, bit for bit."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.band import END_CUT, Band
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.effects.friction.coulomb_asymmetry import CoulombAsymmetry
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.effects.travel.lead_error_cumulative import LeadErrorCumulative
from feeddrive.files import find_plant
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import Recording
from feeddrive.recording.files.reading import read_recording
from feeddrive.report.figures.drawing import without_formula
from feeddrive.simulate.driven import TOLERANCE, motor_motion, motor_motions, simulate_driven


@pytest.mark.parametrize("count", [2, 15, 16, 17, 4000])
@pytest.mark.parametrize(("edge", "rate"), [(150.0, 2000.0), (25.0, 250.0), (3.0, 4000.0)])
def test_one_series_in_the_band(edge: float, rate: float, count: int) -> None:
    series = 3.0 + np.cumsum(np.random.default_rng(count).standard_normal(count))
    band, sections = Band(edge, rate), butter(4, edge, fs=rate, output="sos")
    if count <= 15:  # too short for the filter, as scipy says
        with pytest.raises(ValueError, match="length"):
            band.filter(series)
        return
    for one in (series, series[::-1]):
        np.testing.assert_array_equal(band.filter(one), sosfiltfilt(sections, one))


@pytest.mark.parametrize("count", [24_000, 24_841])
@pytest.mark.parametrize(("edge", "rate"), [(150.0, 2000.0), (25.0, 250.0), (3.0, 4000.0)])
def test_thinned_series_in_the_band(edge: float, rate: float, count: int) -> None:
    """Equal to rounding where the filter has forgotten the ends."""
    series = 3.0 + np.cumsum(np.random.default_rng(count).standard_normal(count))
    band, cut = Band(edge, rate), int(END_CUT * rate)
    rows = np.flatnonzero((np.arange(count) >= cut) & (np.arange(count) < count - cut))
    rows = rows[rows % band.thinning == 0]
    found, expected = band.thinned(series), band.filter(series)
    assert len(found) == len(expected[:: band.thinning])
    # exp(-2 pi 0.38 * 12.5) = 1e-13 is left of an end that differs by the range of the series
    assert np.abs(found[rows // band.thinning] - expected[rows]).max() < 2e-13 * np.ptp(series)


@pytest.mark.parametrize("substeps", [1, 3])
def test_several_motions_at_once(substeps: int) -> None:
    time = np.arange(3000) * 1e-3
    angles = np.cumsum(np.random.default_rng(substeps).standard_normal((3000, 4)), axis=0)
    for angle, found in zip(angles.T, motor_motions(time, angles, substeps), strict=True):
        alone = motor_motion(time, angle, substeps)
        for name in ("time", "angle", "speed", "acceleration"):
            np.testing.assert_array_equal(getattr(found, name), getattr(alone, name))


@pytest.mark.parametrize("bits", [14, 17, 26])
def test_rows_at_other_times_are_those_of_a_recording_with_such_times(bits: int) -> None:
    """With steps so large that the torque tells a part of the motion, that matter to it, and that do not."""
    recording = read_recording(Path(__file__).parents[1] / "data" / "bench" / "backlash_train.csv.gz")
    step = 2 * math.pi / 2**bits
    smooth = Band(150.0, 1 / recording.sample_time).filter(recording["motor_angle"])  # without the steps that it has
    recording = recording.with_channels({"motor_angle": step * np.round(smooth / step)})
    plant = read_plant(find_plant("bench_axis"))
    evidence, other = prepare(recording, plant, 1.0), slower(recording)
    assert bool(evidence.gains) == (bits < 20)
    found, expected = evidence.at_other_times(other).motion, prepare(other, plant, 1.0).motion
    for name in ("time", "angle", "speed", "acceleration"):
        true = getattr(expected, name)
        # what the torque tells is kept as it was solved: with times a thousandth off, within ten times as much
        allowed = 0.01 * np.std(true) if bits == 14 and name != "time" else 0.0
        assert np.max(np.abs(getattr(found, name) - true)) <= allowed


@pytest.mark.parametrize("times", [0.4, 1.3, 2.5])
def test_steps_of_several_rows_stay_so_at_other_times(times: float) -> None:
    """Of rows that come to lie further apart than a step no more steps are made than they are simulated in."""
    recording = read_recording(Path(__file__).parents[1] / "data" / "bench" / "backlash_train.csv.gz")
    rows = replace(recording, time=0.5 * recording.time, sample_time=0.5 * recording.sample_time)
    plant = read_plant(find_plant("bench_axis"))
    evidence = prepare(rows, plant, 1.0).in_steps(2)
    other = evidence.at_other_times(replace(rows, time=times * rows.time, sample_time=times * rows.sample_time))
    predicted = AxisPredictor().predict(plant, other)
    assert all(len(series) == len(rows) and np.isfinite(series).all() for series in predicted.values())


def test_what_does_nothing_is_the_machine_without_it() -> None:
    """A candidate begins with none of it: no run of its own, and the numbers of one to rounding."""
    recording = read_recording(Path(__file__).parents[1] / "data" / "bench" / "backlash_train.csv.gz")
    plant = read_plant(find_plant("bench_axis"))
    evidence, predictor = prepare(recording, plant, 1.0), AxisPredictor()
    problem, run = Problem(plant, (evidence,), predictor), predictor.load_motion
    nothing = (ConstantForce.of(force=0.0), CoulombAsymmetry.of(delta_force=0.0), LeadErrorCumulative.of(slope=0.0))
    for one in nothing:
        assert run(plant.with_effects(one), evidence).force is run(plant, evidence).force  # one simulation
        alone = simulate_driven(plant.with_effects(one), evidence.motion)
        # a thousandth of what a step may miss
        assert np.abs(alone.table_position - run(plant, evidence).table_position).max() < 1e-3 * TOLERANCE
    assert run(plant.with_effects(ConstantForce.of(force=1.0)), evidence).force is not run(plant, evidence).force
    assert problem.predicted(nothing[:1]) is problem.predicted(nothing[:1])
    with pytest.raises(ValueError, match="read-only"):
        problem.predicted(())[0] = 0.0


def slower(recording: Recording) -> Recording:
    """The same rows, a thousandth further apart."""
    return replace(recording, time=1.001 * recording.time, sample_time=1.001 * recording.sample_time)


@pytest.mark.parametrize(
    ("formula", "plain"),
    [(r"$\mathdefault{10^{2}}$", "10²"), (r"$\mathdefault{6\times10^{-4}}$", "6 × 10⁻⁴"), ("", ""), ("0.5", "0.5")],
)
def test_powers_of_ten_in_plain_letters(formula: str, plain: str) -> None:
    assert without_formula(formula) == plain
