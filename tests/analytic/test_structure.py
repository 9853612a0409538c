"""Plants that share their equations: what tells them apart, and that none is given another's."""

from __future__ import annotations

import numpy as np

from feeddrive.effects.friction.guide_friction import GuideFriction
from feeddrive.plant.analysis.linear import linear_matrices
from feeddrive.plant.chain.chain import Rigid
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import structure_key
from feeddrive.simulate.held_torque import simulate_torque

VALUES = {"lead": 0.02, "motor_inertia": 2.6e-3, "screw_inertia": 2.37e-3, "table_mass": 134.0}
FRICTION = GuideFriction.of(coulomb=50.0, smoothing_velocity=1e-3, viscous=300.0)


def test_values_written_in_another_order_give_the_same_motion() -> None:
    """The equations read columns: two plants alike but for the order of their values must not swap them."""
    plain = Plant("axis", Rigid(VALUES), (FRICTION,))
    turned = Plant("axis", Rigid(dict(reversed(VALUES.items()))), (FRICTION,))
    torque = np.full(200, 2.0)
    runs = [simulate_torque(plant, np.arange(200) * 1e-3, torque) for plant in (plain, turned, plain)]
    for run in runs[1:]:
        # the same operations on the same numbers, but for the order of sums
        np.testing.assert_allclose(run.position, runs[0].position, rtol=1e-12)
    for matrix, other in zip(linear_matrices(plain), linear_matrices(turned), strict=True):
        np.testing.assert_allclose(matrix, other, rtol=1e-12)


def test_other_values_are_the_same_structure() -> None:
    """One set of equations for a whole sweep."""
    heavier = Plant("axis", Rigid(VALUES | {"table_mass": 200.0}), (FRICTION,))
    assert structure_key(heavier) == structure_key(Plant("axis", Rigid(VALUES), (FRICTION,)))
