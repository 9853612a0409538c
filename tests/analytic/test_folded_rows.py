"""What a mode near the rate of the rows folds into the band, against the exact answer to a torque that is held."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from feeddrive.diagnosis.motion.band import comparison_band, sensor_noise
from feeddrive.diagnosis.motion.folded import _folded, folded_rows, folded_sentence
from feeddrive.plant.analysis.modes import free_modes
from feeddrive.plant.chain.lumped_chains import Rigid, ThreeInertias
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.typing import ComplexArray, FloatArray

LIGHT = ThreeInertias(
    {
        "lead": 0.012, "motor_inertia": 6.9e-4, "screw_inertia": 5.8e-4, "torsional_stiffness": 11000.0,
        "torsional_damping": 0.057, "axial_stiffness": 2.4e8, "axial_damping": 7900.0, "table_mass": 75.0,
    }
)  # fmt: skip
"""A light axis whose screw swings against its motor near 1 kHz, damped by some per cent."""


def plant() -> Plant:
    """The light axis."""
    return Plant("light", LIGHT, ())


def answers(rate: float, frequency: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """Motor angle per torque of a torque held for a row: exact at the rows, and of its part at the frequency alone."""
    values = plant().chain_values()
    chain = plant().chain
    M, C, K = (np.array(matrix(values, 0.0), dtype=float) for matrix in (chain.mass, chain.damping, chain.stiffness))
    motor = np.array(chain.motor(values), dtype=float)
    n = len(M)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
    B = np.concatenate([np.zeros(n), np.linalg.solve(M, motor)])
    step = expm(np.block([[A, B[:, None]], [np.zeros((1, 2 * n + 1))]]) / rate)
    Ad, Bd = step[:-1, :-1], step[:-1, -1]
    w = 2 * np.pi * frequency
    C_out = np.concatenate([motor, np.zeros(n)])
    exact = np.array([C_out @ np.linalg.solve(np.exp(1j * one / rate) * np.eye(2 * n) - Ad, Bd) for one in w])
    own = np.array([C_out @ np.linalg.solve(1j * one * np.eye(2 * n) - A, B) for one in w])
    held = (1 - np.exp(-1j * w / rate)) / (1j * w / rate)
    return exact, own * held


def elastic_part(rate: float, frequency: FloatArray) -> FloatArray:
    """What is folded to a frequency over what is there, but for what a motor alone would fold; (n,)."""
    exact, own = answers(rate, frequency)
    alone, w, h = 1 / LIGHT.values["motor_inertia"], 2 * np.pi * frequency, 1 / rate
    z = np.exp(1j * w * h)
    rigid = alone * 0.5 * h**2 * (z + 1) / (z - 1) ** 2  # exact for an inertia
    rigid_own = -alone / w**2 * (1 - 1 / z) / (1j * w * h)
    found: FloatArray = np.abs((exact - own) - (rigid - rigid_own)) / np.abs(own)
    return found


def test_bound_holds_and_is_met_where_a_mode_answers() -> None:
    rate, frequency = 1000.0, np.linspace(5.0, 100.0, 400)
    mode = float(free_modes(plant()).frequencies[-1])
    assert 900 < mode < 1000  # or nothing is folded into this band
    true, told = elastic_part(rate, frequency), _folded(plant(), frequency, rate)
    # images beyond the second are smaller by the cube of their frequency: a part in thirty of the first two
    assert np.all(true < 1.05 * told)
    at = int(np.argmin(np.abs(rate - frequency - mode)))
    # at the mode itself; within its tolerance the image above the rate may be the one that meets it
    assert true[at] > 0.5 * told[at]


def test_nothing_is_folded_at_ten_times_the_rate() -> None:
    frequency = np.linspace(5.0, 100.0, 50)
    assert np.max(_folded(plant(), frequency, 10_000.0)) < 1e-5


def chirp(size: float, rate: float = 1000.0) -> Recording:
    """Noise, and in the middle third a torque that rises from 20 to 100 Hz."""
    time = np.arange(int(12 * rate)) / rate
    inside = (time > 4) & (time < 8)
    sweep = np.sin(2 * np.pi * (20 * (time - 4) + 10 * (time - 4) ** 2))
    torque = 0.002 * np.random.default_rng(3).standard_normal(len(time)) + np.where(inside, size * sweep, 0.0)
    return Recording("chirp", time, {"motor_angle": np.zeros(len(time)), "motor_torque": torque}, 1 / rate)


@pytest.mark.parametrize(("size", "seen"), [(1.0, True), (0.002, False)])
def test_rows_at_which_more_is_folded_than_the_noise_are_told(size: float, seen: bool) -> None:
    recording = chirp(size)
    band = comparison_band(plant(), 1000.0)
    rows = folded_rows(recording, plant(), band)
    time = recording.time
    assert not rows[(time < 3.9) | (time > 8.1)].any()
    assert rows.any() == seen
    if seen:  # the folded part grows with the cube of the frequency, and is largest at the mode
        fast = (time > 5.5) & (time < 6.5)
        assert rows[fast].mean() > 0.9
        said = f"{100 * np.mean(rows):.1f} % of the rows are left out: a mode near the rate of the rows, 1000 Hz"
        assert folded_sentence(rows, recording).startswith(said)
        assert sensor_noise(recording["motor_torque"], band) < 0.01


def test_a_machine_without_springs_folds_nothing() -> None:
    values = {key: LIGHT.values[key] for key in ("lead", "motor_inertia", "screw_inertia", "table_mass")}
    assert not folded_rows(chirp(1.0), Plant("rigid", Rigid(values), ()), comparison_band(plant(), 1000.0)).any()
