"""What changed between recordings: parameters that must differ by recording for the blocks left out to be met.

The reference has every fitted parameter and every level in common. One parameter after the other is set free in the
recordings asked about: ranked by one linear step (`change_candidates`), fitted, and taken if it pays by the rule of the
search, more strictly by the number that was tried. Levels that did not differ are then taken out, and what no longer
pays or is too small to matter is put back.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

from feeddrive.diagnosis.calibration.stated import said_by_effects
from feeddrive.diagnosis.finding.attempt import SCANNED_ITERATIONS, with_predictable
from feeddrive.diagnosis.likelihood.coordinates import read_coordinates
from feeddrive.diagnosis.likelihood.cross_validation import Comparison
from feeddrive.diagnosis.likelihood.fit import Fit, error_of, fit
from feeddrive.diagnosis.likelihood.problem import UNEXPLAINED, Problem
from feeddrive.diagnosis.likelihood.standing import Standing, gain_between
from feeddrive.diagnosis.motion.predictability import has_play
from feeddrive.diagnosis.recordings.change_candidates import (
    Movable,
    Offer,
    levels,
    material_difference,
    movables,
    offers,
)
from feeddrive.diagnosis.recordings.change_result import CommonTrial
from feeddrive.diagnosis.recordings.recordings import (
    RecordingPredictor,
    RecordingShift,
    Target,
    is_shift,
    without_shifts,
)
from feeddrive.effects.base import Effect
from feeddrive.effects.base import number as number_of
from feeddrive.effects.friction.friction_deviation import FrictionDeviation
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.units.quantity import percent

REFERENCE_STEPS, JOINT_STEPS = 8, 10
"""Steps of the fit with everything in common, and of the fit with what differs."""

FALSE_ALARMS = 0.05
"""Chance of one false change in a whole diagnosis, shared out among all parameters that are tried."""

OFFERS = 2
"""Parameters that are fitted before the recordings are taken to share the rest."""

LAGS = (2.0, 1.4, 0.7, 3.0)
"""Differences of a free play that are tried, over the rms of what the table lags: half of one, either way, at rest."""

NO_PLAY = Backlash.of(width=0.0)
"""What a machine without free play has, that may have worn since."""

MOST_CHANGES = 6
"""Parameters that may differ; a machine on which more did is another machine."""


@dataclass(frozen=True)
class Changes:
    """The fit with what differs by recording.

    Attributes:
        problem: of the fit; a declared value that differs is stated by an effect and no more fitted beside it.
        fit: effects of the machine, then the shifts of what differs.
        targets: what differs, in the order found.
        trials: all that was tried, the most promising first.
    """

    problem: Problem
    fit: Fit
    targets: tuple[Target, ...]
    trials: tuple[CommonTrial, ...]


def find_changes(problem: Problem, effects: Sequence[Effect], recordings: Sequence[int]) -> Changes:
    """Find the parameters that differ in some recordings.

    Args:
        problem: recordings, with a predictor that knows their numbers.
        effects: found, with the shifts that are known already.
        recordings: numbers of those that may differ; the others share their values.

    Returns:
        The fit of the effects as they are given, followed by levels and shifts that pay.
    """
    common = fit(problem, effects, iterations=REFERENCE_STEPS)
    if not recordings:
        return Changes(problem, common, (), ())
    ranked: dict[Target, Offer] = {}
    wide, current, kept = _forward(problem, effects, common, recordings, ranked)
    while kept:
        worst = _worst(wide, current, kept, recordings, len(ranked))
        if not worst:
            shifts = [effect for effect in current.effects if is_shift(effect)]
            ordered = fit(wide, [*without_shifts(current.effects), *shifts], iterations=REFERENCE_STEPS)
            return Changes(wide, ordered, tuple(kept), _trials(ranked, kept))
        kept = [target for target in kept if target not in worst]
        wide, current = _in_common(problem, common, current, worst, recordings)
    return Changes(problem, common, (), _trials(ranked, ()))


def _forward(
    problem: Problem, given: Sequence[Effect], common: Fit, recordings: Sequence[int], ranked: dict[Target, Offer]
) -> tuple[Problem, Fit, list[Target]]:
    """Parameters that pay when set free, the likeliest first; what each brings is noted in `ranked`."""
    taken: list[Target] = []
    current = common
    having = given if has_play(given) or not _may_have_play(problem, common, recordings) else [*given, NO_PLAY]
    for one in movables(having, problem):
        apart = _play_apart(problem, having, one, recordings) if has_play([having[one.effect]]) else None
        if apart is None:
            continue
        comparison = gain_between(Standing(problem, common), apart, in_folds=False)
        ranked[one.target] = one, comparison
        if _pays(comparison, len(common.coordinates)) and _material(apart.problem, apart.fit, one.target, recordings):
            taken.append(one.target)
            problem, current = apart.problem, apart.fit
    if taken and current.squared_error < UNEXPLAINED * len(current.residual):
        return problem, current, taken
    while len(taken) < MOST_CHANGES:
        effects = [*current.effects, *levels(problem, current.effects)]
        asked, together = said_by_effects(problem, effects)
        at_rest = fit(asked, together, iterations=0)
        free = [one for one in movables(effects, asked) if one.target not in taken]
        offered = offers(asked, at_rest, free, recordings)
        for one, comparison in offered:
            if one.target not in ranked or comparison.gain > ranked[one.target][1].gain:
                ranked[one.target] = one, comparison
        # the scatter of one linear step of a law that jumps, as play does, says little; the fit is judged by it
        likely = [one for one, c in offered if c.gain > c.least]
        for one in likely[:OFFERS]:
            group = [other for other in free if other is one or _partners(one.target, other.target)]
            own, wider, comparison = _set_free(problem, current, effects[one.effect], group, recordings)
            ranked[one.target] = one, comparison
            if _pays(comparison, len(free) + len(taken)) and _material(own, wider, one.target, recordings):
                taken += [other.target for other in group]
                problem, current = own, wider
                break
        else:
            break
    return problem, current, taken


def _may_have_play(problem: Problem, common: Fit, recordings: Sequence[int]) -> bool:
    """Whether so much is left of the table position in some recordings, beside the others, as a free play leaves."""
    if not problem.predictor.of_motion or not problem.plant.chain.elastic:
        return False
    predictor, plant = problem.predictor, problem.machine(common.effects)
    assert isinstance(predictor, RecordingPredictor)
    left: dict[bool, list[float]] = {True: [], False: []}
    for e in problem.evidence:
        if "table_position" not in e.channels:
            return False
        error = e.measured["table_position"] - predictor.predict(plant, e)["table_position"]
        square = float(np.var(error[e.fit_rows])) / e.known_to("table_position") ** 2
        left[predictor.numbers[e.recording] in recordings].append(square)
    return max(left[True]) > UNEXPLAINED * max(1.0, *left[False])


def _play_apart(problem: Problem, given: Sequence[Effect], one: Movable, recordings: Sequence[int]) -> Standing | None:
    """The set with a free play of its own in some recordings; None where no other play suits them better.

    A screw that is worn is no step away from a new one: a play that is far too small leaves the table's lag to every
    other effect, so that a fit in common is neither machine, and linear steps from there lead to neither. So widths are
    tried about that lag, as the search does it, the other effects being as they were found.
    """
    effect, predictor, plant = given[one.effect], problem.predictor, problem.machine(given)
    assert isinstance(predictor, RecordingPredictor)
    lag = dict.fromkeys(recordings, 0.0)
    for e in problem.evidence:
        if (number := predictor.numbers[e.recording]) in lag and "table_position" in e.channels:
            error = e.measured["table_position"] - predictor.predict(plant, e)["table_position"]
            lag[number] = float(np.std(error[e.fit_rows]))
    if not any(lag.values()):
        return None

    def moved(times: float) -> list[Effect]:
        shifts = []
        for number, shift in zip(recordings, one.shifts(recordings), strict=True):
            width = max(0.0, number_of(effect.values["width"]) + times * lag[number])
            other = effect.with_values(width=min(width, effect.parameter("width").maximum))
            by = read_coordinates([other], problem.plant) - read_coordinates([effect], problem.plant)
            shifts.append(shift.with_values(shift=tuple(by.tolist())))
        return [*given, *shifts]

    own = with_predictable(problem, moved(LAGS[0]))
    starts = [moved(times) for times in (0.0, *LAGS, *(-times for times in LAGS))]
    start = min(starts, key=lambda effects: error_of(own, effects))
    if start is starts[0]:
        return None
    own = with_predictable(problem, start)
    free = [False] * len(given) + [True] * len(recordings)
    tried = fit(own, start, free, SCANNED_ITERATIONS)
    own = with_predictable(problem, tried.effects)
    return Standing(own, fit(own, tried.effects, iterations=JOINT_STEPS))


def _partners(one: Target, other: Target) -> bool:
    """Whether two are the parts of one friction: each is known only with the other free, so they are freed together."""
    return one.name == FrictionDeviation.name and (one.name, one.port) == (other.name, other.port)


def _material(problem: Problem, shifted: Fit, target: Target, recordings: Sequence[int]) -> bool:
    return any(material_difference(problem, shifted.effects, target, number) for number in recordings)


def _pays(comparison: Comparison, tried: int) -> bool:
    """The rule of the search, its scatter as many times as so many tries ask for."""
    times = float(ndtri(1 - FALSE_ALARMS / max(tried, 1)))
    return comparison.pays and comparison.gain > times * comparison.standard_error


def _worst(
    problem: Problem, shifted: Fit, kept: Sequence[Target], recordings: Sequence[int], tried: int
) -> list[Target]:
    """What is immaterial, or pays least and not enough; nothing where all are to stay."""
    for target in kept:
        if not _material(problem, shifted, target, recordings):
            return [target]
    groups = [[other for other in kept if other is one or _partners(one, other)] for one in kept]
    if all(len(group) == len(kept) for group in groups):
        return []  # they were compared when they were taken
    compared = []
    for group in groups:
        # what is left out keeps its level in common, so that only the difference is judged
        removed = [effect for effect in shifted.effects if not _belongs(effect, group, recordings)]
        own = _as_predicted(problem, removed, group)
        without = Standing(own, fit(own, removed, iterations=JOINT_STEPS))
        in_folds = own is problem  # else a free play leaves too few blocks
        compared.append((gain_between(without, Standing(problem, shifted), in_folds), group))
    comparison, group = min(compared, key=lambda pair: pair[0].gain)
    return [] if _pays(comparison, tried) else group


def _trials(ranked: dict[Target, Offer], kept: Sequence[Target]) -> tuple[CommonTrial, ...]:
    result = []
    for target, (one, comparison) in sorted(ranked.items(), key=lambda item: -item[1][1].gain):
        taken, gain, error = target in kept, comparison.gain, comparison.standard_error
        lowers = f"a value of its own lowers the squared error by {percent(gain, 2)}"
        reason = f"{lowers} ({percent(error, 2)} scatter), or others say it better"
        if taken:
            reason = "it must differ for blocks left out to be met"
        elif gain <= 0:
            reason = "a value of its own in every recording does not lower the error on blocks left out"
        result.append(CommonTrial(target.name, one.parameter, str(target.port), gain, error, taken, reason))
    return tuple(result)


def _belongs(effect: Effect, targets: Sequence[Target], recordings: Sequence[int]) -> bool:
    """Whether this is the shift of one of the targets in one of the recordings."""
    return isinstance(effect, RecordingShift) and effect.target in targets and effect.recording in recordings


def _set_free(
    problem: Problem, current: Fit, effect: Effect, group: Sequence[Movable], recordings: Sequence[int]
) -> tuple[Problem, Fit, Comparison]:
    """The fit with parameters of one effect free by recording, beside the one that has them in common.

    `group` are parameters of the effect, or of a level at which nothing is other than declared. Gives the problem in
    which no declared value is fitted that the effect stands for, the fit, and what it brings.
    """
    shared = current
    if effect not in current.effects:
        problem, effects = said_by_effects(problem, [*current.effects, effect])
        shared = fit(problem, effects, iterations=JOINT_STEPS)
    shifts = [shift for one in group for shift in one.shifts(recordings)]
    wider = fit(problem, [*shared.effects, *shifts], iterations=JOINT_STEPS)
    return problem, wider, gain_between(Standing(problem, shared), Standing(problem, wider))


def _in_common(
    problem: Problem, common: Fit, current: Fit, targets: Sequence[Target], recordings: Sequence[int]
) -> tuple[Problem, Fit]:
    """The fit with some parameters in common again; a level that was not there before goes with its shifts.

    `problem` is that in which no level was free, `common` its fit, `current` the fit with what differs.
    """
    kept = [effect for effect in current.effects if not _belongs(effect, targets, recordings)]
    moved = [effect.target for effect in kept if isinstance(effect, RecordingShift)]
    before = without_shifts(common.effects)
    places = {(one.name, one.port, one.place) for one in before} | {(t.name, t.port, t.place) for t in moved}
    kept = [effect for effect in kept if is_shift(effect) or (effect.name, effect.port, effect.place) in places]
    problem, _ = said_by_effects(problem, kept)
    problem = _as_predicted(problem, kept, [one.target for one in kept if isinstance(one, RecordingShift)])
    return problem, fit(problem, kept, iterations=JOINT_STEPS)


def _as_predicted(problem: Problem, effects: Sequence[Effect], targets: Sequence[Target]) -> Problem:
    """The problem on the samples that a set predicts in which a free play differs by recording, or no longer does."""
    plays = [effect for effect in effects if has_play([effect])]
    return with_predictable(problem, effects) if any(t.meets(e) for t in targets for e in plays) else problem
