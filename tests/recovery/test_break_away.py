"""The share of the deflection at which a bristle breaks away: fitted where it sticks, none where it slips at once."""

from __future__ import annotations

import pytest

from feeddrive.diagnosis.forms.bristle_form import of_likelier_bristle
from feeddrive.diagnosis.likelihood.coordinates import at_an_end, read_coordinates
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.effects.friction.presliding import Presliding
from feeddrive.effects.friction.stribeck import Stribeck
from tests.recovery.drawn import drawn
from tests.recovery.planted import axis_plant, pair

SHARES = (0.35, 0.6, 0.9)


@pytest.mark.parametrize("share", SHARES)
def test_the_share_is_found_from_that_of_a_start(share: float) -> None:
    plant = axis_plant("bench")
    evidence = prepare(pair("bench", "null")[0], plant, 1.0)
    planted = Presliding.of(stiffness=2e7, damping=200.0, break_away=share)
    problem = Problem(plant, (drawn(plant, evidence, [planted], seed=31),), AxisPredictor())
    (found,) = fit(problem, [planted.with_values(break_away=0.7, stiffness=1.7e7)]).effects
    # half of the least way from the start, so that a value that stays there fails; the stiffness began 15 % away
    assert found.values["break_away"] == pytest.approx(share, abs=0.05)
    assert found.values["stiffness"] == pytest.approx(2e7, rel=0.01)


def test_one_that_slips_from_the_start_has_no_share() -> None:
    plant = axis_plant("bench")
    slips, sticks = (Presliding.of(stiffness=1e7, damping=10.0, break_away=share) for share in (0.0, 0.7))
    assert len(read_coordinates([slips], plant)) == len(read_coordinates([sticks], plant)) - 1


@pytest.mark.parametrize("share", [1e-3, 0.98])
def test_the_ends_of_the_share_are_laws(share: float) -> None:
    assert not at_an_end(Presliding.of(stiffness=1e7, damping=0.0, break_away=share), axis_plant("bench"))


@pytest.mark.parametrize("share", [0.0, 0.4, 0.8])
def test_the_likelier_form_of_a_bristle_stands_beside_what_is_named_later(share: float) -> None:
    """Begun as one that slips throughout; where it does, the other form has a value more and leaves as much."""
    plant = axis_plant("bench")
    evidence = prepare(pair("bench", "null")[0], plant, 1.0)
    bristle = Presliding.of(stiffness=2e7, damping=200.0, break_away=share)
    drop = Stribeck.of(delta_force=30.0, velocity=0.01)
    problem = Problem(plant, (drawn(plant, evidence, [bristle, drop], seed=37),), AxisPredictor())
    slipping = fit(problem, [bristle.with_values(break_away=0.0), drop])
    _, there = of_likelier_bristle(problem, slipping, 50)
    found, _ = there.effects
    assert found.values["break_away"] == pytest.approx(share, abs=0.05)
    assert (there is slipping) is (share == 0.0)
