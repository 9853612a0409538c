"""Regression of the preload torque: exact on exact data, intervals that hold the truth as often as they say."""

from __future__ import annotations

import math

import numpy as np
import pytest

from feeddrive.errors import InputError
from feeddrive.parts.screw.screw_friction import ScrewFriction, ScrewGeometry
from feeddrive.parts.screw.torque_regression import split_torque

GEOMETRY = ScrewGeometry(0.01, 0.041, math.pi / 4)
PRELOADS = np.linspace(500.0, 6000.0, 12)
COULOMB = np.array([ScrewFriction(GEOMETRY, 0.034).preload_torque(float(F)) for F in PRELOADS])


def test_exact_data_give_friction_and_load_free_torque() -> None:
    split = split_torque(PRELOADS, COULOMB + 0.04)
    assert GEOMETRY.friction_of(split)[0] == pytest.approx(0.034, rel=1e-12)
    assert split.load_free[0].value == pytest.approx(0.04, rel=1e-11)
    assert split.per_preload.half_width < 1e-15  # no scatter but rounding


def test_one_slope_and_a_torque_per_speed() -> None:
    """Grease: a part that grows with speed is not taken for friction."""
    speeds = np.repeat([157.1, 10.47, 52.4], PRELOADS.size)
    lubricant = 0.01 + 3e-4 * speeds
    split = split_torque(np.tile(PRELOADS, 3), np.tile(COULOMB, 3) + lubricant, speeds)
    assert split.speeds == pytest.approx([10.47, 52.4, 157.1])
    assert [part.value for part in split.load_free] == pytest.approx([0.01 + 3e-4 * w for w in split.speeds])
    assert GEOMETRY.friction_of(split)[0] == pytest.approx(0.034, rel=1e-12)


def test_intervals_hold_the_truth_as_often_as_they_say(generator: np.random.Generator) -> None:
    held = np.zeros(2)
    trials = 2000
    for _ in range(trials):
        split = split_torque(PRELOADS, COULOMB + 0.04 + 0.02 * generator.normal(size=PRELOADS.size), confidence=0.9)
        lower, upper = GEOMETRY.friction_of(split)[1:]
        low, high = split.load_free[0].ends
        held += np.array([lower <= 0.034 <= upper, low <= 0.04 <= high])
    # Standard deviation of the share 0.9 over 2000 trials is 0.0067; four of them.
    assert held / trials == pytest.approx(0.9, abs=0.027)


def test_a_load_free_torque_inflates_the_friction_of_single_points() -> None:
    apparent = [GEOMETRY.friction_from(F, T) for F, T in zip(PRELOADS, COULOMB + 0.05, strict=True)]
    assert np.all(np.diff(apparent) < 0) and apparent[-1] > 0.034


@pytest.mark.parametrize(
    ("preload", "torque", "speed", "fault"),
    [
        ([1e3, 2e3], [0.2, 0.4], 0.0, "2 points for 2 unknowns"),
        ([1e3, 1e3, 1e3], [0.2, 0.2, 0.2], 0.0, "does not vary"),
        ([1e3, 2e3, 3e3], [0.2, 0.2], 0.0, "3 preloads, 2 torques"),
        ([1e3, math.nan, 3e3], [0.2, 0.2, 0.3], 0.0, "preload 2 is nan"),
        ([1e3, 2e3, 3e3], [0.2, 0.2, math.inf], 0.0, "torque 3 is inf"),
        ([1e3, 2e3, 3e3], [0.2, 0.2, 0.3], [1.0, 2.0], "and 2 speeds"),
    ],
)
def test_unusable_data_are_refused(preload: list[float], torque: list[float], speed: object, fault: str) -> None:
    with pytest.raises(InputError, match=fault):
        split_torque(preload, torque, speed)  # type: ignore[arg-type]


def test_confidence_is_a_share() -> None:
    with pytest.raises(InputError, match="confidence 95"):
        split_torque(PRELOADS, COULOMB, confidence=95.0)


def test_negative_slope_gives_no_friction() -> None:
    with pytest.raises(InputError, match="is not possible"):
        GEOMETRY.friction_of(split_torque(PRELOADS, -COULOMB))
