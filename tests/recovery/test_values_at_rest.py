"""Declared values and effects at rest: where they began does not matter, and no step leads on."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.calibration.calibrate import calibrated, moved
from feeddrive.diagnosis.calibration.calibration import whitener
from feeddrive.diagnosis.calibration.together import cost, stepped_together
from feeddrive.diagnosis.calibration.value_slopes import ENOUGH, with_new_slopes
from feeddrive.diagnosis.certainty.inclusion import OPEN, asserted
from feeddrive.diagnosis.finding import search as searching
from feeddrive.diagnosis.finding.refitting import at_rest, refitted
from feeddrive.diagnosis.finding.round import Round, one_round
from feeddrive.diagnosis.finding.scene import Scene
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.finding.sets import members_weighed
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.effects.friction.load_dependent_friction import LoadDependentFriction
from feeddrive.effects.source.torque_ripple import TorqueRipple
from feeddrive.effects.transmission.stiffness_vs_position import StiffnessVsPosition
from tests.recovery.fleet.problem import calibrated_case
from tests.recovery.rigid_runs import Truth
from tests.recovery.test_value_asked_once import begun

STIFFER = 700_773
"""A machine of 596 kg whose axial spring is 1.3 times the declared one, shaken up to its resonance."""

SOFTER = 704_075
"""A machine of 29 kg with a friction of the load, whose axial spring is 0.85 of the declared one; torque alone."""


@pytest.mark.parametrize("away", [-3.0, 3.0])
def test_values_that_begin_elsewhere_come_to_the_same_rest(tmp_path: Path, away: float) -> None:
    near = calibrated(begun(tmp_path, Truth(coulomb=1.2)))
    ripple = TorqueRipple.of(amplitude=1e-5, order=3.7, phase=0.4)
    assert near.calibration is not None
    variance = near.calibration.variance
    far = near.at_values(near.calibration.coordinates + away)
    begin, rest = [at_rest(one, fit(one, (ripple,))) for one in (near, far)]
    begun_at, rest_at = [cost(there, then.effects, variance) for there, then in (begin, rest)]
    unmoved = cost(far, fit(far, (ripple,)).effects, variance)
    # each ends where a step takes less than half a nat: a variance of the doubled cost
    assert abs(rest_at - begun_at) < 2 * variance
    assert unmoved > rest_at + 100 * variance
    again, effects = stepped_together(rest[0], rest[1].effects)
    assert rest_at - cost(again.settled(effects), effects, variance) < variance


@pytest.mark.parametrize("away", [-3.0, 3.0])
def test_slopes_at_rest_are_those_of_where_it_is(tmp_path: Path, away: float) -> None:
    near = calibrated(begun(tmp_path, Truth(coulomb=1.2)))
    assert near.calibration is not None
    far = near.at_values(near.calibration.coordinates + away)
    there, found = at_rest(far, fit(far, (TorqueRipple.of(amplitude=1e-5, order=3.7, phase=0.4),)))
    anew = with_new_slopes(there, found.effects)
    assert there.whitener is not None and anew.whitener is not None
    columns, others = there.whitener.columns, anew.whitener.columns
    # the step of a slope is a thousandth of a value, and a slope is off by as much
    assert np.linalg.norm(columns - others) < 1e-3 * np.linalg.norm(others)


def test_name_is_weighed_against_values_at_rest_without_it(tmp_path: Path) -> None:
    """By slopes it is beyond doubt, and a spring that is softer within its tolerance says as much."""
    problem = calibrated_case(SOFTER, tmp_path)
    along = StiffnessVsPosition.of(share_over_stroke=0.142, middle_compliance=0.145, low=0.05, high=1.05)
    problem, found = refitted(problem, fit(problem, (LoadDependentFriction.of(coefficient=0.029), along)))
    search = Search(problem, found, (), (), {})
    by_slopes = members_weighed(problem, found, search.count)
    assert all(one.gain < -10 * OPEN for one in by_slopes)
    kept = asserted(search)
    assert [effect.name for effect in kept.fit.effects] == [LoadDependentFriction.name]
    (denied,) = kept.near
    assert denied.name == StiffnessVsPosition.name and denied.gain < 0


def test_tolerances_are_asked_of_values_at_rest(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    near = calibrated(begun(tmp_path, Truth()))
    assert near.calibration is not None
    asked: list[tuple[Problem, Fit]] = []

    def noted(problem: Problem, found: Fit) -> None:
        asked.append((problem, found))

    monkeypatch.setattr(searching, "with_value_beyond", noted)
    searching.search(near.at_values(near.calibration.coordinates + 1.5))  # within their tolerances, not at rest
    assert asked
    for problem, found in asked:
        there, effects = stepped_together(problem, found.effects)
        variance = near.calibration.variance
        # no step takes half a nat more: a variance of the doubled cost
        assert cost(problem, found.effects, variance) - cost(there.settled(effects), effects, variance) < variance


def test_a_search_ends_with_a_round_beside_values_at_rest(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is left hides beside values that are on their way: as much as noise here, so that the bound is lowered."""
    near = calibrated(begun(tmp_path, Truth()))
    assert near.calibration is not None
    asked: list[Problem] = []

    def noted(scene: Scene, found: Fit, impossible: dict[str, str], denied: dict[str, str], number: int) -> Round:
        asked.append(scene.problem)
        return one_round(scene, found, impossible, denied, number)

    monkeypatch.setattr(searching, "one_round", noted)
    away = near.at_values(near.calibration.coordinates + 1.5)
    searching.search(away)
    assert asked == [away]  # nothing but noise is left
    monkeypatch.setattr(searching, "UNEXPLAINED", 0.0)
    end = searching.search(away).problem
    assert len(asked) == 3 and float(np.max(np.abs(moved(asked[2], end)))) < ENOUGH < 1.0


def test_a_step_doubles_no_value(tmp_path: Path) -> None:
    """Slopes of where a value stands say nothing of twenty times it: the torsional spring had run there and stayed."""
    problem = calibrated_case(STIFFER, tmp_path)
    known = problem.calibration
    assert known is not None
    at = {value.key: math.exp(value.deviation * c) for value, c in zip(known.values, known.coordinates, strict=True)}
    # as planted, but for a third of its own deviation; of the other spring little is seen, to its deviation at most
    assert at["axial_stiffness"] == pytest.approx(1.3, rel=0.03)
    assert at["torsional_stiffness"] == pytest.approx(1.0, abs=0.1)
    assert problem.plain_error(()) < 1.3


def test_values_that_end_at_their_ends_leave_the_others_most_likely() -> None:
    random = np.random.default_rng(4)
    columns, residual = random.standard_normal((40, 3)), 3.0 * random.standard_normal(40)
    weighed = whitener(columns, np.array([0.3, -0.2, 0.1]), 2.0)
    free = weighed.most_likely(residual)
    assert weighed.most_likely(residual, free - 1, free + 1) == pytest.approx(free)
    high = free + np.array([-0.5, 1.0, 1.0])  # the first would be beyond its end
    found = weighed.most_likely(residual, free - 9, high)
    assert found[0] == high[0]

    def cost(c: np.ndarray) -> float:
        left = residual + weighed.offset - columns @ c
        return float(left @ left) + 2.0 * float(c @ c)

    assert all(cost(found) < cost(found + way * step) for way in (-1, 1) for step in 1e-3 * np.eye(3)[1:])
