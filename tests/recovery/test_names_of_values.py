"""Names that say that a declared value is other: kept only where it is beyond its tolerance; odds of others beside."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.calibration.beyond import is_beyond, log_chance_of_values
from feeddrive.diagnosis.calibration.calibrate import calibrated
from feeddrive.diagnosis.calibration.declared import as_effect, calibrated_values, said_share
from feeddrive.diagnosis.calibration.stated import said_by_effects
from feeddrive.diagnosis.calibration.value_slopes import with_new_slopes
from feeddrive.diagnosis.certainty import inclusion
from feeddrive.diagnosis.certainty.inclusion import OPEN, _members_at_rest
from feeddrive.diagnosis.finding.refitting import with_value_back, with_value_from_declared
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.finding.sets import members_weighed
from feeddrive.diagnosis.judging.asked_of_fit import values_within_tolerance
from feeddrive.diagnosis.likelihood.coordinates import at_an_end
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.standing import Standing, odds_between
from feeddrive.effects.base import Port
from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.friction.friction_deviation import FrictionDeviation
from feeddrive.effects.friction.stribeck import Stribeck
from tests.recovery.rigid_runs import MASS, Truth
from tests.recovery.test_numbers_beside import catalogued
from tests.recovery.test_starts_beside_values import calibrated_without
from tests.recovery.test_value_asked_once import begun

TOLERANCE = 0.05
"""Of a mass from a catalogue."""


def with_payload(folder: Path, heavier: float) -> tuple[Problem, Fit]:
    """A table heavier than declared by a share of its mass, and a set that says so by a payload."""
    problem = calibrated(begun(folder, Truth(mass=heavier * MASS)))
    there, effects = said_by_effects(problem, [Payload.of(mass=heavier * MASS)])
    return there, fit(there, effects)


@pytest.mark.parametrize(("heavier", "stays"), [(0.3 * TOLERANCE, False), (4 * TOLERANCE, True)])
def test_a_payload_goes_back_into_the_tolerance_of_the_table_mass(tmp_path: Path, heavier: float, stays: bool) -> None:
    problem, found = with_payload(tmp_path, heavier)
    back = with_value_back(problem, found)
    if stays:
        assert back is None
        return
    assert back is not None
    there, without = back
    assert without.effects == () and there.calibration is not None
    (mass,) = [i for i, value in enumerate(there.calibration.values) if value.key == "table_mass"]
    value = there.calibration.values[mass]
    share = np.expm1(value.deviation * there.calibration.coordinates[mass])
    assert share == pytest.approx(heavier, abs=0.3 * TOLERANCE)  # fitted as a calibrated value


@pytest.mark.parametrize(("heavier", "denied"), [(0.3 * TOLERANCE, True), (4 * TOLERANCE, False)])
def test_a_value_is_other_only_where_its_interval_is_beyond_the_tolerance(
    tmp_path: Path, heavier: float, denied: bool
) -> None:
    problem, found = with_payload(tmp_path, heavier)
    (sentence,) = values_within_tolerance(problem, found)
    assert bool(sentence) is denied


def test_no_value_is_begun_from_the_declared_machine_where_all_are_within_their_tolerances(tmp_path: Path) -> None:
    problem = calibrated(begun(tmp_path, Truth()))
    assert with_value_from_declared(problem, fit(problem, ())) is None


def test_odds_of_a_name_do_not_depend_on_where_the_declared_values_stood() -> None:
    """Where values are off by more than their deviations a name stands in for them, and slopes assert it."""
    near, drop = calibrated_without(), Stribeck.of(Port.TABLE, delta_force=1.0, velocity=4e-3)
    assert near.calibration is not None
    far = with_new_slopes(near.at_values(near.calibration.coordinates - 1.4), [drop])
    found, moved = fit(near, [drop]), fit(far, [drop])
    (by_slopes,) = members_weighed(far, moved, 30)
    assert by_slopes.gain < -OPEN
    (there,), (here,) = (
        _members_at_rest(Search(problem, fitted, (), (), {}, tried=30))
        for problem, fitted in ((far, moved), (near, found))
    )
    # nothing was planted; rest is where a step takes less than half a nat, with the effect and without it
    assert there.gain > OPEN and there.gain == pytest.approx(here.gain, abs=1.0)


@pytest.mark.parametrize(("factor", "stands"), [(0.65, True), (0.7, True), (0.75, False), (0.85, False)])
def test_a_tolerance_denies_what_evidence_alone_would_grant(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, factor: float, stands: bool
) -> None:
    """A friction that is told to a thousandth costs no more beyond its tolerance than a name does, and is named."""
    problem = calibrated(begun(tmp_path, Truth(coulomb=factor)))
    less = FrictionDeviation.of(Port.TABLE, coulomb_factor=factor, viscous_factor=1.0)
    there, effects = said_by_effects(problem, [less])
    found = fit(there, effects)
    monkeypatch.setattr(inclusion, "SURE", math.inf)  # no member is: as behind an encoder whose steps show
    (one,) = _members_at_rest(Search(there, found, (), (), {}, tried=30))
    assert is_beyond(there, [], found.effects[0]) is stands
    assert one.without is not None
    assert odds_between(Standing(there, found), one.without, 30) > 0  # a value may be as far off as that
    assert (one.gain < -OPEN) is stands


def test_what_slopes_say_of_a_value_that_rests_within_its_tolerance_is_no_finding(tmp_path: Path) -> None:
    problem, less = (
        calibrated(begun(tmp_path, Truth(coulomb=0.7))),
        FrictionDeviation.of(Port.TABLE, coulomb_factor=0.7),
    )
    known = problem.calibration
    assert known is not None
    (place,) = [i for i, value in enumerate(known.values) if value.key == "table.coulomb"]
    assert known.coordinates[place] < -2
    assert log_chance_of_values(problem, fit(problem, ()), less) < -OPEN
    within = problem.at_values(np.where(np.arange(len(known.values)) == place, -1.0, known.coordinates))
    assert log_chance_of_values(within, fit(within, ()), less) == 0.0


@pytest.mark.parametrize("away", [-1e4, 1e4])
def test_a_value_at_its_farthest_can_be_said_by_an_effect(away: float) -> None:
    """A factor of twenty, which is where a stiffness, and what says it, end."""
    plant = catalogued().plant
    for value in calibrated_values(plant):
        if value.name:
            effect = as_effect(plant, value, away)
            assert said_share(plant, value, effect)[1] == pytest.approx(20.0 if away > 0 else 0.05)


def test_a_friction_that_is_none_is_beyond_its_tolerance(tmp_path: Path) -> None:
    """No logarithm says by how many deviations; it was taken for as declared, and its end for no estimate."""
    problem = calibrated(begun(tmp_path, Truth(coulomb=0.0)))
    none = FrictionDeviation.of(Port.TABLE, coulomb_factor=0.0, viscous_factor=1.0)
    there, effects = said_by_effects(problem, [none])
    assert is_beyond(there, [], none)
    assert with_value_back(there, fit(there, effects)) is None
    assert not at_an_end(none, problem.plant)
