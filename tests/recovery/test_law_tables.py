"""A law of another form carries its curve as a table, and the declared values stay those of the machine."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from feeddrive.diagnosis.certainty.inclusion import _odds_of_curves
from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.forms.curve_in_place import with_its_curves
from feeddrive.diagnosis.forms.open_map import likeliest_curve, open_curves
from feeddrive.diagnosis.judging.judge import prepared_for_judging
from feeddrive.diagnosis.judging.law_tables import without_tables
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.effects.base import Effect, Port, number
from feeddrive.effects.friction.stribeck import Stribeck
from feeddrive.effects.tabulated import Tabulated, TabulatedForce
from tests.generator.axis import AXES
from tests.generator.effects import Stribeck as TrueStribeck
from tests.generator.effects.relatives import Relative
from tests.generator.pair import recording_pair
from tests.recovery.planted import axis_plant, declared_errors
from tests.recovery.unlisted import recording

SLOW_TAIL = Relative(TrueStribeck(-45.0, 0.04), "exp(-|v / vs|)", {"stribeck_kind": 2.0})
"""Its tail is as long as that of the catalogue's law, exp(-(v / vs)^2), with three times the velocity."""

FLOOR = 1.3
"""Error with what was found over that of a machine without the effect, as asked for laws of another form."""


@pytest.fixture(scope="module")
def runs() -> tuple:  # type: ignore[type-arg]
    pair = recording_pair(AXES["bench"], (SLOW_TAIL,), (41, 42), (7.0, 6.0))
    return tuple(recording(one, name) for one, name in zip(pair, ("train", "validate"), strict=True))


@pytest.mark.slow
def test_the_curve_is_carried_and_predicts_other_motions(runs: tuple) -> None:  # type: ignore[type-arg]
    fitted, judged = runs
    plant = axis_plant("bench")
    result, effects = diagnose(plant, [fitted], [judged])
    assert [one.name for one in result.effects] == ["stribeck"]
    tables = [one for one in effects if isinstance(one, Tabulated)]
    assert tables and all(one.place in ("velocity", "speed") for one in tables)
    _, null = recording_pair(AXES["bench"], (), (41, 42), (7.0, 6.0))
    floor = declared_errors(plant, recording(null, "validate"))
    for channel in result.channels:
        assert channel.after.rms < FLOOR * floor[channel.name].before.rms, channel.name


def test_a_curve_is_taken_anew_beside_a_law_that_has_grown(runs: tuple) -> None:  # type: ignore[type-arg]
    """Fitted alone the law is a fraction of what it is beside its curve; begun from less still, it ends as large."""
    plant = axis_plant("bench")
    problem = Problem(plant, (prepare(runs[0], plant, 1.0),), AxisPredictor())
    small = fit(problem, [Stribeck.of(delta_force=-3.0, velocity=0.04)], iterations=0)
    _, opened = likeliest_curve(problem, small, 40)
    assert open_curves(opened) == ("stribeck",)
    there, found = with_its_curves(opened, small)
    assert open_curves(there) == ("stribeck",)
    # of -45 N; what the curve takes along the law is the law's, so that a third of it may be the curve's
    assert number(found.effects[0].values["delta_force"]) == pytest.approx(-45.0, rel=0.3)
    own = there.evidence[0].curves["stribeck"], opened.evidence[0].curves["stribeck"]
    rms = [float(np.mean([np.std(part["motor_torque"]) for part in parts])) for parts in own]
    assert rms[0] > 5 * rms[1]  # a curve goes as far as its law does


def test_a_law_that_goes_takes_its_table_along(runs: tuple) -> None:  # type: ignore[type-arg]
    plant = axis_plant("bench")
    evidence = prepare(runs[1], plant, 0.0)
    law: Effect = Stribeck.of(delta_force=-45.0, velocity=0.04)
    table = TabulatedForce.of(Port.TABLE, "velocity", velocity=(-0.1, 0.0, 0.1), force=(3.0, 0.0, -3.0))
    problem = Problem(plant, (evidence,), AxisPredictor(), tables={"stribeck": (table,)})
    assert table in problem.machine([law]).effects and table not in problem.machine([]).effects
    judged = [prepared_for_judging(problem, evidence, plant, problem.machine([law]))]
    bare, plain = without_tables(problem, [law], judged)
    assert not bare.tables and table not in plain[0].after.effects
    assert without_tables(bare, [law], plain) == (bare, plain)


def test_what_speaks_for_a_curve_speaks_for_its_law(runs: tuple) -> None:  # type: ignore[type-arg]
    """A law that is hardly told from none without its curve is told with it; a table that is carried has done so."""
    plant = axis_plant("bench")
    problem = Problem(plant, (prepare(runs[0], plant, 1.0),), AxisPredictor())
    alone = fit(problem, [Stribeck.of(delta_force=-3.0, velocity=0.04)], iterations=0)
    _, opened = likeliest_curve(problem, alone, 40)
    there, found = with_its_curves(opened, alone)
    search = Search(problem, alone, (), (), {}, opened=(there, found))
    (odds,) = _odds_of_curves(search).values()
    assert odds > 100  # the curve of a Stribeck drop of 45 N
    table = TabulatedForce.of(Port.TABLE, "velocity", velocity=(0.0,), force=(1.0,))
    carried = replace(problem, tables={"stribeck": (table,)})
    assert _odds_of_curves(replace(search, problem=carried)) == {}
    assert _odds_of_curves(replace(search, fit=fit(problem, ()))) == {}  # the law has gone, and its curve with it
