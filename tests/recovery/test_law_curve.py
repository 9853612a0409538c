"""What a law of another form leaves is its own curve; what a second effect leaves is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from feeddrive.diagnosis.finding.likelier import Taken
from feeddrive.diagnosis.finding.round import one_round
from feeddrive.diagnosis.finding.scene import scene_of
from feeddrive.diagnosis.forms.curve_in_place import of_its_own_form, of_no_name
from feeddrive.diagnosis.forms.open_map import likeliest_curve, log_odds_of_curves, with_curves_anew, with_curves_of
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.law_curve import STEPS, law_curves
from feeddrive.diagnosis.likelihood.problem import LEVEL, Problem
from feeddrive.diagnosis.likelihood.set_evidence import log_odds
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.effects.base import Effect
from feeddrive.effects.catalogue import EFFECTS
from tests.generator.axis import AXES
from tests.generator.effects import CoulombAsymmetry, PositionSpring, Stribeck, TorqueRipple, ViscousAsymmetry
from tests.generator.effects import Effect as Planted
from tests.generator.effects.relatives import Relative
from tests.generator.pair import recording_pair
from tests.recovery.planted import axis_plant
from tests.recovery.unlisted import recording

COUNT = 40
"""Candidates and starts of a round."""

POWER = {"asymmetry_power": 0.5, "asymmetry_speed": 0.05}

SOFT = Relative(CoulombAsymmetry(30.0), "a step that takes some speed", {"asymmetry_width": 0.01})


def problem_of(*planted: Planted) -> Problem:
    """A recording of the bench axis with these effects."""
    (pair, _) = recording_pair(AXES["bench"], planted, (31, 32), (7.0, 6.0))
    plant = axis_plant("bench")
    return Problem(plant, (prepare(recording(pair, "train"), plant, 1.0),), AxisPredictor())


def asked(problem: Problem, first: str, second: str) -> tuple[Problem | None, Fit]:
    """The problem with the curve of the first law open, where that is likelier than the second; and the first alone."""
    alone = fit(problem, [start(first)])
    both = fit(problem, [*alone.effects, start(second)])
    (odds, *_), opened = likeliest_curve(problem, alone, COUNT)
    return opened if odds > log_odds(problem, alone, both, COUNT) else None, alone


def start(name: str) -> Effect:
    """A law to begin a fit at."""
    values = {"viscous_asymmetry": {"delta_viscous": 50.0}, "coulomb_asymmetry": {"delta_force": 5.0}}
    values["position_spring"] = {"stiffness": 100.0, "zero": 0.3}
    return EFFECTS[name].of(**values[name])


@pytest.mark.parametrize(
    ("planted", "first", "second"),
    [
        (Relative(ViscousAsymmetry(100.0), "root", POWER), "viscous_asymmetry", "coulomb_asymmetry"),
        (Relative(PositionSpring(300.0, 0.3), "", {"spring_reach": 0.1}), "position_spring", "viscous_asymmetry"),
        (SOFT, "coulomb_asymmetry", "viscous_asymmetry"),
    ],
)
def test_a_law_of_another_form_needs_no_second_name(planted: Planted, first: str, second: str) -> None:
    problem = problem_of(planted)
    opened, alone = asked(problem, first, second)
    assert opened is not None
    # what the second name took is the curve's now: it does not pay any more
    there = fit(opened, alone.effects)
    beside = fit(opened, [*there.effects, start(second)])
    assert log_odds(opened, there, beside, COUNT) < 0
    # the law does: its curve goes with it
    bare, without = fit(problem, alone.effects), fit(problem, ())
    assert log_odds(problem, without, bare, COUNT) + log_odds_of_curves(problem, bare, COUNT, opened) > 20
    assert with_curves_of(opened, ()).evidence[0].curves == {}


@pytest.mark.parametrize(
    ("planted", "names"),
    [
        ((ViscousAsymmetry(100.0), CoulombAsymmetry(10.0)), ("viscous_asymmetry", "coulomb_asymmetry")),
        ((PositionSpring(300.0, 0.3), ViscousAsymmetry(100.0)), ("position_spring", "viscous_asymmetry")),
        # one value that says it all is likelier than a curve that may say anything over the speed
        ((CoulombAsymmetry(30.0), ViscousAsymmetry(100.0)), ("coulomb_asymmetry", "viscous_asymmetry")),
    ],
)
def test_a_second_effect_is_no_curve_of_the_first(planted: tuple[Planted, ...], names: tuple[str, str]) -> None:
    assert asked(problem_of(*planted), *names)[0] is None


@pytest.mark.parametrize("width", [0.004, 0.015, 0.04])
def test_a_step_that_takes_some_speed_keeps_its_size_beside_its_curve(width: float) -> None:
    """The mean level tells the difference of the directions whole; alone the law takes a mean of its even part.

    A curve that is of another kind at rest left half of it to a declared friction, 1.8 times itself.
    """
    problem = problem_of(Relative(CoulombAsymmetry(30.0), "soft", {"asymmetry_width": width}))
    alone = fit(problem, [start("coulomb_asymmetry")])
    _, opened = likeliest_curve(problem, alone, COUNT)
    there = fit(with_curves_anew(opened, alone.effects), alone.effects)
    assert there.effects[0].values["delta_force"] == pytest.approx(30.0, rel=0.2)  # what its curve takes of the law
    assert there.squared_error < 1.3 * len(there.residual) < alone.squared_error


def test_the_curve_of_a_law_is_asked_before_a_set_that_lacks_the_law() -> None:
    problem = problem_of(Relative(ViscousAsymmetry(100.0), "root", POWER))
    alone, others = (fit(problem, [*map(start, names)]) for names in (["viscous_asymmetry"], ["coulomb_asymmetry"]))
    (odds, *_), _ = likeliest_curve(problem, alone, COUNT)
    fewer = Taken(problem, others, "coulomb_asymmetry", 0.5 * odds)
    opened = of_its_own_form(problem, alone, fewer, COUNT)
    assert opened is not None and opened[0].evidence[0].curves.keys() == {"viscous_asymmetry"}
    assert of_its_own_form(problem, alone, replace(fewer, odds=2 * odds), COUNT) is None
    both = fit(problem, [*alone.effects, *others.effects])  # names that come beside a law are asked otherwise
    assert of_its_own_form(problem, alone, replace(fewer, fit=both), COUNT) is None


def test_a_curve_is_taken_that_leaves_more_than_noise_where_the_likeliest_name_leaves_more() -> None:
    """A second, undeclared effect keeps every set from leaving noise alone."""
    problem = problem_of(Relative(ViscousAsymmetry(100.0), "root", POWER), TorqueRipple(0.06, 3.0, 0.3))
    alone, others = (fit(problem, [*map(start, names)]) for names in (["viscous_asymmetry"], ["coulomb_asymmetry"]))
    (odds, *_), _ = likeliest_curve(problem, alone, COUNT)
    opened = of_its_own_form(problem, alone, Taken(problem, others, "coulomb_asymmetry", 0.5 * odds), COUNT)
    assert opened is not None
    left = opened[0].plain_error(opened[1].effects)
    assert left > 1 / LEVEL**2 and left < LEVEL**2 * problem.plain_error(others.effects)
    # a name that leaves hardly more may be the cause of the rest: it is asked on
    ripple = EFFECTS["torque_ripple"].of(amplitude=0.06, order=3.0, phase=0.3)
    better = Taken(problem, fit(problem, [*others.effects, ripple]), "coulomb_asymmetry", 0.5 * odds)
    assert problem.plain_error(better.fit.effects) < left
    assert of_its_own_form(problem, alone, better, COUNT) is None


def taken_instead(*planted: Planted) -> list[str] | None:
    """Laws beside a curve that take the place of an asymmetry with the speed and a Stribeck drop; None for none."""
    problem = problem_of(*planted)
    nothing = fit(problem, ())
    now = one_round(scene_of(problem, ()), nothing, {}, {})
    drop = EFFECTS["stribeck"].of(delta_force=5.0, velocity=0.02)
    names = fit(problem, [start("viscous_asymmetry"), drop])
    instead = of_no_name(problem, nothing, Taken(problem, names, "viscous_asymmetry with stribeck", 100.0), now)
    return None if instead is None else [effect.name for effect in instead[1].effects]


@pytest.mark.parametrize("width", [0.02, 0.06])
def test_a_law_is_asked_beside_its_curve_before_two_that_share_what_it_does(width: float) -> None:
    """A friction of two directions that takes some speed is near to neither of the two, nor to its own law."""
    soft = Relative(CoulombAsymmetry(30.0), "soft", {"asymmetry_width": width})
    assert taken_instead(soft) == ["coulomb_asymmetry"]


def test_two_laws_that_leave_noise_stand_beside_no_curve_of_another() -> None:
    assert taken_instead(ViscousAsymmetry(100.0), Stribeck(12.0, 0.02)) is None


def test_laws_at_other_scales_follow_a_longer_tail() -> None:
    x = np.linspace(0.0, 20.0, 2000)
    scales = np.column_stack([np.exp(-((x / step) ** 2)) for step in (1.0, *STEPS)])
    for form, most in ((1 / (1 + x), 0.05), (np.exp(-x), 0.02)):
        shares = np.linalg.lstsq(scales, form, rcond=None)[0]
        assert np.max(np.abs(scales @ shares - form)) < most
        assert np.all(np.abs(shares) < 1.0)  # within the deviation of a form


def test_a_curve_has_nothing_of_the_law_itself() -> None:
    problem = problem_of(ViscousAsymmetry(100.0))
    law = fit(problem, [start("viscous_asymmetry")])
    (evidence,) = problem.evidence
    (parts,) = law_curves(problem, law.effects, 0).values()
    rows = evidence.fit_rows
    own = problem.residual(()) - problem.residual(law.effects)
    for part in parts:
        series = evidence.weighted(part, evidence.thinned(rows))
        assert abs(series @ own) < 0.02 * np.linalg.norm(series) * np.linalg.norm(own)
    assert law_curves(problem, [EFFECTS["drive_delay"].of(delay=1e-4)], 0) == {}
    assert replace(evidence).curves == {}
