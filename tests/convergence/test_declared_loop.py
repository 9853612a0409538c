"""The controller that a plant file declares: replayed and simulated against recordings of another simulator."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from feeddrive.errors import InputError
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import PositionVelocityController
from feeddrive.recording import read_recording
from feeddrive.simulate.controlled.declared_loop import DeclaredLoop, declared_loop, replayed_command
from feeddrive.typing import FloatArray
from tests.convergence.declared_run import declared_run
from tests.recovery.declared_controller import controlled_plant
from tests.recovery.planted import pair

# The chirp of the generated recordings, which no channel records, begins after some 9 s.
BEFORE_CHIRP = slice(1000, 18000)
NOISE = 0.04


def rms(series: FloatArray) -> float:
    return float(np.sqrt(np.mean(series**2)))


def loop_of(folder: Path) -> DeclaredLoop:
    loop = declared_loop(controlled_plant(folder, "bench"), 5e-4)
    assert loop is not None
    return loop


def test_a_declared_cascade_commands_what_was_recorded_until_something_else_does(tmp_path: Path) -> None:
    plant, (recording, _) = controlled_plant(tmp_path, "bench"), pair("bench", "null")
    missed = recording["motor_torque"] - replayed_command(plant, loop_of(tmp_path), recording)
    # noise of the torque sensor, and the set-point's rounding to 0.1 um through the gains
    assert rms(missed[BEFORE_CHIRP]) < 1.25 * NOISE
    assert rms(missed[20000:23000]) > 20 * NOISE


def test_a_declared_cascade_moves_the_plant_as_recorded(tmp_path: Path) -> None:
    plant, (recording, _) = controlled_plant(tmp_path, "bench"), pair("bench", "null")
    time: FloatArray = 5e-4 * np.arange(len(recording), dtype=np.float64)
    run, _ = declared_run(plant, time, recording["setpoint"], recording["setpoint"][0])
    assert rms((recording["motor_torque"] - run.command)[BEFORE_CHIRP]) < 1.1 * NOISE
    # noise and resolution of the scale are 15 nm, the set-point's rounding moves the axis by as much again
    assert rms((recording["table_position"] - run.table_position)[BEFORE_CHIRP]) < 40e-9


def test_a_controller_faster_than_the_recording(tmp_path: Path) -> None:
    plant = controlled_plant(tmp_path, "bench", rate="4 kHz")
    fine: FloatArray = 2.5e-4 * np.arange(4001, dtype=np.float64)
    setpoint: FloatArray = 0.05 * (1 - np.cos(2 * math.pi * 1.5 * fine))
    every, _ = declared_run(plant, fine, setpoint, 0.0)
    second, samples = declared_run(plant, fine[::2], setpoint[::2], 0.0)
    # what is left is the smoothing of the recorded set-point for its velocity, with other samples in its window
    assert rms((second.command - every.command)[samples]) < 0.02 * rms(every.command)
    assert rms((second.table_position - every.table_position)[samples]) < 2e-6


def test_rates_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    plant = controlled_plant(tmp_path, "bench", rate="3 kHz")
    with pytest.raises(InputError, match="no whole number of ticks") as refusal:
        declared_loop(plant, 5e-4)
    assert "velocity_rate" in refusal.value.mend


def test_velocity_from_differences_is_half_the_samples_late() -> None:
    """On a ramp under acceleration a the velocity read over m samples is a m h / 2 behind."""
    plant = read_plant(plants_folder() / "emps.toml")
    assert isinstance(plant.controller, PositionVelocityController)
    time: FloatArray = 1e-3 * np.arange(2000, dtype=np.float64)
    setpoint: FloatArray = 0.2 * time**2
    told = [replace(plant, controller=replace(plant.controller, velocity_samples=m)) for m in (0, 2)]
    exact, late = (declared_run(p, time, setpoint, 0.0)[0] for p in told)
    # the velocity is read 0.4 m/s^2 * 1 ms low, which the position gain makes up for by so much
    expected = -0.4 * 1e-3 / plant.controller.position_gain
    measured = float((late.table_position - exact.table_position)[1000:].mean())
    assert measured == pytest.approx(-expected, rel=0.02)


@pytest.mark.parametrize("samples", [-1, 65, 1.5, '"two"', "true"])
def test_a_number_of_samples_that_is_none_is_refused(samples: object, tmp_path: Path) -> None:
    text = (plants_folder() / "emps.toml").read_text(encoding="utf-8")
    path = tmp_path / "emps.toml"
    path.write_text(text.replace("velocity_samples = 2", f"velocity_samples = {samples}"), encoding="utf-8")
    with pytest.raises(InputError, match="is not a whole number from 0 to 64"):
        read_plant(path)


def test_the_recorded_positioning_system_is_under_its_declared_controller(shared_data: Path) -> None:
    folder = plants_folder()
    recording = read_recording(shared_data / "emps" / "DATA_EMPS.mat", folder / "emps_map.toml")
    plant = read_plant(folder / "emps.toml")
    loop = declared_loop(plant, recording.sample_time)
    assert loop is not None
    missed = (recording["motor_torque"] - replayed_command(plant, loop, recording))[500:-500]
    assert rms(missed) < 0.0025 * rms(recording["motor_torque"][500:-500])
