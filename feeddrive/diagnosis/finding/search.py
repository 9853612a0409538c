"""The search: from set to set of effects by their evidence, until no set near the last one is likelier.

Every round starts each candidate from values read off the residual of the set at hand, and fits those that promise a
fair part of the best. Sets near the one at hand are compared on these slopes (`sets`); the likeliest few are fitted,
all effects together, and the likeliest of them is taken if what it adds also lowers the error on blocks left out.
"""

from __future__ import annotations

from collections.abc import Callable, Container
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from feeddrive.diagnosis.calibration.calibrate import calibrated, moved
from feeddrive.diagnosis.calibration.stated import without_effects
from feeddrive.diagnosis.calibration.value_slopes import ENOUGH
from feeddrive.diagnosis.certainty.one_sided import with_usual_sizes
from feeddrive.diagnosis.finding.attempt import Attempt
from feeddrive.diagnosis.finding.elsewhere import at_likelier_place
from feeddrive.diagnosis.finding.end_of_search import ended
from feeddrive.diagnosis.finding.likelier import FITTED, Near, Taken, likelier, of_likelier_law, with_play
from feeddrive.diagnosis.finding.members import Member, members_of, rest_of
from feeddrive.diagnosis.finding.refitting import (
    at_rest,
    balanced,
    begun_as_declared,
    in_steps_told,
    refitted,
    with_scale_beyond,
    with_softer_spring,
    with_value_back,
    with_value_beyond,
    with_value_from_declared,
)
from feeddrive.diagnosis.finding.round import Round, one_round
from feeddrive.diagnosis.finding.scene import scene_of
from feeddrive.diagnosis.finding.short_step import with_values_moved
from feeddrive.diagnosis.finding.too_small import too_small
from feeddrive.diagnosis.finding.two_at_once import two_at_once
from feeddrive.diagnosis.forms.along_the_stroke import with_declared_stiffness, with_parabola_from_line
from feeddrive.diagnosis.forms.bristle_form import of_likelier_bristle
from feeddrive.diagnosis.forms.curve_in_place import (
    curve_of_value,
    of_no_name,
    with_its_curves,
    with_level_in_curve,
)
from feeddrive.diagnosis.forms.flank import with_curve_for_flank
from feeddrive.diagnosis.forms.load_power import with_power_of_load
from feeddrive.diagnosis.forms.open_map import open_curves, with_curves_of
from feeddrive.diagnosis.forms.simpler_law import (
    as_force,
    as_payload,
    less_than_a_period,
    level_everywhere,
    without_resonance,
)
from feeddrive.diagnosis.forms.spring_law import soft_everywhere
from feeddrive.diagnosis.heat.heat_candidates import is_another
from feeddrive.diagnosis.judging.result import Trial
from feeddrive.diagnosis.likelihood.cross_validation import Comparison
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import UNEXPLAINED, Problem
from feeddrive.diagnosis.likelihood.standing import Standing, gain_between, odds_between
from feeddrive.effects.chain.stiffness_deviation import StiffnessDeviation
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.effects.transmission.stiffness_vs_position import StiffnessVsPosition

MOST_ROUNDS = 12
"""Sets gone through at most; an axis that lacks more needs another declaration."""

SMALL = "the recordings show it, and it is too small to matter on this machine"
"""Why an effect is not reported that the search met beside the others."""


ANOTHER = "its values have run to where it is another effect"
"""Why an effect is not searched further."""


@dataclass(frozen=True)
class Search:
    """What the search found, and everything that it tried.

    Attributes:
        problem: recordings with the samples that the effects found can predict.
        fit: of the effects found.
        trials: every candidate of every round.
        rounds: the same as fitted, the best first.
        impossible: candidate to why the recordings cannot show it beside what was found.
        near: effects that may come beside those found, the likeliest first.
        begun: problem and fit that the search began with; None for one that is made of a fit.
        tried: most candidates and starts that a round tried; 0 where there was none.
        opened: problem and fit with the curves of its laws open; None where none is.
        asked: what was asked of the judged recordings beside it and beside sets made of it (`recordings.compared`).
        denied: names that were met and are not reported, to why; a search that goes on from this one asks for none.
        weighed: fits, of it and of sets made of it, whose members were weighed with values at rest, and the members.
        whole: whether no set near the last one was likelier, or had been met; else rounds or time were at their end.
    """

    problem: Problem
    fit: Fit
    trials: tuple[Trial, ...]
    rounds: tuple[tuple[Attempt, ...], ...]
    impossible: dict[str, str]
    near: tuple[Near, ...] = ()
    begun: tuple[Problem, Fit] | None = None
    tried: int = 0
    opened: tuple[Problem, Fit] | None = None
    asked: list[Any] = field(default_factory=list, compare=False)
    denied: dict[str, str] = field(default_factory=dict)
    weighed: list[tuple[Fit, Any]] = field(default_factory=list, compare=False)
    whole: bool = True

    @property
    def reasons(self) -> dict[str, str]:
        """Candidate to why it is not reported, where the recordings cannot show it or it was met and denied."""
        return {**self.impossible, **self.denied}

    @property
    def count(self) -> int:
        """Candidates and starts that were tried, K of the prior of sets."""
        return max(self.tried, len(self.problem.predictor.candidates))


class _Asked(NamedTuple):
    """A round beside a set, the likeliest set near it, None where none is likelier, and what comes near beside it."""

    now: Round
    taken: Taken | None
    near: tuple[Near, ...]


def search(
    problem: Problem,
    progress: Callable[[str], None] = lambda text: None,
    start: Search | None = None,
    most_rounds: int = MOST_ROUNDS,
    further: int = 1,
) -> Search:
    """Find the effects that the declared plant lacks.

    A search of heat that ends where much is left is made again with more sets two moves away, and the likelier end is
    taken: a mass at the nut begins a quarter as strong as it is while a coolant that sets in later is missing.

    Args:
        problem: declared plant and recordings.
        progress: called with a line that says what is going on.
        start: a search to go on from, without the names that it denies.
        most_rounds: after which it ends with what it has.
        further: sets two moves away that are fitted in a round.

    Returns:
        The effects found, fitted together, and the ledger of the search.
    """
    progress("fitting declared values within their tolerances")
    problem = given = calibrated(problem)
    found = fit(problem, start.fit.effects if start is not None else ())
    begun = (problem, found) if start is None or start.begun is None else start.begun
    trials: list[Trial] = [*start.trials] if start is not None else []
    rounds: list[tuple[Attempt, ...]] = [*start.rounds] if start is not None else []
    denied = {**start.denied} if start is not None else {}
    impossible: dict[str, str] = {}
    met: set[tuple[Member, ...]] = set()
    rested: set[tuple[Member, ...]] = set()
    forms: set[tuple[tuple[Member, ...], tuple[str, ...]] | None] = set()
    near: tuple[Near, ...] = ()
    tried = start.tried if start is not None else 0
    problem, found = balanced(problem, found)
    whole = True
    while len(rounds) < most_rounds and not (rounds and problem.budget.skips("further rounds of the search")):
        number = len(rounds) + 1
        progress(f"round {number}: {len(found.effects)} effects so far")
        asked = _asked(problem, found, impossible, denied, number, further)
        near, tried = asked.near, max(tried, asked.now.count)
        unnamed = of_no_name(problem, found, asked.taken, asked.now)
        form = None if unnamed is None else (members_of(unnamed[1].effects), open_curves(unnamed[0]))
        if unnamed is not None and form not in forms:
            forms.add(form)
            problem, found = with_curve_for_flank(*with_its_curves(*unnamed))
            continue
        after = _refitted_with(asked, found, denied)
        begin = begun_as_declared(problem, found)
        if begin is not None:
            other = _asked(*begin, impossible, denied, number)
            there, here = _refitted_with(other, begin[1], denied), after or (problem, found)
            if there is not None and odds_between(Standing(*here), Standing(*there), asked.now.count) > 0:
                asked, near, after = other, other.near, there
        far = None if found.effects else _likelier_value(problem, found, after, asked.now.count, denied)
        if far is not None:
            after, by = far
            trials.append(Trial(number, after[1].effects[-1].name, by.gain, by.standard_error, True))
        rounds.append(tuple(attempt.for_the_record() for attempt in asked.now.attempts))
        names = asked.taken.names if asked.taken is not None and far is None else []
        trials += [_trial(number, attempt, attempt.name in names) for attempt in rounds[-1]]
        if after is not None:
            problem, found = in_steps_told(*after)
            progress(f"found so far: {', '.join(effect.name for effect in found.effects)}")
            if members_of(found.effects) not in met:
                met.add(members_of(found.effects))
                continue
        # nothing likelier is near, or what was met: only each other's place is taken, or other values stand beside it
        others = [
            *filter(is_another, found.effects),
            *soft_everywhere(problem, found),
            *level_everywhere(problem, found),
            *less_than_a_period(problem, found),
            *without_resonance(problem, found),
        ]
        if others:  # the search goes on with the name that the law has run to
            denied |= dict.fromkeys((effect.name for effect in others), ANOTHER)
            softer = None if StiffnessDeviation.name in denied else with_softer_spring(problem, found, others)
            problem, found = softer or refitted(problem, fit(problem, rest_of(found.effects, others)))
        placed = None if others else at_likelier_place(problem, found, asked.now.count)
        if placed is not None and members_of(placed[1].effects) not in met:
            met |= {members_of(found.effects), members_of(placed[1].effects)}
            problem, found = in_steps_told(*placed)
            continue
        stood, left_out = problem, problem.budget.skips("declared values beyond their tolerances")
        if not left_out:  # on their way to rest, values pass tolerances that they stay within
            problem, found = at_rest(problem, found)
            stiff = with_declared_stiffness(Standing(problem, found), asked.now.count)
            problem, found = (problem, found) if stiff is None else (stiff.problem, stiff.fit)
            bent = with_power_of_load(Standing(problem, found), asked.now.count)
            problem, found = (problem, found) if bent is None else (bent.problem, bent.fit)
        back = None if left_out else with_value_back(problem, found)
        if back is not None:
            problem, found = back
            if members_of(found.effects) in met:  # what comes for it is none either
                break
            met.add(members_of(found.effects))
            continue
        scaled = None if left_out else with_scale_beyond(problem, found)
        if scaled is not None:  # the recorder is asked before the machine
            problem, found = scaled
            continue
        beyond = None if left_out else with_value_beyond(problem, found)
        if beyond is not None and members_of(beyond[1].effects) not in met and beyond[1].effects[-1].name not in denied:
            instead = with_level_in_curve(beyond) or curve_of_value(problem, found, beyond, asked.now.count)
            met |= {members_of(found.effects), members_of((instead or beyond)[1].effects)}
            if instead is not None:
                problem, found = instead
                continue
            problem, found, by = beyond
            trials.append(Trial(number, found.effects[-1].name, by.gain, by.standard_error, True))
        elif not others:
            if members_of(found.effects) not in rested and _hid_on_the_way(stood, problem, found):
                rested.add(members_of(found.effects))
                continue
            two = two_at_once(problem, found, asked.now, partial(_asked_beside, {**impossible}, denied, number))
            after = None if two is None else _refitted_with(asked._replace(taken=two), found, denied)
            if after is None or members_of(after[1].effects) in met:
                break
            problem, found = in_steps_told(*after)
            met.add(members_of(found.effects))
    else:
        whole = False
    opened, problem, found, small = ended(problem, found)
    denied |= dict.fromkeys((one.name for one in small), SMALL)
    found = with_usual_sizes(problem, found)
    result = Search(
        problem, found, tuple(trials), tuple(rounds), impossible, near, begun, tried, opened, denied=denied, whole=whole
    )
    if further >= FITTED or problem.predictor.of_motion or problem.plain_error(found.effects) < UNEXPLAINED:
        return result
    wider = search(given, progress, start, most_rounds, FITTED)
    is_likelier = odds_between(Standing(problem, found), Standing(wider.problem, wider.fit), tried) > 0
    return wider if is_likelier else result


def _asked(
    problem: Problem, found: Fit, impossible: dict[str, str], denied: dict[str, str], number: int, further: int = 1
) -> _Asked:  # fmt: skip
    """What may be added to a set or take its place, asked in one round; what is too small to matter is denied."""
    now = one_round(scene_of(problem, found.effects), found, impossible, denied, number)
    while True:
        taken, near = likelier(problem, found, now, denied, further)
        taken = with_values_moved(problem, found, now, taken, denied)
        small = {one.name for one in too_small(Standing(problem, found), taken)} if taken is not None else set()
        if not small:
            break
        denied |= dict.fromkeys(small, SMALL)
        now = replace(now, attempts=tuple(one for one in now.attempts if one.name not in small))
    if taken is None and Backlash.name not in denied:
        taken = with_play(problem, found, now.count)
    return _Asked(now, of_likelier_law(taken, now.count, denied), near)


def _asked_beside(
    impossible: dict[str, str], denied: dict[str, str], number: int, problem: Problem, found: Fit
) -> Taken | None:  # fmt: skip
    """The likeliest set near another one, as `_asked`."""
    return _asked(problem, found, impossible, denied, number).taken


def _likelier_value(
    problem: Problem, found: Fit, after: tuple[Problem, Fit] | None, count: int, denied: Container[str] = ()
) -> tuple[tuple[Problem, Fit], Comparison] | None:  # fmt: skip
    """A set with a declared value that is off by far, and what it brings, where that is likelier than a round's.

    Such a value draws all others along, and names are then taken for what is left beside values that are not there.
    """
    far = with_value_from_declared(problem, found)
    if (
        far is None
        or far[1].effects[-1].name in denied
        or odds_between(Standing(*(after or (problem, found))), Standing(*far), count) <= 0
    ):
        return None
    return far, gain_between(Standing(problem, found), Standing(*far))


def _hid_on_the_way(stood: Problem, there: Problem, found: Fit) -> bool:
    """Whether much is left, and declared values are at rest away from where a set was asked what is near it.

    Values fitted once beside a name still stand in for it, by slopes of where they stood, and rows count by what was
    left before it: a play of some steps of the scale does not lower the error there, and beside values at rest does.
    """
    if there.calibration is None or there.plain_error(found.effects) < UNEXPLAINED:
        return False
    return bool(np.max(np.abs(moved(stood, there)), initial=0.0) > ENOUGH)


def _refitted_with(asked: _Asked, found: Fit, denied: Container[str]) -> tuple[Problem, Fit] | None:
    """A likelier set, declared values fitted beside it; what left the set at hand takes its value and curve along."""
    taken = asked.taken
    if taken is None:
        return None
    problem = without_effects(taken.problem, found.effects, taken.fit.effects)
    there = refitted(with_curves_of(problem, taken.fit.effects), taken.fit)
    there = as_force(*there, asked.now.count) if ConstantForce.name not in denied else there
    there = of_likelier_bristle(*as_payload(*there, asked.now.count), asked.now.count)
    if StiffnessVsPosition.name in taken.names:
        line = with_parabola_from_line(Standing(*there), asked.now.count)
        there = there if line is None else (line.problem, line.fit)
    return with_curve_for_flank(*there)


def _trial(number: int, attempt: Attempt, taken: bool) -> Trial:
    return Trial(number, attempt.name, attempt.comparison.gain, attempt.comparison.standard_error, taken)
