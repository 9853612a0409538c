"""The generator's spring between nut and table, its lead errors and its late channels against closed forms."""

from __future__ import annotations

import dataclasses
import math
from functools import cache

import numpy as np
import numpy.typing as npt
import pytest
from scipy.interpolate import CubicSpline

from tests.analytic.frictionless import DAMPED, FRICTIONLESS, SAMPLE, moving, run
from tests.generator.axis import BENCH, Sensors
from tests.generator.effects import (
    ChannelDelay,
    LeadErrorCumulative,
    PlantedEffects,
    PreloadLoss,
    StiffnessDeviation,
    StiffnessVsPosition,
    ThermalGrowth,
)
from tests.generator.profile import validate_profile
from tests.generator.recording import QUICK_STEP, simulate
from tests.generator.transmission import spring

Array = npt.NDArray[np.float64]

R = BENCH.transmission
K = BENCH.axial_stiffness


def force(e: float, position: float, *effects: StiffnessDeviation | StiffnessVsPosition | PreloadLoss) -> float:
    """Return the spring's force [N] at the stretch e [m]."""
    return spring(e, position, PlantedEffects(effects).planted(FRICTIONLESS))[0]


def test_stiffness_of_the_nut() -> None:
    """A factor everywhere; along the stroke a compliance that grows in a straight line: 1, 4 / 3, 5 / 3."""
    low, high = BENCH.travel
    assert force(1e-6, 0.2, StiffnessDeviation(0.6)) == pytest.approx(0.6 * K * 1e-6, rel=1e-12)
    for place, share in ((low, 0.0), (0.5 * (low + high), 0.25), (high, 0.4)):
        along = StiffnessVsPosition(share_over_stroke=0.4)
        assert force(1e-6, place, along) == pytest.approx((1.0 - share) * K * 1e-6, rel=1e-12)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_preload_loss(sign: float) -> None:
    """Soft up to 150 N, where the force is continuous, and as stiff as declared beyond."""
    loss = PreloadLoss(ratio=0.35, force=150.0)
    edge = 150.0 / (0.35 * K)
    assert force(0.5 * sign * edge, 0.2, loss) == pytest.approx(sign * 75.0, rel=1e-12)
    assert force(sign * edge, 0.2, loss) == pytest.approx(sign * 150.0, rel=1e-12)
    assert force(sign * edge * (1.0 + 1e-12), 0.2, loss) == pytest.approx(sign * 150.0, rel=1e-9)
    assert force(sign * (edge + 1e-6), 0.2, loss) == pytest.approx(sign * (150.0 + K * 1e-6), rel=1e-12)


def test_cumulative_lead_error() -> None:
    """Unloaded, the table is where r phi / (1 - slope) says, wherever the screw has turned to."""
    constants = PlantedEffects((LeadErrorCumulative(slope=3e-3),)).planted(DAMPED)
    start = moving(0.2, constants)
    start = start._replace(position=R * start.screw_angle / (1.0 - 3e-3), velocity=0.2 / (1.0 - 3e-3))
    states = run(constants, start, 0.0, 0.5)
    # 0.1 nm of 200 mm.
    assert np.max(np.abs(states[:, 4] - R * states[:, 2] / (1.0 - 3e-3))) < 1e-10


def test_thermal_growth() -> None:
    """At rest the table goes with the screw: x = r phi / (1 - strain (1 - exp(-t / tau)))."""
    constants = PlantedEffects((ThermalGrowth(strain=1e-4, time_constant=0.8),)).planted(DAMPED)
    states = run(constants, moving(0.0, constants), 0.0, 1.0)
    strain = 1e-4 * (1.0 - np.exp(-SAMPLE * np.arange(states.shape[0]) / 0.8))
    grown = R * states[:, 2] / (1.0 - strain)
    assert strain[-1] * 0.1 > 7e-6
    # After the first jerk, which swings 7 nm: 0.1 nm of 7 µm is what it takes to move 134 kg so slowly.
    assert np.max(np.abs(states[:, 4] - grown)[500:]) < 1e-10


NOISELESS = Sensors(torque_noise=0.0, encoder_bits=44, scale_step=1e-14, scale_noise=0.0)


@cache
def recorded(*effects: ChannelDelay) -> dict[str, Array]:
    """Return a noiseless recording of 6 s without the chirp."""
    quiet = dataclasses.replace(BENCH, sensors=NOISELESS)
    profile = validate_profile(quiet, 6.0).without_chirp()
    return simulate(quiet, PlantedEffects(effects), profile, seed=1, longest_step=QUICK_STEP)


def at(values: Array, shift: float) -> Array:
    """Return a smooth channel (n,) as it is `shift` [s] after every sample but the first and last twenty."""
    time = SAMPLE * np.arange(values.size)
    return np.asarray(CubicSpline(time, values)(time + shift))[20:-20]


@pytest.mark.parametrize("delay", [1.5e-3, 0.3e-3, 1.3e-3])
@pytest.mark.parametrize("channel", ["motor_angle", "table_position"])
def test_late_position(channel: str, delay: float) -> None:
    """The row at t holds the position at t - delay, and nothing else changes."""
    plain, late = recorded(), recorded(ChannelDelay(channel, delay))
    scale = R if channel == "motor_angle" else 1.0
    # A spline between samples is good to 2.5 nm where the table stops; a sample at full speed is 150 µm.
    assert np.max(np.abs(late[channel][20:-20] - at(plain[channel], -delay))) * scale < 5e-9
    assert all(np.array_equal(late[other], plain[other]) for other in plain if other != channel)


@pytest.mark.parametrize("delay", [1.5e-3, 0.3e-3, 1.3e-3])
def test_late_torque(delay: float) -> None:
    """Whole samples move the torque's rows down; the rest shows as positions read that much after it changed."""
    plain, late = recorded(), recorded(ChannelDelay("motor_torque", delay))
    rows = math.floor(delay / SAMPLE + 1e-9)
    assert np.array_equal(late["motor_torque"][rows:], plain["motor_torque"][: plain["motor_torque"].size - rows])
    # As above.
    shift = delay - rows * SAMPLE
    assert np.max(np.abs(late["table_position"][20:-20] - at(plain["table_position"], shift))) < 5e-9
