"""Life that a motion takes from the nuts: against Miner's sum written out for a slow stroke, whose force is known."""

from __future__ import annotations

import math

import numpy as np
import pytest

import feeddrive as fd
from feeddrive.recording import Recording
from feeddrive.simulate.driven import used_life


def ramp() -> tuple[np.ndarray, np.ndarray, float]:
    """Time, motor angle and lead of 0.2 m at 0.1 m/s, begun and ended gently."""
    plant = fd.load("hsr_axis").plant
    time = np.arange(0.0, 3.0, 1e-3)
    shape = np.clip((time - 0.2) / 2.0, 0.0, 1.0)
    way = 0.2 * (shape - np.sin(2 * math.pi * shape) / (2 * math.pi))
    return time, way / plant.chain.motor_radius, plant.chain.values["lead"]


def test_a_slow_stroke_uses_what_the_preload_and_the_force_say() -> None:
    plant = fd.load("hsr_axis").plant
    time, angle, lead = ramp()
    force = 1500.0
    used = used_life(plant, time, angle, np.full(time.size, -force))
    assert used is not None
    assert used.revolutions[-1] == pytest.approx(0.2 / lead, rel=1e-3)
    # rigidly shared: half of the force on either side of 3.6 kN; friction of the guide adds below 100 N to it
    for total, load in zip(used.total, (3600.0 + force / 2, 3600.0 - force / 2), strict=True):
        alone = 0.2 / lead / 1e6 * (load / 52e3) ** 3
        assert total == pytest.approx(alone, rel=3 * 100 / load)
    assert used.total[0] > used.total[1]


def test_a_recording_and_a_plant_without_a_rating() -> None:
    time, angle, lead = ramp()
    axis = fd.load("hsr_axis")
    noisy = angle + 1e-6 * np.random.default_rng(5).standard_normal(angle.size)
    found = axis.used_life(Recording("stroke", time, {"motor_angle": noisy}, 1e-3))
    assert found.used is not None
    assert found.used.revolutions[-1] == pytest.approx(0.2 / lead, rel=0.01)  # the noise does not count as rolling
    assert "nut +" in str(found.listing())
    unknown = fd.load("bench_axis").used_life(Recording("stroke", time, {"motor_angle": angle}, 1e-3))
    assert unknown.used is None
    with pytest.raises(fd.InputError, match="no channel motor_angle"):
        axis.used_life(Recording("stroke", time, {"motor_torque": angle}, 1e-3))
