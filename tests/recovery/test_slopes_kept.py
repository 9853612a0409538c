"""Slopes of declared values are taken once for machines nearly alike; a search that turns back comes to rest."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.calibration import value_slopes
from feeddrive.diagnosis.calibration.beyond import _share
from feeddrive.diagnosis.calibration.calibrate import calibrated, recalibrated
from feeddrive.diagnosis.calibration.stated import said_by_effects
from feeddrive.diagnosis.calibration.value_slopes import have_slopes, with_slopes
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.effects.base import Effect
from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.source.constant_force import ConstantForce
from tests.recovery.rigid_runs import MASS, Truth
from tests.recovery.test_value_asked_once import begun


@pytest.fixture
def taken(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Effect, ...]]:
    """Effects beside which slopes were taken, in turn."""
    asked, real = [], value_slopes.with_new_slopes

    def counted(problem: Problem, effects: Sequence[Effect], rough: bool = False) -> Problem:
        asked.append(tuple(effects))
        return real(problem, effects, rough)

    monkeypatch.setattr(value_slopes, "with_new_slopes", counted)
    return asked


def test_values_at_rest_ask_for_no_new_slopes(tmp_path: Path, taken: list[tuple[Effect, ...]]) -> None:
    problem = calibrated(begun(tmp_path, Truth(coulomb=1.2)))
    assert problem.calibration is not None
    taken.clear()
    again = recalibrated(problem, ())
    assert again.calibration is not None
    assert taken == []
    np.testing.assert_allclose(again.calibration.coordinates, problem.calibration.coordinates, atol=0.1)
    far = again.at_values(problem.calibration.coordinates + 1.0)
    back = recalibrated(recalibrated(far, ()), ())
    assert taken and back.calibration is not None
    np.testing.assert_allclose(back.calibration.coordinates, problem.calibration.coordinates, atol=0.1)


def test_slopes_hold_for_a_machine_whatever_says_what_it_is(tmp_path: Path, taken: list[tuple[Effect, ...]]) -> None:
    problem = calibrated(begun(tmp_path, Truth(mass=0.1 * MASS)))
    sloped = with_slopes(problem, ())
    taken.clear()
    stated, said = said_by_effects(sloped, [Payload.of(mass=0.0)])
    assert have_slopes(stated, said)  # its mass is the payload's now: the machine is what it was
    assert with_slopes(stated, said) is stated and taken == []
    assert not have_slopes(stated, [Payload.of(mass=0.1 * MASS)])
    assert not have_slopes(sloped, [ConstantForce.of(force=1.0)])


@pytest.mark.parametrize("factor", [-1.05, -1.0, -0.5, 0.5])
def test_a_search_for_a_fixed_point_that_turns_back_and_forth_comes_to_rest(factor: float) -> None:
    at, share, before = np.zeros(2), 1.0, np.zeros(0)
    for _ in range(6):
        step = (factor - 1) * at + np.array([1.5, -0.3])
        share = _share(share, before, step) if len(before) else 1.0
        at, before = at + share * step, step
    np.testing.assert_allclose(at, np.array([1.5, -0.3]) / (1 - factor), atol=0.1)
