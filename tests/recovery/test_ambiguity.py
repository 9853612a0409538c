"""Ambiguous sets hold what the data cannot tell apart, and nothing else; the next experiment is the one that would."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.calibration.calibrate import calibrated
from feeddrive.diagnosis.calibration.stated import said_by_effects
from feeddrive.diagnosis.certainty.ambiguity import AGAINST, Rival, ambiguous_sets, at_its_limit, rivals_of
from feeddrive.diagnosis.certainty.inclusion import asserted, odds_for, possible_effects
from feeddrive.diagnosis.certainty.next_experiment import distance, hardly_known, next_experiments
from feeddrive.diagnosis.certainty.noise_colour import independent_share
from feeddrive.diagnosis.certainty.preferred import with_the_preferred
from feeddrive.diagnosis.certainty.rehearsal import Rehearsal, rehearsals
from feeddrive.diagnosis.finding import refitting
from feeddrive.diagnosis.finding.attempt import compared
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.judging.judge import prepared_for_judging, share_of
from feeddrive.diagnosis.judging.result import Trial
from feeddrive.diagnosis.likelihood.cross_validation import compare_left_out
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.effects.base import Effect, Port
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.files import plants_folder
from feeddrive.plant.analysis.modes import inertia_at_motor
from feeddrive.plant.file.plant_file import read_plant
from tests.recovery.drawn import drawn, settled
from tests.recovery.planted import axis_plant, pair


def level() -> Effect:
    return EFFECTS["friction_deviation"].of(Port.TABLE)


def force(size: float) -> Effect:
    return EFFECTS["constant_force"].of(force=size)


def asymmetry(size: float) -> Effect:
    return EFFECTS["coulomb_asymmetry"].of(delta_force=size)


def lead(slope: float) -> Effect:
    return EFFECTS["lead_error_cumulative"].of(slope=slope)


def growth(strain: float, time_constant: float) -> Effect:
    return EFFECTS["thermal_growth"].of(strain=strain, time_constant=time_constant)


def test_small_growth_that_is_soon_over_may_be_another_lead() -> None:
    """Ten nanometres over a metre: seen beyond doubt, but not when it came about."""
    found, judged = settled([lead(1e-8)], [lead(1e-8)], growth(1e-8, 1.0), seed=3)
    (one,) = ambiguous_sets(found, rivals_of(found, judged))
    assert one.names == ("lead_error_cumulative", "thermal_growth")
    # one further coordinate takes about one standard deviation of the noise; 3.5 has a chance below one in a thousand
    assert one.distances[0] < 3.5
    assert "same signature" in one.reason


def test_law_at_its_limit_is_no_rival() -> None:
    """Growth that runs to a time constant of nothing says no more than the lead does."""
    assert at_its_limit(growth(2e-6, 0.1)) and not at_its_limit(growth(2e-6, 1.0))
    found, judged = settled([lead(2e-6)], [lead(2e-6)], growth(2e-6, 0.1), seed=3)
    assert ambiguous_sets(found, rivals_of(found, judged)) == ()


@pytest.mark.parametrize("others", [[], [level()]])
def test_asymmetry_is_no_constant_force(others: list[Effect]) -> None:
    """Even where the level is free: at rest a constant force bends the drive, and friction of any level does not."""
    found, judged = settled([asymmetry(14.0)], [asymmetry(14.0), *others], force(7.0), seed=1)
    assert ambiguous_sets(found, rivals_of(found, judged)) == ()


def softer(factor: float) -> Effect:
    return EFFECTS["stiffness_deviation"].of(factor=factor)


def test_softer_axis_may_be_a_lost_preload_up_to_the_forces_that_were_seen() -> None:
    """Lost up to more force than is told, it predicts the same; lost up to half of it, it does not."""
    found, judged = settled([softer(0.4)], [softer(0.4)], lead(1e-9), seed=7)
    (one,) = ambiguous_sets(found, rivals_of(found, judged))
    assert one.names == ("stiffness_deviation", "preload_loss")
    told = float(re.search(r"no force beyond ([\d.]+) N passed the nut", one.reason)[1])  # type: ignore[index]
    (taken,), problem = found.fit.effects, found.problem
    apart = []
    for force_seen in (1.1 * told, 0.5 * told):
        lost = EFFECTS["preload_loss"].of(ratio=taken.values["factor"], force=force_seen)
        difference = problem.unwhitened([lost]) - problem.unwhitened([taken])
        apart.append(float(np.abs(difference).max()))
    # between rows, and beside its damper, the spring carries some per cent more than is told; steps of a spring that
    # bends differ by a quarter of the noise from those of a straight one
    assert apart[0] < 0.5 < 5.0 < apart[1]


def test_stiffer_axis_is_no_lost_preload() -> None:
    found, judged = settled([softer(2.0)], [softer(2.0)], lead(1e-9), seed=7)
    assert ambiguous_sets(found, rivals_of(found, judged)) == ()


def test_small_effect_is_not_alike_to_whatever_costs_less_than_5_per_cent() -> None:
    """The contract's 5 % alone would let a payload stand in for a force that is ten standard deviations large."""
    found, judged = settled([force(1.0)], [force(1.0)], asymmetry(1.0), seed=5)
    alike = ambiguous_sets(found, rivals_of(found, judged))
    # where nothing hangs, a constant force and an offset of the recorded torque are one
    assert [one.names for one in alike] == [("constant_force", "channel_offset")]


@pytest.fixture
def heavier(tmp_path: Path) -> tuple[Problem, AxisEvidence]:
    """A mass 2.3 deviations beyond what is declared: fitted with its tolerance, and the judged recording."""
    text = (plants_folder() / "bench_axis.toml").read_text(encoding="utf-8")
    weighed = tmp_path / "weighed.toml"
    weighed.write_text(text.replace('"134 kg"', '{ value = "134 kg", tolerance = "10 %" }'), encoding="utf-8")
    plant, payload = read_plant(weighed), EFFECTS["payload"].of(mass=134 * np.expm1(2.3 * 0.05))
    fitted, judged = (prepare(one, plant, share) for one, share in zip(pair("bench", "null"), (1.0, 0.0), strict=True))
    problem = calibrated(Problem(plant, (drawn(plant, fitted, [payload], 3),), AxisPredictor()))
    assert problem.calibration is not None and [value.key for value in problem.calibration.values] == ["table_mass"]
    return problem, drawn(plant, judged, [payload], 4)


def test_what_explains_nothing_beside_a_value_within_its_tolerance_is_no_rival(
    heavier: tuple[Problem, AxisEvidence],
) -> None:
    """Naming the mass is worth some 14 to 1; with an idle name in its place it is fitted again, at that price alone."""
    problem, judged = heavier
    rest, (taken,) = said_by_effects(problem, [EFFECTS["payload"].of(mass=0.0)])
    found, ripple = fit(rest, [taken]), EFFECTS["torque_ripple"].of(amplitude=1e-4, order=3.0, phase=0.0)
    tried = compared(rest, ripple.name, fit(rest, [ripple]), [])
    tried = replace(tried, comparison=replace(tried.comparison, gain=1.0, standard_error=0.0))
    search = Search(rest, found, (Trial(1, "payload", 1.0, 0.0, True),), ((tried,),), {})
    after = rest.plant.with_effects(*found.effects)
    seen = [prepared_for_judging(rest, judged, rest.plant, after)]
    assert ambiguous_sets(search, rivals_of(search, seen)) == ()


def test_a_value_beyond_its_tolerance_is_named_where_that_lowers_the_error(
    heavier: tuple[Problem, AxisEvidence], monkeypatch: pytest.MonkeyPatch
) -> None:
    problem, _ = heavier
    found = fit(problem, [])
    freed, (payload,) = said_by_effects(problem, [EFFECTS["payload"].of(mass=0.0)])
    monkeypatch.setattr(refitting, "beyond_tolerance", lambda *_: (freed, payload))
    taken = refitting.with_value_beyond(problem, found)
    assert taken is not None and [effect.name for effect in taken[1].effects] == ["payload"]
    assert taken[1].squared_error < found.squared_error
    # one value of hundreds of rows, so that blocks left out say as all do, to a hundredth
    assert taken[2].gain == pytest.approx(1 - taken[1].squared_error / found.squared_error, abs=0.01)
    # slopes that say so of what is idle, while the mass is held as declared
    monkeypatch.setattr(refitting, "beyond_tolerance", lambda *_: (freed, EFFECTS["drive_delay"].of(delay=0.0)))
    assert refitting.with_value_beyond(problem, found) is None


def test_set_is_led_by_the_member_with_fewest_parameters() -> None:
    found, judged = settled([lead(1e-8)], [growth(1e-8, 1.0)], lead(1e-8), seed=3)
    found, rivals = with_the_preferred(found, rivals_of(found, judged))
    assert [effect.name for effect in found.fit.effects] == ["lead_error_cumulative"]
    (one,) = ambiguous_sets(found, rivals)
    assert one.names == ("lead_error_cumulative", "thermal_growth")


def test_a_member_that_was_exchanged_is_tried_in_the_place_of_what_came_for_it() -> None:
    """It is none of the candidates of the round in which it went."""
    found, judged = settled([lead(1e-8)], [growth(1e-8, 1.0)], lead(1e-8), seed=3)
    (tried,) = found.rounds
    taken = (replace(found.trials[0], name="lead_error_cumulative"), Trial(2, "thermal_growth", 0.001, 0.0, True))
    found = replace(found, rounds=(tried, ()), trials=taken)
    preferred, _ = with_the_preferred(found, rivals_of(found, judged))
    assert [effect.name for effect in preferred.fit.effects] == ["lead_error_cumulative"]


@pytest.mark.parametrize(("ratio", "preferred"), [(0.99, True), (1.04, False)])
def test_a_rival_goes_first_only_where_data_not_fitted_bear_it_out(ratio: float, preferred: bool) -> None:
    """Odds that fitted data alone speak for, while others are met worse, name nothing."""
    found, _ = settled([growth(1e-6, 3.0)], [lead(1e-6)], growth(1e-6, 3.0), seed=3)
    mine = found.fit
    rival = Rival(0, fit(found.problem, [growth(1e-6, 3.0)]), -2 * AGAINST, 1.0, ratio, found.problem)
    other, _ = with_the_preferred(found, [[rival]])
    assert (other.fit is not mine) is preferred


def test_a_set_stands_beside_values_with_which_its_friction_takes_power(tmp_path: Path) -> None:
    """A drag that stood in for an asymmetry leaves less than that takes away."""
    text = (plants_folder() / "bench_axis.toml").read_text(encoding="utf-8")
    loose = tmp_path / "loose.toml"
    loose.write_text(text.replace('"300 N s/m"', '{ value = "300 N s/m", tolerance = "30 %" }'), encoding="utf-8")
    plant, asymmetric = read_plant(loose), EFFECTS["viscous_asymmetry"].of(delta_viscous=-290.0)
    evidence = prepare(pair("bench", "null")[0], plant, 1.0)
    problem = calibrated(Problem(plant, (evidence,), AxisPredictor()))
    known = problem.calibration
    assert known is not None and [value.key for value in known.values] == ["table.viscous"]
    low = replace(problem, calibration=replace(known, coordinates=np.array([-2.5])))
    measured = {name: low.predictor.predict(low.machine([asymmetric]), evidence)[name] for name in evidence.channels}
    fitting = replace(low, evidence=(replace(evidence, measured=measured),))
    assert not fitting.possible([asymmetric])
    there, found = refitting.where_friction_brakes(fitting, fit(fitting, [asymmetric], iterations=0))
    assert there.possible(found.effects)


def test_name_below_twenty_to_one_may_be_and_is_not_asserted() -> None:
    """A third of a newton on this bench is about what a further name costs."""
    found, _ = settled([force(0.34)], [force(0.34)], force(0.34), seed=7)
    (odds,) = odds_for(found, [[]])
    assert 1 / 20 < odds < 20
    sure = asserted(found)
    assert sure.fit.effects == () and sure.fit.squared_error > found.fit.squared_error
    (one,) = possible_effects(sure, [])
    assert (one.name, one.instead_of) == ("constant_force", "") and one.odds == pytest.approx(odds)
    assert "times as long" in one.settles
    large, _ = settled([force(3.0)], [force(3.0)], force(3.0), seed=7)
    assert asserted(large) is large


def test_effect_carries_where_the_judged_data_show_it_and_not_where_it_is_absent() -> None:
    found, judged = settled([force(3.0)], [force(3.0)], asymmetry(6.0), seed=7)
    assert share_of(found.problem, judged, found.fit.effects, 0).carries
    plant, evidence = axis_plant("bench"), judged[0].evidence
    assert isinstance(evidence, AxisEvidence)
    without = [replace(judged[0], evidence=drawn(plant, evidence, [], 9))]
    assert not share_of(found.problem, without, found.fit.effects, 0).carries


def test_gain_that_comes_from_a_few_blocks_is_no_scatter() -> None:
    """As a delay shows in a chirp alone: 40 blocks, two of which hold all of the gain."""
    generator = np.random.default_rng(1)
    blocks = np.repeat(np.arange(40), 250)
    after = generator.standard_normal(len(blocks))
    before = after + np.where(blocks < 2, 0.5, 0.0)
    comparison = compare_left_out(before, after, blocks)
    # d^2 = 500 x 0.25 of 10^4; chance 2 |d| = 22 of 10^4, but for the draw of two blocks
    assert comparison.gain == pytest.approx(0.0125, abs=0.004)
    assert comparison.standard_error < 0.004
    assert comparison.pays


def test_repeated_recording_leaves_the_rival_where_it_was() -> None:
    """A repeat of the recording itself: the rival, fitted to it already, stays, and d is its misfit."""
    plant = axis_plant("bench")
    evidence = prepare(pair("bench", "null")[0], plant, 1.0)
    exact = replace(evidence, measured=AxisPredictor().predict(plant.with_effects(force(5.0)), evidence))
    problem = Problem(plant, (exact,), AxisPredictor())
    rival = fit(problem, [asymmetry(1.0)])
    d = distance(problem, [force(5.0)], rival, Rehearsal("repeat", exact, 0.0))
    # 1e-3: the fit ends where a step gains no more than 1e-4 of the square
    assert d == pytest.approx(np.sqrt(independent_share(exact) * rival.squared_error), rel=1e-3)


def test_odds_after_an_experiment_are_those_that_were_foretold() -> None:
    """The mean of the rival's excess over many draws of an experiment is d^2, in independent values; 12 draws."""
    plant = axis_plant("bench")
    evidence = prepare(pair("bench", "null")[1], plant, 1.0)
    truth, wrong = force(1.0), asymmetry(1.0)
    exact = replace(evidence, measured=AxisPredictor().predict(plant.with_effects(truth), evidence))
    problem = Problem(plant, (exact,), AxisPredictor())
    rival = fit(problem, [wrong])
    d = distance(problem, [truth], rival, Rehearsal("again", exact, 0.0))
    share, excess = independent_share(evidence), []
    for seed in range(12):
        one = Problem(plant, (drawn(plant, evidence, [truth], 50 + seed),), AxisPredictor())
        excess.append(fit(one, [wrong]).squared_error - fit(one, [truth]).squared_error)
    # the excess scatters by 2 d a draw: 4 standard deviations of the mean of 12, and the share that colours it
    assert share * np.mean(excess) == pytest.approx(d**2, abs=4 * 2 * d / np.sqrt(12) + 0.05 * d**2)


def test_rehearsed_scenarios_fit_the_axis() -> None:
    plant = axis_plant("light")
    evidence = prepare(pair("light", "null")[0], plant, 1.0)
    ready = rehearsals(plant, plant, [evidence])
    reached = plant.chain.motor_radius * evidence.motion.angle
    assert {"slow_reversal", "lost_motion"} <= {one.name for one in ready}
    # a force that no recording holds, too short, and longer than what this axis has been seen to travel
    assert not {"milling", "step_position", "iso230_2"} & {one.name for one in ready}
    for one in ready:
        motion = plant.chain.motor_radius * one.evidence.motion.angle
        # 2 mm: the slack that is given at either end, and overshoot
        assert motion.min() > reached.min() - 2e-3 and motion.max() < reached.max() + 2e-3
        assert np.abs(one.evidence.recording["motor_torque"]).max() < plant.torque_limit
        assert one.evidence.recording.sample_time == pytest.approx(evidence.recording.sample_time)
        assert one.evidence.noise["motor_torque"] == pytest.approx(evidence.noise["motor_torque"], rel=1e-6)


def test_moving_inertia_is_that_of_three_inertias() -> None:
    """Motor 2.6e-3, screw 2.37e-3 and 134 kg at 20 mm per revolution: the sum by hand."""
    assert inertia_at_motor(axis_plant("bench")) == pytest.approx(2.6e-3 + 2.37e-3 + 134 * (0.02 / 2 / np.pi) ** 2)


def test_next_experiment_says_that_there_is_none_where_there_is_none() -> None:
    """Growth that is soon over and a lead: every scenario begins with a fraction of a second of it, and noise."""
    found, judged = settled([lead(1e-8)], [lead(1e-8)], growth(1e-8, 1.0), seed=3)
    (none,) = next_experiments(found, rivals_of(found, judged), [{}])
    assert none.scenario == "" and none.figure < 3.0
    assert none.sentence.startswith("no shipped scenario tells lead_error_cumulative from thermal_growth")
    assert next_experiments(found, [[]], [{}]) == ()


@pytest.mark.slow
def test_next_experiment_names_the_scenario_that_moves_the_mass() -> None:
    """A mass is known from acceleration: a sweep of the velocity beats the slow motions by far."""
    effect = EFFECTS["payload"].of(mass=0.1)
    found, _ = settled([effect], [effect], force(1.0), seed=3)
    (one,) = next_experiments(found, [[]], [{"mass": [(0.0, 0.3)]}])
    assert one.question == ("payload.mass",)
    assert one.scenario == "frf_sweep"
    assert one.figure < 0.7
    assert dict(one.ranking)["slow_reversal"] == pytest.approx(1.0, abs=0.01)


def test_hardly_known_are_sizes_whose_interval_is_as_wide_as_they_are() -> None:
    effects = [EFFECTS["stribeck"].of(delta_force=-2.0, velocity=6e-3), level()]
    wide: dict[str, list[tuple[float, float]] | None] = {"delta_force": [(-4.0, 0.0)], "velocity": [(5.9e-3, 6.1e-3)]}
    factors: dict[str, list[tuple[float, float]] | None] = {"coulomb_factor": [(0.99, 1.01)], "viscous_factor": None}
    doubts = hardly_known(effects, [wide, factors])
    assert [(doubt.place, doubt.key) for doubt in doubts] == [(1, "coulomb_factor"), (0, "delta_force")]
