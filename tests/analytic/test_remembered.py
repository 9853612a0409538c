"""Results kept by what they were made from: by identity, within so many bytes."""

from __future__ import annotations

import gc
from dataclasses import replace

import numpy as np
import pytest

from feeddrive.diagnosis.finding.remembered import LEAST, Remembered
from feeddrive.diagnosis.heat.heat_evidence import prepare_heat
from feeddrive.diagnosis.heat.heat_prediction import heat_predictor
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.diagnosis.recordings.recordings import RecordingPredictor
from feeddrive.effects.chain.inertia_deviation import InertiaDeviation
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import Recording
from feeddrive.simulate.driven import simulate_driven
from feeddrive.typing import FloatArray


class Source:
    """Something that is told from others by its identity alone."""


def zeros(count: int) -> FloatArray:
    return np.zeros(count)


def remembered(room: int) -> Remembered[FloatArray]:
    return Remembered(lambda series: series.nbytes, room)


def test_what_is_there_is_not_made_again() -> None:
    kept, source, made = remembered(1000), Source(), []
    for values in (1, 2, 1, 2):
        kept.found(source, values, lambda values=values: made.append(values) or zeros(10))  # type: ignore[misc,func-returns-value]
    assert made == [1, 2] and kept.size == 160


def test_the_latest_stay_within_the_room() -> None:
    kept, source, made = remembered(800), Source(), []
    for values in (*range(12), 11, 2, 0):  # ten of 80 bytes have room
        kept.found(source, values, lambda values=values: made.append(values) or zeros(10))  # type: ignore[misc,func-returns-value]
    assert made == [*range(12), 0] and kept.size == 800


def test_of_large_results_a_few_of_every_source_stay() -> None:
    kept, sources = remembered(100), [Source(), Source()]
    for values in range(20):
        for source in sources:
            kept.found(source, values, lambda: zeros(10))
    assert kept.size == 2 * LEAST * 80
    for values in range(20, 40):  # a source that is no longer asked for has no room of its own
        kept.found(sources[0], values, lambda: zeros(10))
    assert kept.size == LEAST * 80


def axis_recording(speed: float) -> Recording:
    time = np.arange(4000) * 1e-3
    angle = np.cumsum(speed * np.sin(np.pi * time / 4)) * 1e-3
    channels = {"motor_angle": angle, "motor_torque": 1e-3 * angle, "table_position": angle * 0.02 / (2 * np.pi)}
    return Recording(f"speed {speed}", time, channels, 1e-3)


def test_a_recording_is_not_taken_for_one_that_was_there_before() -> None:
    """Recordings come and go, as a program makes that diagnoses many: addresses are used again, results must not be."""
    plant = read_plant(plants_folder() / "light_axis.toml")
    predictor, fresh = AxisPredictor(), AxisPredictor()
    for turn in range(30):
        evidence = prepare(axis_recording(1.0 + turn), plant, 1.0)
        found = predictor.predict(plant, evidence)["motor_torque"]
        fresh = AxisPredictor()
        assert np.array_equal(found, fresh.predict(plant, evidence)["motor_torque"])
        del evidence
        gc.collect()


def test_a_warm_up_is_not_taken_for_one_that_was_there_before() -> None:
    plant = read_plant(plants_folder() / "thermal_bench.toml")
    predictor = heat_predictor(plant)
    for turn in range(30):
        evidence = prepare_heat(warm_up(10.0 + turn), plant.heat, 1.0)
        found = predictor.predict(plant, evidence)
        alone = replace(predictor, _known=Remembered(lambda found: 0)).predict(plant, evidence)
        assert all(np.array_equal(found[name], alone[name]) for name in found)
        del evidence
        gc.collect()


def warm_up(speed: float) -> Recording:
    rows = 60
    channels = {
        "screw_speed": np.full(rows, speed),
        "ambient_temperature": np.full(rows, 23.0),
        "nut_temperature": np.linspace(23.0, 30.0, rows),
    }
    return Recording(f"speed {speed}", 30.0 * np.arange(1, rows + 1), channels, 30.0)


def test_a_recording_without_a_number_has_none_of_another() -> None:
    """Numbers are those of the recordings themselves, which they keep alive."""
    numbers = {axis_recording(float(turn)): turn for turn in range(3)}
    predictor = RecordingPredictor(AxisPredictor(), numbers)
    del numbers
    gc.collect()
    others = [axis_recording(float(turn)) for turn in range(30)]
    assert not any(other in predictor.numbers for other in others)
    assert sorted(predictor.numbers.values()) == [0, 1, 2]


def test_motions_kept_are_bounded_by_their_bytes() -> None:
    plant = read_plant(plants_folder() / "light_axis.toml")
    evidence = prepare(axis_recording(3.0), plant, 1.0)
    predictor = AxisPredictor()
    one = predictor.load_motion(plant, evidence).size
    assert one == 6 * 8 * len(evidence.recording)
    predictor = AxisPredictor(_runs=Remembered(lambda run: run.size, 7 * one))
    for change in range(12):
        chain = replace(plant.chain, values={**plant.chain.values, "table_mass": 30.0 + change})
        predictor.load_motion(replace(plant, mechanics=chain), evidence)
    assert predictor._runs.size == 7 * one


@pytest.mark.parametrize("name", ["bench_axis", "kimm_testbed", "vertical_axis"])
def test_the_load_moves_once_for_every_inertia_of_the_motor(name: str) -> None:
    """Given the motor's motion its inertia takes a torque in proportion, and nothing else notices it."""
    plant = read_plant(plants_folder() / f"{name}.toml")
    evidence, predictor = prepare(axis_recording(3.0), plant, 1.0), AxisPredictor()
    for inertia in (0.0, 3e-4):
        other = plant.with_effects(InertiaDeviation.of(None, "motor", inertia=inertia))
        found = predictor.load_motion(other, evidence)
        simulated = simulate_driven(other, evidence.motion)
        np.testing.assert_allclose(found.torque, simulated.torque, rtol=0, atol=1e-12 * np.ptp(simulated.torque))
        np.testing.assert_array_equal(found.table_position, simulated.table_position)
    assert predictor._runs.size == found.size  # one simulation
