"""The torque that a plant asks for at slow rows: what a reversal does between two of them is not early or late."""

from __future__ import annotations

import numpy as np
import pytest

from feeddrive.diagnosis.motion.band import Band
from feeddrive.effects.friction.guide_friction import GuideFriction
from feeddrive.plant.plant import Plant
from feeddrive.simulate.driven import GRID, motor_motion, simulate_driven
from feeddrive.simulate.row_steps import at_rate, on_grid
from tests.convergence.test_simulate import BENCH

FAST, EVERY, EDGE = 0.25e-3, 8, 50.0
FRICTION = GuideFriction.of(coulomb=200.0, viscous=0.0, smoothing_velocity=2e-4)


def angle_at(time: np.ndarray) -> np.ndarray:
    """Reversals that fall anywhere between the rows."""
    return 12.0 * np.sin(2 * np.pi * 1.37 * time)


def test_a_reversal_between_slow_rows_is_told_as_fast_rows_tell_it() -> None:
    plant = Plant("sliding", BENCH, (FRICTION,))
    fast_time = FAST * np.arange(32001)
    fast = simulate_driven(plant, motor_motion(fast_time, angle_at(fast_time))).torque
    slow = simulate_driven(plant, motor_motion(fast_time[::EVERY], angle_at(fast_time[::EVERY]))).torque
    true = Band(EDGE, 1 / FAST).filter(fast)[::EVERY]
    band = Band(EDGE, 1 / (EVERY * FAST))
    inner = slice(250, -250)
    told, read = (np.abs(band.filter(one) - true)[inner] for one in (slow, fast[::EVERY]))
    jump = np.ptp(true[inner])
    assert told.max() < 1e-3 * jump  # 80 dB, and what the spline leaves
    assert read.max() > 5 * told.max()  # the rows alone


def test_what_is_in_the_band_stays_as_it_is() -> None:
    substeps = 4
    time = np.arange(4 * 400 + 1) * GRID
    rate = 1 / (substeps * GRID)
    slow = np.sin(2 * np.pi * 0.1 * rate * time + 0.3)
    inner = slice(10, -10)
    assert at_rate(slow, substeps)[inner] == pytest.approx(slow[::substeps][inner], abs=4e-4)
    returning = np.sin(2 * np.pi * 0.95 * rate * time)  # would be read as a twentieth of the rate
    assert np.abs(at_rate(returning, substeps)[inner]).max() < 2e-4
    assert at_rate(slow, 1) is slow


def test_rows_up_to_the_grid_are_the_grid() -> None:
    assert motor_motion(GRID * np.arange(20), np.zeros(20)).substeps == 1
    made = motor_motion(4 * GRID * np.arange(20), np.arange(20.0))
    assert made.substeps == 4 and len(made.acceleration) == len(made.angle) == 77
    later = made.timed(5.0 + 4 * GRID * np.arange(20))
    assert later.time[made.samples] == pytest.approx(5.0 + 4 * GRID * np.arange(20))
    assert on_grid(np.array([0.0, 1.0, 3.0]), 2) == pytest.approx([0.0, 0.5, 1.0, 2.0, 3.0])
