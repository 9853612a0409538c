"""Names that their own evidence denies are taken away, and what remains is refitted: recordings in closed form."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from feeddrive.diagnosis.calibration.calibrate import calibrated
from feeddrive.diagnosis.certainty.one_sided import is_told_by_slopes
from feeddrive.diagnosis.certainty.preferred import judged_apart
from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.finding.attempt import refuse_at_an_end
from feeddrive.diagnosis.finding.search import Search, search
from feeddrive.diagnosis.judging import judge as judge_of
from feeddrive.diagnosis.judging import veto, worse
from feeddrive.diagnosis.judging.asked_of_fit import AROUND_NONE, ends_reached
from feeddrive.diagnosis.judging.denied_again import settled_names
from feeddrive.diagnosis.judging.judge import Judged, Share, prepared_for_judging, share_of
from feeddrive.diagnosis.judging.veto import without_denied
from feeddrive.diagnosis.judging.where_fitted import unseen
from feeddrive.diagnosis.judging.worse import not_worse_than_declared, worse_by
from feeddrive.diagnosis.likelihood.coordinates import read_coordinates, write_coordinates
from feeddrive.diagnosis.likelihood.cross_validation import Comparison
from feeddrive.diagnosis.likelihood.evidence import UNSEEN, Evidence
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.preparation import prepared
from feeddrive.effects.base import Effect, Port
from feeddrive.effects.catalogue import find_effect
from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.friction.coulomb_asymmetry import CoulombAsymmetry
from feeddrive.effects.friction.presliding import Presliding
from feeddrive.effects.friction.stribeck import Stribeck
from feeddrive.effects.source.torque_ripple import TorqueRipple
from feeddrive.errors import InputError
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording, read_recording
from tests.recovery import trend_machine as machine
from tests.recovery.fleet.case import case
from tests.recovery.rigid_runs import COULOMB, LEAD, MASS, NOISE, PLANT, SMOOTH, STEP, VISCOUS, Truth, rigid_run

RIPPLE, BOGUS = (
    TorqueRipple.of(amplitude=0.01, order=3.0, phase=0.0),
    TorqueRipple.of(amplitude=1e-4, order=3.7, phase=0.4),
)


@pytest.fixture(scope="module")
def rigid(tmp_path_factory: pytest.TempPathFactory) -> Plant:
    """The declared rigid axis."""
    path = tmp_path_factory.mktemp("plant") / "rigid.toml"
    path.write_text(PLANT, encoding="utf-8")
    return read_plant(path)


def judging(found: Search, kept: list[Evidence]) -> list[Judged]:
    """The recordings judged on, with what was found."""
    plant = found.problem.plant
    after = plant.with_effects(*found.fit.effects)
    return [prepared_for_judging(found.problem, one, plant, after) for one in kept]


def kept_of(plant: Plant, truth: Truth, *effects: Effect, iterations: int = 12) -> tuple[Search, list[Judged]]:
    """What is kept of effects that a search is said to have taken."""
    problem, evidence, _ = prepared(plant, [rigid_run("a", truth)], [rigid_run("b", truth, slow=1.3)], 0.75)
    found = Search(problem, fit(problem, effects, iterations=iterations), (), (), {})
    return without_denied(found, judging(found, evidence), lambda other: judging(other, evidence))


def test_real_one_stays_and_one_that_is_not_there_goes(rigid: Plant) -> None:
    found, _ = kept_of(rigid, Truth(ripple=0.01), RIPPLE, BOGUS, Stribeck.of(delta_force=0.2, velocity=0.02))
    (ripple,) = found.fit.effects
    assert ripple.values["amplitude"] == pytest.approx(0.01, rel=0.1)
    assert list(found.denied) == ["stribeck"]  # of the ripples one is named still
    assert "data" in found.denied["stribeck"] or "interval" in found.denied["stribeck"]


def test_a_search_that_goes_on_asks_what_the_recordings_could_not_show_but_nothing_denied(rigid: Plant) -> None:
    """What could not be shown beside one set may be beside another; what was met and denied is not asked again."""
    problem, _, _ = prepared(rigid, [rigid_run("a", Truth(ripple=0.01))], [rigid_run("b", Truth())], 0.75)
    begun = Search(problem, fit(problem, ()), (), (), {"torque_ripple": "not beside that"})
    assert [one.name for one in search(problem, start=begun).fit.effects] == ["torque_ripple"]
    denied = replace(begun, impossible={}, denied={"torque_ripple": "on the judged data it lowers nothing"})
    assert "torque_ripple" not in [one.name for one in search(problem, start=denied).fit.effects]


@pytest.mark.parametrize("effect", [BOGUS, Payload.of(mass=0.05), CoulombAsymmetry.of(delta_force=0.1)])
def test_nothing_is_kept_of_a_recording_in_which_nothing_lacks(rigid: Plant, effect: Effect) -> None:
    found, _ = kept_of(rigid, Truth(seed=5), effect)
    assert found.fit.effects == () and list(found.denied) == [effect.name]


def test_a_refit_that_judged_motion_cannot_follow_leaves_the_others_as_they_were(
    rigid: Plant, monkeypatch: pytest.MonkeyPatch
) -> None:
    problem, evidence, _ = prepared(
        rigid, [rigid_run("a", Truth(ripple=0.01))], [rigid_run("b", Truth(ripple=0.01))], 0.75
    )
    found = Search(problem, fit(problem, [BOGUS, RIPPLE]), (), (), {})
    judged = judging(found, evidence)
    asked: list[Sequence[Effect]] = []
    plain = judge_of.share_beyond

    def share_beyond(problem: Problem, judged: Sequence[Judged], refitted: Sequence[Effect]) -> Share:
        asked.append(refitted)
        if len(asked) == 1:
            raise InputError("the plant cannot be simulated with this motion", problem.plant.name, "")
        return plain(problem, judged, refitted)

    monkeypatch.setattr(judge_of, "share_beyond", share_beyond)
    share = judge_of.share_of(problem, judged, found.fit.effects, 1)
    assert asked[1] == [found.fit.effects[0]] and asked[0] != asked[1]
    assert share.carries  # the ripple of the machine


def test_a_step_to_a_plant_that_cannot_be_simulated_denies_nothing(
    rigid: Plant, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The others are refitted then, from where they are: one linear step may lead anywhere."""

    def not_followed(problem: Problem, judged: Sequence[Judged], moved: Sequence[Effect]) -> Share:
        raise InputError("the plant cannot be simulated with this motion", problem.plant.name, "")

    monkeypatch.setattr(veto, "share_beyond", not_followed)
    found, _ = kept_of(rigid, Truth(ripple=0.01), RIPPLE, Stribeck.of(delta_force=0.2, velocity=0.02))
    assert [effect.name for effect in found.fit.effects] == ["torque_ripple"]


def test_name_denied_beside_what_was_lost_with_another_is_asked_again(rigid: Plant) -> None:
    """Twice the viscous friction, as a warm-up that is over at once, which is no estimate: the ripple goes with it.

    The search then finds the friction as such, and the ripple that stood beside the warm-up stands beside it.
    """
    truth = Truth(viscous=2.0, ripple=2e-3)
    problem, evidence, _ = prepared(rigid, [rigid_run("a", truth)], [rigid_run("b", truth, slow=1.3)], 0.75)
    warm = find_effect("viscous_warmup").of(Port.TABLE, share=-1.0, time_constant=0.1)
    ripple = TorqueRipple.of(amplitude=2e-3, order=3.0, phase=0.0)
    found = Search(problem, fit(problem, [warm, ripple]), (), (), {})
    judged = judging(found, evidence)
    first, _ = without_denied(found, judged, lambda other: judging(other, evidence))
    assert first.fit.effects == () and list(first.denied) == ["viscous_warmup", "torque_ripple"]
    kept, _ = settled_names(found, judged, lambda other: judging(other, evidence), lambda text: None)
    values = {effect.name: effect.values for effect in kept.fit.effects}
    assert values.keys() == {"friction_deviation", "torque_ripple"}
    # three deviations of an amplitude beside white noise in half of the rows, which the band leaves
    assert values["torque_ripple"]["amplitude"] == pytest.approx(2e-3, abs=3 * NOISE / math.sqrt(3000))
    assert "viscous_warmup" in kept.denied and "torque_ripple" not in kept.denied


def test_channel_made_worse_is_given_back(rigid: Plant) -> None:
    """A value that no fit has moved, and that is wrong: worse than declared, and gone."""
    found, judged = kept_of(rigid, Truth(), Payload.of(mass=15.0), iterations=0)
    assert found.fit.effects == () and "payload" in found.denied
    assert worse_by(found.problem, judged, "motor_torque") < 0


@pytest.mark.parametrize(
    ("spared", "left"), [((), []), (("torque_ripple",), ["torque_ripple"])], ids=["asked", "spared"]
)
def test_gain_denies_no_name_in_the_place_of_one_that_says_the_same(
    rigid: Plant, monkeypatch: pytest.MonkeyPatch, spared: tuple[str, ...], left: list[str]
) -> None:
    monkeypatch.setattr(veto, "_no_gain", lambda found, place, share: "too little")
    monkeypatch.setattr(veto, "judged_changes", lambda found, judged: None)
    runs = [rigid_run("a", Truth(ripple=0.01))], [rigid_run("b", Truth(ripple=0.01, seed=2))]
    problem, evidence, _ = prepared(rigid, *runs, 0.75)
    found = Search(problem, fit(problem, [RIPPLE]), (), (), {})
    kept, _ = without_denied(found, judging(found, evidence), lambda other: judging(other, evidence), spared)
    assert [effect.name for effect in kept.fit.effects] == left


def test_sparing_asks_for_the_interval_still(rigid: Plant) -> None:
    problem, evidence, _ = prepared(rigid, [rigid_run("a", Truth(seed=5))], [rigid_run("b", Truth(), slow=1.3)], 0.75)
    found = Search(problem, fit(problem, [Payload.of(mass=0.05)]), (), (), {})
    kept, _ = without_denied(found, judging(found, evidence), lambda other: judging(other, evidence), ("payload",))
    assert kept.fit.effects == () and "interval" in kept.denied["payload"]


@pytest.mark.parametrize(("other", "gone"), [(0.006, "stribeck"), (0.05, "torque_ripple")], ids=["less", "more"])
def test_of_two_that_hide_each_other_that_goes_which_is_missed_less(
    rigid: Plant, monkeypatch: pytest.MonkeyPatch, other: float, gone: str
) -> None:
    """Beside a Stribeck drop a ripple is said to have an interval that holds none; each goes where it brings less."""
    truth = Truth(ripple=0.03)
    problem, evidence, _ = prepared(rigid, [rigid_run("a", truth)], [rigid_run("b", truth, slow=1.3)], 0.75)
    found = Search(problem, fit(problem, [RIPPLE, Stribeck.of(delta_force=0.2, velocity=0.02)]), (), (), {})
    judged = judging(found, evidence)
    gains = [0.03, other]

    def around_none(problem: Problem, fitted: Fit) -> list[str]:
        both = len(fitted.effects) == 2
        return [veto.AROUND_NONE if both and one.name == "torque_ripple" else "" for one in fitted.effects]

    def share(found: Search, judged: Sequence[Judged], place: int) -> Share:
        comparison = Comparison(gains[place], 1e-3, 0.0)
        return Share({"motor_torque": gains[place]}, comparison, 10.0, comparison)

    monkeypatch.setattr(veto, "sizes_around_none", around_none)
    monkeypatch.setattr(veto, "_share", share)
    denied = veto._first_denied(found, judged, ())
    assert denied is not None and found.fit.effects[denied.place].name == gone


def test_judged_data_tell_two_apart_only_beyond_their_scatter(rigid: Plant) -> None:
    """A mass is told to some 20 g here (its interval without any): 5 kg off shows, 1 g does not."""
    problem, evidence, _ = prepared(
        rigid, [rigid_run("a", Truth(mass=3.0))], [rigid_run("b", Truth(mass=3.0, seed=2))], 0.75
    )

    def at(mass: float) -> list[Judged]:
        return judging(Search(problem, fit(problem, [Payload.of(mass=mass)], iterations=0), (), (), {}), evidence)

    assert judged_apart(problem, at(3.0), at(8.0))
    assert not judged_apart(problem, at(3.0), at(3.001))
    assert not judged_apart(problem, at(8.0), at(3.0))  # better than what was taken


def one_stroke(name: str, seed: int) -> Recording:
    """Rest, one stroke of 100 mm in a second, and rest again: the mass shows in two blocks of twenty."""
    time = np.arange(round(11.0 / STEP)) * STEP
    s = np.clip(time + 0.5 * STEP - 5.0, 0.0, 1.0)  # the torque of a row is that at the middle of its hold
    speed, acceleration = 0.1 * (30 * s**2 - 60 * s**3 + 30 * s**4), 0.1 * (60 * s - 180 * s**2 + 120 * s**3)
    r = LEAD / (2 * math.pi)
    torque = r * (MASS * acceleration + COULOMB * np.tanh(speed / SMOOTH) + VISCOUS * speed)
    torque += NOISE * np.random.default_rng(seed).standard_normal(len(time))
    s = np.clip(time - 5.0, 0.0, 1.0)
    return Recording(
        name, time, {"motor_torque": torque, "motor_angle": 0.1 * s**3 * (10 - 15 * s + 6 * s**2) / r}, STEP
    )


def test_what_is_worse_in_one_brief_stroke_is_worse(rigid: Plant) -> None:
    """Few blocks hold all that the two plants differ by: how that is spread over blocks is no chance."""
    problem, evidence, _ = prepared(rigid, [one_stroke("a", 1)], [one_stroke("b", 2)], 0.75)
    wrong = Search(problem, fit(problem, [Payload.of(mass=15.0)], iterations=0), (), (), {})
    assert worse_by(problem, judging(wrong, evidence), "motor_torque") > 0.5
    right = Search(problem, fit(problem, [Payload.of(mass=0.02)], iterations=0), (), (), {})
    assert worse_by(problem, judging(right, evidence), "motor_torque") < 0


def test_value_at_the_end_of_what_is_physical_is_no_estimate(rigid: Plant) -> None:
    problem, _, _ = prepared(rigid, [rigid_run("a", Truth())], [], 0.75)
    fitted = fit(problem, [Payload.of(mass=-0.95 * 60.0)], iterations=0)
    assert "end of what is physical" in ends_reached(problem, fitted)[0]
    assert ends_reached(problem, fit(problem, [Payload.of(mass=3.0)], iterations=0)) == [""]
    lead = find_effect("lead_error_periodic").of(amplitude=9e-4, order=1.0, phase=0.3)
    far = write_coordinates([lead], rigid, read_coordinates([lead], rigid) * 5.0)
    assert far[0].values["amplitude"] == 1e-3 and ends_reached(problem, fit(problem, far, iterations=0))[0]
    both = fit(problem, [Payload.of(mass=-40.0), Payload.of(mass=-30.0)], iterations=0)  # together less than nothing
    assert all(ends_reached(problem, both))
    # friction that has warmed up before it is seen is a level of friction
    warm = find_effect("viscous_warmup")
    there = [fit(problem, [warm.of(Port.TABLE, share=0.1, time_constant=tau)], iterations=0) for tau in (0.1, 5.0)]
    assert [bool(*ends_reached(problem, one)) for one in there] == [True, False]


def test_a_friction_at_an_end_of_its_range_is_not_searched(rigid: Plant) -> None:
    problem, _, _ = prepared(rigid, [rigid_run("a", Truth())], [], 0.75)
    bristle, most = find_effect("presliding"), find_effect("presliding").parameter("stiffness").maximum
    stiff = bristle.of(stiffness=most, damping=0.0, break_away=0.0)
    with pytest.raises(InputError, match="end of what is physical"):
        refuse_at_an_end(problem, [stiff])
    refuse_at_an_end(problem, [bristle.of(stiffness=1e7, damping=0.0, break_away=0.0)])  # ends of none are values
    refuse_at_an_end(problem, [Payload.of(mass=-0.95 * 60.0)])  # no friction: judging says so
    warm = find_effect("viscous_warmup").of(Port.TABLE, share=1.0, time_constant=2.0)
    with pytest.raises(InputError, match="end of what is physical"):
        refuse_at_an_end(problem, [warm])
    refuse_at_an_end(calibrated(problem), [warm])  # the drag may be more than declared, and more of it is lost then


@pytest.mark.parametrize("half_width", [1e-3, 5e-3])
def test_a_place_that_judged_data_do_not_visit_is_not_denied_by_them(rigid: Plant, half_width: float) -> None:
    """Nothing of it is there, or its tail: neither is a word against it."""
    problem, evidence, _ = prepared(rigid, [rigid_run("a", Truth())], [one_stroke("b", 2)], 0.75)
    tight = find_effect("friction_vs_position").of(peak=5.0, centre=-0.05, half_width=half_width)
    found = Search(problem, fit(problem, [tight], iterations=0), (), (), {})
    share = share_of(problem, judging(found, evidence), found.fit.effects, 0)
    assert share.size < UNSEEN and not share.shows and not share.carries


def test_fit_of_a_torque_of_the_other_sign_leaves_a_mass(rigid: Plant) -> None:
    """Before: a moving mass of less than nothing."""
    problem, _, _ = prepared(rigid, [rigid_run("a", Truth(mass=-115.0))], [], 0.75)
    (payload,) = fit(problem, [Payload.of(mass=0.0)]).effects
    assert payload.values["mass"] == pytest.approx(-0.95 * 60.0)


def test_diagnosis_lists_what_was_denied_as_refused(rigid: Plant, tmp_path: Path) -> None:
    result, _ = diagnose(rigid, [rigid_run("a", Truth(ripple=0.01))], [rigid_run("b", Truth(ripple=0.01), slow=1.3)])
    assert [effect.name for effect in result.effects] == ["torque_ripple"]
    assert all(effect.carries for effect in result.effects)


def held_all_row(problem: Problem) -> Problem:
    """The problem of a drive that does nothing between two rows, where the values are pulled farther."""
    return replace(problem, evidence=tuple(replace(e, between_rows=()) for e in problem.evidence))


def test_torque_is_not_given_up_for_a_lead_map_that_no_name_explains(tmp_path: Path) -> None:
    """4 µm against 20 nm of noise pull friction and stiffness, until the torque is worse than as declared."""
    (tmp_path / "plant.toml").write_text(machine.PLANT, encoding="utf-8")
    plant = read_plant(tmp_path / "plant.toml")
    one, other = (machine.recording(machine.State(seed=seed, start=1.3 * seed), name=f"{seed}") for seed in range(2))
    problem, evidence, _ = prepared(plant, [one], [other], 0.75)
    problem = calibrated(held_all_row(problem))
    found = Search(problem, fit(problem, ()), (), (), {})

    def judge(search: Search) -> list[Judged]:
        settled = search.problem.settled(search.fit.effects)
        after = settled.machine(search.fit.effects)
        return [prepared_for_judging(settled, one, plant, after) for one in evidence]

    judged = judge(found)
    assert worse_by(problem, judged, "motor_torque") > 0
    kept, again = not_worse_than_declared(found, judged, judge)
    assert all(worse_by(kept.problem, again, name) < 0 for name in ("motor_torque", "table_position"))
    # weighed by what is left of each channel, not given up: fitted values are nearer than the declared ones
    assert kept.problem.calibration is not None and kept.problem.calibration.values
    assert not_worse_than_declared(kept, again, judge)[0] is kept


def test_values_that_stand_alone_may_not_make_all_worse(rigid: Plant, monkeypatch: pytest.MonkeyPatch) -> None:
    """An encoder's steps scatter so much between blocks that a tenth more error was none: nothing else made it."""
    runs = [rigid_run("a", Truth())], [rigid_run("b", Truth(seed=2), slow=1.3)]
    problem, evidence, _ = prepared(rigid, *runs, 0.75)
    problem = calibrated(problem)
    alone = Search(problem, fit(problem, ()), (), (), {})
    monkeypatch.setattr(worse, "worst_channel", lambda problem, judged: "")

    def judged_with(mass: float) -> list[Judged]:
        return judging(Search(problem, fit(problem, [Payload.of(mass=mass)], iterations=0), (), (), {}), evidence)

    heavy, right = judged_with(3.0), judged_with(1e-3)
    kept, again = not_worse_than_declared(alone, heavy, lambda other: judging(other, evidence))
    assert kept is not alone and again is not heavy
    assert not_worse_than_declared(alone, right, lambda other: heavy)[0] is alone
    named = Search(problem, fit(problem, [Payload.of(mass=3.0)], iterations=0), (), (), {})
    assert not_worse_than_declared(named, heavy, lambda other: right)[0] is named


def test_no_name_goes_for_what_fitted_values_do(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A lead map pulls the declared values, the torque is worse than as declared: its slope has no part in that."""
    (tmp_path / "plant.toml").write_text(machine.PLANT, encoding="utf-8")
    plant = read_plant(tmp_path / "plant.toml")
    one, other = (machine.recording(machine.State(seed=seed, start=1.3 * seed), name=f"{seed}") for seed in range(2))
    problem, evidence, _ = prepared(plant, [one], [other], 0.75)
    problem = calibrated(held_all_row(problem))
    slope = find_effect("lead_error_cumulative").of(slope=-1.5e-5)  # of a quarter wave of 4 µm over 0.35 m and back
    found = Search(problem, fit(problem, [slope]), (), (), {})

    def judge(search: Search) -> list[Judged]:
        settled = search.problem.settled(search.fit.effects)
        after = settled.machine(search.fit.effects)
        return [prepared_for_judging(settled, one, plant, after) for one in evidence]

    judged = judge(found)
    assert worse_by(problem, judged, "motor_torque") > 0
    kept, again = without_denied(found, judged, judge)
    assert worse_by(kept.problem, again, "motor_torque") < 0
    assert [effect.name for effect in kept.fit.effects] == ["lead_error_cumulative"]
    monkeypatch.setattr(veto, "not_worse_than_declared", lambda found, judged, judge: (found, judged))
    gone, _ = without_denied(found, judged, judge)
    assert gone.fit.effects == () and "motor_torque" in gone.denied["lead_error_cumulative"]


def test_an_interval_does_not_deny_what_judged_data_are_clear_about(
    rigid: Plant, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Slopes said that a stiffness of bristles without end lies within its interval; they took 63 % of the error."""
    monkeypatch.setattr(veto, "sizes_around_none", lambda problem, fitted: [AROUND_NONE] * len(fitted.effects))
    found, _ = kept_of(rigid, Truth(ripple=0.01), RIPPLE)  # whose slopes are the law itself
    assert found.fit.effects == ()
    monkeypatch.setattr(veto, "is_told_by_slopes", lambda problem, fitted, place: False)
    found, _ = kept_of(rigid, Truth(ripple=0.01), RIPPLE)
    assert [one.name for one in found.fit.effects] == ["torque_ripple"]
    found, _ = kept_of(rigid, Truth(), RIPPLE)  # which is not there
    assert found.fit.effects == ()


def test_slopes_tell_a_sine_and_no_bristle_without_end(rigid: Plant) -> None:
    problem, _, _ = prepared(rigid, [rigid_run("a", Truth(ripple=0.01))], [rigid_run("b", Truth())], 0.75)
    assert is_told_by_slopes(problem, fit(problem, (RIPPLE,)), 0)
    bristle = Presliding.of(stiffness=3e6, damping=0.0, break_away=0.0)
    assert not is_told_by_slopes(problem, fit(problem, (bristle,), iterations=0), 0)


@pytest.mark.parametrize(("gain", "stands"), [(0.35, True), (0.005, False)])
def test_one_block_left_out_does_not_make_the_scatter_of_all(
    rigid: Plant, monkeypatch: pytest.MonkeyPatch, gain: float, stands: bool
) -> None:
    """A spring over 27 mm was missed by 60 times its noise in the one block that alone goes to an end of that."""
    found, judged = kept_of(rigid, Truth(ripple=0.01), RIPPLE)
    of_all, levelled = Comparison(gain, 0.88, 0.01), Comparison(0.9, 0.03, 0.01)
    missed = SimpleNamespace(gain=of_all, levelled_gain=levelled)
    monkeypatch.setattr(veto, "missed_by", lambda one, other: missed)
    reason = veto._no_gain(found, 0, unseen(judged))
    assert (reason == "") is stands


@pytest.mark.slow
def test_a_spring_seen_over_a_few_millimetres_stands(tmp_path: Path) -> None:
    """The judged recording has none of these places; nothing was named, with 47 and 72 times the floor left."""
    plant, recording, judged = case(703073).write(tmp_path)
    result, _ = diagnose(read_plant(plant), [read_recording(recording)], [read_recording(judged)])
    assert sorted(one.name for one in result.effects) == ["backlash", "position_spring"]


@pytest.mark.slow
def test_bristles_known_to_a_factor_of_three_are_named(tmp_path: Path) -> None:
    """A curve of Dahl with the exponent two, rows of 4 ms: four times the floor of the torque was left."""
    plant, recording, judged = case(10069).write(tmp_path)
    result, _ = diagnose(read_plant(plant), [read_recording(recording)], [read_recording(judged)])
    assert [one.name for one in result.effects] == ["presliding"]
