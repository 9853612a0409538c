"""Plants whose numbers are guessed wildly wrong: a diagnosis ends with an answer or one line, and a sane machine.

Recordings as of a small machine with an old recorder: 500 Hz, the current in a unit of its own, a coarse scale.
"""

from __future__ import annotations

import contextlib
import dataclasses
import io
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from feeddrive.cli.main import main
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import Recording, write_recording
from tests.generator.axis import BENCH, Sensors
from tests.generator.effects import CoulombAsymmetry, FrictionDeviation, Stribeck
from tests.generator.pair import recording_pair
from tests.recovery.rigid_runs import PLANT, Truth, rigid_run


def typed(*words: str) -> tuple[int, str]:
    """Status and standard error of the command."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        status = main([*words])
    return status, err.getvalue()


def assert_answered(plant: Path, recording: Path, out: Path) -> None:
    """An answer with a machine that the other commands read, or one line that says why not."""
    status, line = typed("diagnose", str(plant), str(recording), "--out", str(out))
    assert status in (0, 2), line
    if status == 2:
        assert len(line.strip().splitlines()) == 1
        return
    after = out / "plant_after.toml"
    values = read_plant(after).chain_values()
    assert all(value > 0 for key, value in values.items() if key.endswith(("mass", "inertia", "stiffness")) and value)
    for command in ("show", "modes"):
        assert typed(command, str(after))[0] == 0
    for channel in json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))["channels"]:
        # the rms of 2 B T > 500 values is known to 3 %
        assert channel["after"]["rms"] <= 1.1 * channel["before"]["rms"]


@pytest.mark.slow
@pytest.mark.parametrize("mass", ["0.3 kg", "40000 kg"])
def test_rigid_axis_of_a_wrong_mass(mass: str, tmp_path: Path) -> None:
    plant = tmp_path / "plant.toml"
    plant.write_text(PLANT.replace('"60.0 kg"', f'"{mass}"'), encoding="utf-8")
    made = rigid_run("old", Truth(coulomb=1.6, force=12.0, ripple=0.004), 10.0)
    current = {"motor_current": np.round(made["motor_torque"] / 0.37, 2), "motor_angle": made["motor_angle"]}
    write_recording(replace(made, channels=current), tmp_path / "old.csv")
    assert_answered(plant, tmp_path / "old.csv", tmp_path / "out")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("table", "motor", "stiffness"),
    [("2 kg", "2.6e-5 kg m^2", "244.7"), ("9000 kg", "0.3 kg m^2", "20"), ("1200 kg", "2.6e-4 kg m^2", "30")],
)
def test_elastic_axis_of_wrong_masses(table: str, motor: str, stiffness: str, tmp_path: Path) -> None:
    sensors = Sensors(torque_noise=0.06, encoder_bits=20, scale_step=1e-6, scale_noise=0.2e-6)
    softer = dataclasses.replace(BENCH.controller, speed_gain=0.7, position_gain=30.0, integral_time=0.04)
    axis = dataclasses.replace(BENCH, sample_time=2e-3, sensors=sensors, chirp_amplitude=1e-9, controller=softer)
    planted = (
        FrictionDeviation(port="table", coulomb_factor=1.6, viscous_factor=0.7),
        Stribeck(delta_force=25.0, velocity=8e-3),
        CoulombAsymmetry(delta_force=20.0),
    )
    made, _ = recording_pair(axis, planted, (5, 6), (12.0, 8.0))
    time = made.pop("time")
    made["motor_current"] = np.round(made.pop("motor_torque") / 1.37, 2)
    write_recording(Recording("old", time, made, 2e-3), tmp_path / "old.csv")
    text = (plants_folder() / "bench_axis.toml").read_text(encoding="utf-8")
    text = text.replace('"134 kg"', f'"{table}"').replace('"2.6e-3 kg m^2"', f'"{motor}"')
    plant = tmp_path / "plant.toml"
    plant.write_text(text.replace('"244.7 N/µm"', f'"{stiffness} N/µm"'), encoding="utf-8")
    assert_answered(plant, tmp_path / "old.csv", tmp_path / "out")
