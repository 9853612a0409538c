"""Regression of the preload torque: exact on exact data."""

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
    slope, load_free = split_torque(PRELOADS, COULOMB + 0.04)
    assert GEOMETRY.friction_from(1.0, slope) == pytest.approx(0.034, rel=1e-12)
    assert load_free == pytest.approx(0.04, rel=1e-11)


def test_a_load_free_torque_inflates_the_friction_of_single_points() -> None:
    apparent = [GEOMETRY.friction_from(F, T) for F, T in zip(PRELOADS, COULOMB + 0.05, strict=True)]
    assert np.all(np.diff(apparent) < 0) and apparent[-1] > 0.034


@pytest.mark.parametrize(("preload", "torque"), [([500.0], [0.1]), ([500.0, 500.0], [0.1, 0.2]), ([1.0, 2.0], [0.1])])
def test_one_preload_is_no_line(preload: list[float], torque: list[float]) -> None:
    with pytest.raises(InputError, match="two preloads or more"):
        split_torque(np.array(preload), np.array(torque))
