"""Declared values beyond their tolerances: asked beside every set that the search comes back to, each taken once."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.calibration import value_slopes
from feeddrive.diagnosis.calibration.beyond import with_torque_scale
from feeddrive.diagnosis.calibration.calibrate import calibrated, recalibrated
from feeddrive.diagnosis.finding import refitting
from feeddrive.diagnosis.finding import search as of_search
from feeddrive.diagnosis.finding.refitting import with_value_beyond
from feeddrive.diagnosis.finding.search import search
from feeddrive.diagnosis.likelihood.cross_validation import Comparison
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.preparation import prepared
from feeddrive.effects.base import Effect
from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.effects.source.torque_ripple import TorqueRipple
from feeddrive.plant.file.plant_file import read_plant
from tests.recovery.rigid_runs import MASS, PLANT, Truth, rigid_run


def begun(folder: Path, truth: Truth) -> Problem:
    path = folder / "rigid.toml"
    path.write_text(PLANT, encoding="utf-8")
    return prepared(read_plant(path), [rigid_run("a", truth)], [rigid_run("b", truth)], 0.75)[0]


def test_a_set_that_the_search_comes_back_to_is_asked_again_and_no_value_taken_twice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ripple, force = TorqueRipple.of(amplitude=1e-5, order=3.7, phase=0.4), ConstantForce.of(force=1e-3)
    stand_ins = [ripple, force, ripple]  # for deviations: nothing is there, so that the next round drops them
    asked: list[tuple[str, ...]] = []

    def beyond(there: Problem, found: Fit) -> tuple[Problem, Fit, Comparison]:
        asked.append(tuple(effect.name for effect in found.effects))
        idle = fit(there, (*found.effects, stand_ins[len(asked) - 1]))
        return there, idle, Comparison(0.0, 0.0, 0.0)

    monkeypatch.setattr(of_search, "with_value_beyond", beyond)
    found = search(begun(tmp_path, Truth()))
    assert asked == [(), (), ()]  # the third is the first once more, and ends the search
    assert found.fit.effects == ()


def test_a_value_is_weighed_with_rows_worth_as_much_in_both_sets(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Named, less is left to tell what a row is worth: declared values then cost more, which is no larger error."""
    problem = calibrated(begun(tmp_path, Truth(coulomb=1.2, mass=0.25 * MASS)))
    found = fit(problem, ())
    freed = refitting.beyond_tolerance(problem, found)
    assert freed is not None
    there, effect = freed

    def dearer(other: Problem, effects: Fit) -> tuple[Problem, Fit]:
        known = other.calibration
        assert known is not None
        other = other.at_values(known.coordinates, 1e3 * known.variance)
        return other, fit(other, effects.effects)

    monkeypatch.setattr(refitting, "beyond_tolerance", lambda *_: (there, effect))
    monkeypatch.setattr(refitting, "refitted", dearer)
    taken = with_value_beyond(problem, found)
    assert taken is not None
    assert taken[1].squared_error > found.squared_error  # each by what its own rows are worth
    assert [one.name for one in taken[1].effects] == [Payload.name]


def test_slopes_of_machines_that_cannot_be_simulated_move_no_value(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    problem = calibrated(begun(tmp_path, Truth()))
    known = problem.calibration
    assert known is not None

    def none_there(there: Problem, effects: tuple[Effect, ...], rough: bool = False) -> Problem:
        slopes = {
            one: {name: np.full_like(k, np.nan) for name, k in rows.items()} for one, rows in known.slopes.items()
        }
        return replace(there, calibration=replace(known, slopes=slopes))

    monkeypatch.setattr(value_slopes, "with_new_slopes", none_there)
    without = replace(problem, calibration=replace(known, taken=None))
    assert recalibrated(without, ()) is without


def test_the_scale_of_the_torque_goes_before_the_machine_only_where_it_is_the_likelier(tmp_path: Path) -> None:
    fit_to, judged = rigid_run("a", Truth()), rigid_run("b", Truth())
    path = tmp_path / "scaled.toml"
    path.write_text(PLANT, encoding="utf-8")
    scaled = [
        one.with_channels({"motor_torque": 1.3 * one["motor_torque"]}) for one in (fit_to, judged)
    ]  # far beyond the tolerance of a torque constant, and of every value of the machine
    problem = calibrated(prepared(read_plant(path), scaled[:1], scaled[1:], 0.75)[0])
    freed = with_torque_scale(problem, fit(problem, ()))
    assert freed is not None and freed.calibration is not None
    values = {
        value.key: (value, at)
        for value, at in zip(freed.calibration.values, freed.calibration.coordinates, strict=True)
    }
    value, at = values["torque_constant"]
    assert value.tolerance == pytest.approx(0.05)  # as declared, however free it is
    assert np.exp(-at * value.deviation) == pytest.approx(1.3, rel=0.1)  # masses and frictions have tolerances as well
    assert with_torque_scale(freed, fit(freed, ())) is None  # once

    machine = calibrated(begun(tmp_path, Truth(mass=0.5 * MASS)))
    assert with_torque_scale(machine, fit(machine, ())) is None
