"""An effect that may act at several places: each is a candidate, and the likelier one is taken."""

from __future__ import annotations

from dataclasses import replace

import pytest

from feeddrive.diagnosis.certainty.ambiguity import other_places
from feeddrive.diagnosis.finding.attempt import Attempt
from feeddrive.diagnosis.finding.elsewhere import at_likelier_place, elsewhere, where
from feeddrive.diagnosis.finding.round import _best_per_place
from feeddrive.diagnosis.likelihood.cross_validation import Comparison
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.effects.base import Effect, Port
from feeddrive.effects.catalogue import EFFECTS
from tests.recovery.drawn import drawn, settled
from tests.recovery.planted import axis_plant, pair

TABLE, SCREW = Port.TABLE, Port.SCREW


def warmup(port: Port, share: float = 0.5) -> Effect:
    return EFFECTS["viscous_warmup"].of(port, share=share, time_constant=2.0)


def test_where_else_an_effect_may_act() -> None:
    plant = axis_plant("bench")
    inertia = EFFECTS["inertia_deviation"].of(place="motor", inertia=1e-5)
    assert [where(one) for one in elsewhere(warmup(TABLE), plant)] == ["screw"]
    assert [where(one) for one in elsewhere(inertia, plant)] == ["screw"]
    assert elsewhere(EFFECTS["constant_force"].of(force=1.0), plant) == ()


def test_no_drag_falls_where_none_is_declared() -> None:
    plant = axis_plant("bench")
    without = replace(plant, effects=tuple(effect for effect in plant.effects if effect.port != SCREW))
    assert elsewhere(warmup(TABLE), without) == ()


def test_both_ports_of_a_law_are_candidates() -> None:
    """Which drag it is shows with the other effects free: the better of the two alone need not be the true one."""
    plant = axis_plant("bench")
    evidence = prepare(pair("bench", "null")[0], plant, 1.0)
    problem = Problem(plant, (evidence,), AxisPredictor())
    paying = Comparison(0.1, 0.0, 0.0)
    tried = [
        Attempt("viscous_warmup", fit(problem, [warmup(port)], iterations=0), paying, problem, paying)
        for port in (TABLE, SCREW, SCREW)
    ]
    assert [one.fit.effects[-1].port for one in _best_per_place(tried)] == [TABLE, SCREW]


@pytest.mark.parametrize(("true", "wrong"), [(TABLE, SCREW), (SCREW, TABLE)])
def test_the_likelier_place_is_taken(true: Port, wrong: Port) -> None:
    """The guide's drag grows with the speed, the nut's with its power 2/3: half of either is told apart."""
    plant = axis_plant("bench")
    evidence = prepare(pair("bench", "null")[0], plant, 1.0)
    problem = Problem(plant, (drawn(plant, evidence, [warmup(true)], seed=1),), AxisPredictor())
    moved = at_likelier_place(problem, fit(problem, [warmup(wrong, 0.1)]), count=30)
    assert moved is not None
    (effect,) = moved[1].effects
    assert effect.port == true
    assert at_likelier_place(*moved, count=30) is None


def test_a_place_that_the_data_cannot_tell_is_said() -> None:
    """A drag that loses next to nothing: where, nothing tells."""
    faint = warmup(TABLE, 1e-5)
    found, judged = settled([faint], [faint], EFFECTS["constant_force"].of(force=1.0), seed=3)
    (said,) = other_places(found, judged)
    assert "port = screw does as well as table" in said
