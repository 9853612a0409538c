"""Pairs made on the fly: what seeds, noise, rate and numbers that are off change; and how effects are sized."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from tests.generator import BENCH, LIGHT, recording_pair, sized
from tests.generator.axis import AxisParameters
from tests.generator.effects import Effect, FrictionDeviation, PlantedEffects, Presliding, TorqueRipple, ViscousWarmup
from tests.generator.examples import examples
from tests.generator.pair import true_axis
from tests.generator.recording import time_form

SECONDS = (6.0, 6.0)


def test_seeds_change_the_noise_alone() -> None:
    """Two seeds differ by the declared noise, the motion being the same."""
    first, second = (recording_pair(LIGHT, (), seeds, SECONDS)[0] for seeds in ((1, 2), (3, 4)))
    assert np.array_equal(first["motor_angle"], second["motor_angle"])
    difference = first["motor_torque"] - second["motor_torque"]
    # 12 000 samples: 1 % of scatter, five times.
    assert np.std(difference) / math.sqrt(2.0) == pytest.approx(LIGHT.sensors.torque_noise, rel=0.04)


@pytest.mark.parametrize("factor", [0.3, 3.0])
def test_noise_factor(factor: float) -> None:
    """The noise is so many times as large, sample by sample."""
    silent, declared, noisy = (recording_pair(LIGHT, (), (1, 2), SECONDS, f)[0] for f in (0.0, 1.0, factor))
    for channel, step in (("motor_torque", 0.0), ("table_position", LIGHT.sensors.scale_step)):
        wanted = factor * (declared[channel] - silent[channel])
        # Each rounded to the scale's step once.
        assert np.max(np.abs(noisy[channel] - silent[channel] - wanted)) < 1e-12 + (2.0 + factor) * step


def test_declared_numbers_off() -> None:
    """The true axis has the factors, the rest and the controller stay; a wrong name is refused."""
    true = true_axis(BENCH, PlantedEffects(), {"table_mass": 1.2, "axial_stiffness": 0.8, "guide_coulomb": 0.7})
    assert (true.table_mass, true.axial_stiffness, true.guide_coulomb) == pytest.approx((160.8, 195.76e6, 42.0))
    back = dataclasses.replace(true, table_mass=134.0, axial_stiffness=244.7e6, guide_coulomb=60.0)
    assert back == BENCH
    with pytest.raises(ValueError, match="no number lead of the axis"):
        BENCH.off_by({"lead": 1.1})


@pytest.mark.parametrize("rate", [1000.0, 4000.0])
def test_another_rate(rate: float) -> None:
    """The same motion at another rate: as long, through the same places to the following error."""
    axis = dataclasses.replace(LIGHT, sample_time=1.0 / rate)
    usual, other = (recording_pair(item, (), (1, 2), SECONDS)[0] for item in (LIGHT, axis))
    assert other["time"].size == pytest.approx(rate * usual["time"][-1], abs=0.05 * rate)
    assert np.max(np.abs(other["table_position"] - other["setpoint"])) < 0.5e-3
    assert np.all(np.diff(np.round(other["time"], int(time_form(other["time"])[2]))) > 0)


@pytest.mark.parametrize("axis", [BENCH, LIGHT], ids=["bench", "light"])
def test_all_examples_at_once_move_as_asked(axis: AxisParameters) -> None:
    """With one example of every effect the axis still follows: no oscillation, no limit."""
    each = tuple({effect.name: effect for effect in examples(axis)}.values())
    train, validate = recording_pair(axis, each, (1, 2), SECONDS, noise_factor=0.0)
    for data in (train, validate):
        moving = data["time"] < 0.5 * data["time"][-1]
        assert np.max(np.abs(data["motor_torque"])) < axis.controller.torque_limit
        # What follows soft: position gain 60 1/s and a delay.
        assert np.max(np.abs(data["table_position"] - data["setpoint"])[moving]) < 1e-3


def noisy_error_ratio(effect: Effect) -> float:
    """Return the ratio for an effect whose error is half the noise at an amplitude of 0.1, times a quirk of 5 %."""
    assert isinstance(effect, TorqueRipple)
    own = effect.amplitude / 0.2 * (1.0 + 0.05 * math.sin(50.0 * effect.amplitude))
    return 1.0 / math.sqrt(1.0 + own**2)


@pytest.mark.parametrize("share", [0.02, 0.1, 0.5])
@pytest.mark.parametrize("amplitude", [1e-4, 0.1, 30.0])
def test_sized(share: float, amplitude: float) -> None:
    """The size found costs the wanted share, wherever the search begins."""
    calls = []

    def counted(effect: Effect) -> float:
        calls.append(effect)
        return noisy_error_ratio(effect)

    found = sized(TorqueRipple(amplitude, 6.0, 0.7), share, counted)
    # The size to 5 %, so 1 / ratio^2 - 1 to 10 %, and the share to no more.
    assert 1.0 - noisy_error_ratio(found) == pytest.approx(share, rel=0.1)
    assert (found.order, found.phase) == (6.0, 0.7)
    assert len(calls) <= 12


def test_sized_scales_what_makes_an_effect_larger() -> None:
    """Factors move away from 1; a bristle grows softer."""
    assert FrictionDeviation("table", 1.2, 0.9).scaled(2.0).coulomb_factor == pytest.approx(1.4)
    assert FrictionDeviation("table", 1.2, 0.9).scaled(2.0).viscous_factor == pytest.approx(0.8)
    assert Presliding(stiffness=5e6).scaled(2.0).stiffness == pytest.approx(2.5e6)


def test_sized_says_when_no_size_is_enough() -> None:
    """A share of the viscous drag cannot exceed 1; and what never shows is not searched for ever."""

    def half_at_two(effect: Effect) -> float:
        assert isinstance(effect, ViscousWarmup)
        return 1.0 / math.sqrt(1.0 + 0.75 * effect.share**2)

    with pytest.raises(ValueError, match="no size it can have"):
        sized(ViscousWarmup("table", 0.1, 4.0), 0.5, half_at_two)
    with pytest.raises(ValueError, match="no size it can have"):
        sized(TorqueRipple(0.1, 6.0), 0.5, lambda effect: 1.0)
