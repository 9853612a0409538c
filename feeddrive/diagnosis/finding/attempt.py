"""One candidate in one round: started, refined, and compared by blocked cross-validation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.diagnosis.finding.scene import Candidate, Scene, scene_of
from feeddrive.diagnosis.likelihood.coordinates import (
    absent_coordinates,
    at_an_end,
    at_its_limit,
    coordinate_ends,
    read_coordinates,
    write_coordinates,
)
from feeddrive.diagnosis.likelihood.cross_validation import (
    LEAST_GAIN,
    Comparison,
    compare_left_out,
    compare_levelled,
    least_gain,
    left_out_residual,
)
from feeddrive.diagnosis.likelihood.fit import Fit, error_of, fit, linear_step
from feeddrive.diagnosis.likelihood.folds import FOLDS, block_numbers
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.predictability import has_play
from feeddrive.diagnosis.starts.residual_readings import BINS
from feeddrive.effects.base import Effect, FrictionEffect, number
from feeddrive.effects.chain.structural_mode import StructuralMode
from feeddrive.effects.friction.viscous_warmup import ViscousWarmup
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.effects.transmission.preload_loss import PreloadLoss
from feeddrive.effects.travel.thermal_growth import ThermalGrowth
from feeddrive.errors import InputError
from feeddrive.recording.long.joined import first_stretch
from feeddrive.typing import FloatArray, IntegerArray

JOINT_ITERATIONS = 4
"""Steps of a joint fit inside the search; what is left is polished at its end."""


SHORT_BLOCK = 0.05
"""Length of a block for what shows in a brief passage [s]: fifteen independent values at 150 Hz."""


FIT_ITERATIONS = 5
"""Steps of a candidate's fit at most, before the best few are fitted together with what was found before."""


PROMISE = 0.001
"""Share of the squared error that one linear step must take away for a fit to be worth its simulations."""


SCANNED_ITERATIONS = 3
"""Steps of the best start of a scanned candidate, before it is ranked."""


@dataclass(frozen=True)
class Attempt:
    """A candidate refined in one round, against the same recordings without it.

    Attributes:
        name: effect name.
        fit: of all free effects.
        comparison: against the effects found before.
        problem: recordings with the samples that this candidate can predict.
        evenly: the comparison with every block over what is left of it.
        starts: how many were tried.
        promised: squared error that one linear step of its start would take, once it is fitted; 0 before.
        matters: whether it is of a size that matters, or that a channel shows (`too_small`).
    """

    name: str
    fit: Fit
    comparison: Comparison
    problem: Problem
    evenly: Comparison
    starts: int = 1
    promised: float = 0.0
    matters: bool = True

    @property
    def pays(self) -> bool:
        """Whether it brings enough on blocks left out, as they are or each over the level of what is left of it.

        A brief passage that a law meets roughly has nearly all of the error, and nearly all of its chance.
        """
        return self.comparison.pays or (self.comparison.gain > self.comparison.least and self.evenly.pays)

    def for_the_record(self) -> Attempt:
        """The attempt without series and slopes, which its round alone needs: those of all rounds fill gigabytes."""
        none = np.zeros(0)
        slopes = np.zeros((0, self.fit.jacobian.shape[1]))
        return replace(self, fit=replace(self.fit, residual=none, jacobian=slopes))


def started(scene: Scene, candidate: Candidate) -> list[Attempt]:
    """The best start of each form of a candidate, as one linear step leaves it; what was found before stays as it is.

    Starts of scanned candidates are compared as they are, and the best takes a few steps: one linear step says nothing
    of a law that jumps.
    """
    attempts: list[Attempt] = []
    try:
        forms = candidate.forms(scene)
    except InputError:  # what the residual starts it from is not physical
        return []
    for starts in forms:
        if candidate.scanned and attempts and attempts[0].comparison.gain < LEAST_GAIN:
            break  # another form of a law that does not pay at all is not worth its simulations
        try:
            attempts.append(_best_start(scene, candidate, starts))
        except InputError:  # cannot act together with what was found, or cannot be simulated
            continue
    return attempts


def begun_beside(problem: Problem, before: Fit, name: str) -> list[list[Effect]]:
    """Sets of fitted effects and another one that begins at what these leave, one per form, the best first.

    Args:
        problem: recordings.
        before: the effects, fitted.
        name: of the candidate; where there is none, no set.
    """
    scene = scene_of(problem, before.effects)
    candidates = [one for one in problem.predictor.candidates if one.name == name]
    fits = [attempt.fit for candidate in candidates for attempt in started(scene, candidate)]
    fits.sort(key=lambda one: one.squared_error)
    return [[*before.effects, *write_coordinates(one.effects[-1:], problem.plant, one.coordinates)] for one in fits]


def _best_start(scene: Scene, candidate: Candidate, starts: Sequence[Effect]) -> Attempt:
    before = scene.found
    problem = with_predictable(scene.problem, (*before, starts[0])) if has_play(starts[:1]) else scene.problem
    problem = with_short_blocks(problem) if candidate.brief else problem
    free = [False] * len(before) + [True]
    start = starts[0]
    if len(starts) > 1:
        nothing = problem.residual(before)
        start = min(starts, key=lambda one: _left_by(nothing, problem.residual((*before, one)), candidate.scanned))
        start = start if candidate.scanned else _sized(problem, before, start, nothing)
    if candidate.scanned:
        result = fit(problem, (*before, start), free, SCANNED_ITERATIONS)
    else:
        result = _one_linear_step(fit(problem, (*before, start), free, 0))
    return replace(_usable(scene, problem, candidate.name, result), starts=len(starts))


def _left_by(nothing: FloatArray, start: FloatArray, as_it_is: bool) -> float:
    """Squared error that a start leaves: as it is, or of the size that suits best, which its own series tells."""
    if not np.all(np.isfinite(start)):
        return np.inf
    taken = nothing - start
    square = float(taken @ taken)
    if as_it_is or square == 0:
        return float(start @ start)
    return float(nothing @ nothing) - float(taken @ nothing) ** 2 / square


def _sized(problem: Problem, before: Sequence[Effect], start: Effect, nothing: FloatArray) -> Effect:
    """A start of the size that suits best, which its own series tells; as it is where that leaves no less.

    A step leads along slopes at the start: those of a velocity or a width are as large as the size that they are of,
    and at many times the true one lead away.
    """
    having = problem.residual((*before, start))
    taken = nothing - having
    square = float(taken @ taken)
    if not 0 < square < np.inf:
        return start
    (absent, _), there = absent_coordinates([start], problem.plant), read_coordinates([start], problem.plant)
    moved = np.where(np.isnan(absent), there, absent + float(taken @ nothing) / square * (there - absent))
    (other,) = write_coordinates([start], problem.plant, np.clip(moved, *coordinate_ends([start], problem.plant)))
    able = problem.possible((*before, other))
    return other if able and error_of(problem, (*before, other)) < float(having @ having) else start


def refined(scene: Scene, attempt: Attempt) -> Attempt | None:
    """The candidate fitted while what was found before stays as it is; None where it cannot be simulated."""
    free = [False] * len(scene.found) + [True]
    result = fit(attempt.problem, attempt.fit.effects, free, FIT_ITERATIONS)
    promised = error_of(attempt.problem, scene.found) - attempt.fit.squared_error
    try:
        done = _usable(scene, attempt.problem, attempt.name, result)
    except InputError:
        return None
    return replace(done, starts=attempt.starts, promised=promised)


def _usable(scene: Scene, problem: Problem, name: str, result: Fit) -> Attempt:
    if not (np.isfinite(result.squared_error) and np.all(np.isfinite(result.jacobian))):
        raise InputError(f"{name} could not be simulated", name)
    if not problem.possible(result.effects):
        raise InputError(f"{name} would have friction push the axis", name)
    refuse_at_an_end(problem, result.effects[-1:])
    refuse_of_no_hours(problem, result.effects)
    if has_play(result.effects[-1:]):
        problem = with_predictable(scene.problem, result.effects)
    return compared(problem, name, result, scene.found)


def refuse_at_an_end(problem: Problem, effects: Sequence[Effect]) -> None:
    """Refuse a friction of which a value has run to an end of its range, and a mode that does not swing once.

    Judging would deny both. A bristle that gives way by a picometre is a sign of the velocity, and takes minutes to
    simulate; a warm-up that is over at once is another viscous friction, while one that takes all of a declared drag is
    none yet where that drag is fitted; a mode of a period longer than the recording
    drags at the table as a damper does. Other laws become known ones at their ends (`spring_law`, `as_payload`), which
    the search asks.

    Raises:
        InputError: there is such an effect.
    """
    for effect in effects:
        if isinstance(effect, FrictionEffect) and (
            at_its_limit(effect) or (at_an_end(effect, problem.plant) and not _of_a_fitted_level(problem, effect))
        ):
            raise InputError(f"{effect.name} has run to the end of what is physical", effect.name)
        if isinstance(effect, StructuralMode):
            longest = max((e.recording.duration for e in problem.evidence), default=math.inf)
            if number(effect.values["frequency"]) * longest < 1:
                raise InputError(f"{effect.name} has a longer period than any recording", effect.name)


def _of_a_fitted_level(problem: Problem, effect: Effect) -> bool:
    """Whether an effect is a share of a declared drag that is fitted: of all of one that is more, more is lost."""
    known = problem.calibration
    drag = f"{effect.port}.viscous"
    return isinstance(effect, ViscousWarmup) and known is not None and any(one.key == drag for one in known.values)


def refuse_of_no_hours(problem: Problem, effects: Sequence[Effect]) -> None:
    """Refuse what recordings of hours do not bear out: what is over in one stretch, or is a lead error.

    What has warmed up within the first stretch no other one shows to have changed: over hours it stays as it is, and
    its first seconds take what else is not named at the places of one stretch. Growth and lost motion of which less
    than half remains beside a lead error of any shape over the stroke are nearer to none.

    Raises:
        InputError: there is such an effect.
    """
    first = min(first_stretch(e.recording) for e in problem.evidence)
    for effect in effects:
        if isinstance(effect, ThermalGrowth | ViscousWarmup) and number(effect.values["time_constant"]) < first:
            raise InputError(f"{effect.name} is over within the first stretch of the recording", effect.name)
    for place, effect in enumerate(effects):
        by_map = first > 0 and isinstance(effect, ThermalGrowth | Backlash | PreloadLoss)
        if by_map and not _left_beside_a_map(problem, effects, place) > 0.5:
            raise InputError(f"{effect.name}: a lead error over the stroke says it as well", effect.name)


def _left_beside_a_map(problem: Problem, effects: Sequence[Effect], place: int) -> float:
    """Share of an effect of a set that remains where the table position has any lead error over the stroke beside it.

    Stretches of different hours lie at different places, and some are passed one way more often than the other. So what
    is other from place to place seems to grow, or to lag; growth is what the same place has at different hours, and
    lost motion what it has in both directions. With P the means over cells of the stroke taken out and g what the
    effect makes: 1 + (P g)'(P r) / |P g|^2, r being left by the set.
    """
    rest = [*effects[:place], *effects[place + 1 :]]
    total, square = 0.0, 0.0
    for e in problem.evidence:
        if "table_position" not in e.channels:
            continue
        rows, measured = e.fit_rows, e.measured["table_position"]
        having, lacking = (
            problem.predictor.predict(problem.machine(some), e)["table_position"][rows] for some in (effects, rest)
        )
        x = measured[rows]
        cells = np.digitize(x, np.linspace(x.min(), x.max(), BINS + 1)[1:-1])
        made = having - lacking
        own = made - _means(made, cells)
        total, square = total + float(own @ (x - having)), square + float(own @ own)
    return 1.0 + total / square if square > 0 else 0.0


def _means(series: FloatArray, cells: IntegerArray) -> FloatArray:
    """At every row the mean over its cell, (n,)."""
    count = np.maximum(np.bincount(cells), 1)
    found: FloatArray = (np.bincount(cells, weights=series) / count)[cells]
    return found


def _one_linear_step(fitted: Fit) -> Fit:
    """The fit as one linear step would leave it, the values as they were; ranks starts at no simulation."""
    step = linear_step(fitted.jacobian, fitted.residual)
    return replace(fitted, residual=fitted.residual - fitted.jacobian @ step, coordinates=fitted.coordinates + step)


def compared(problem: Problem, name: str, result: Fit, before: Sequence[Effect]) -> Attempt:
    """Compare a fit with the effects before it, both on the same samples and both with their own effects free."""
    blocks = block_numbers(problem)
    if len(blocks) != len(result.residual):
        result = fit(problem, result.effects, _free(result, before), iterations=0)
    reference = _reference(problem, before, result)
    without = left_out_residual(problem, reference, blocks)
    errors = left_out_residual(problem, result, blocks)
    least = least_gain(problem, without, errors)
    comparison, evenly = (of(without, errors, blocks, least) for of in (compare_left_out, compare_levelled))
    return Attempt(name, result, comparison, problem, evenly)


def _free(result: Fit, before: Sequence[Effect]) -> list[bool]:
    """Which effects a fit had free: the last alone, or all."""
    joint = result.effects[: len(before)] != tuple(before)
    return [joint] * len(before) + [True] * (len(result.effects) - len(before))


def _reference(problem: Problem, before: Sequence[Effect], result: Fit) -> Fit:
    joint = result.effects[: len(before)] != tuple(before)
    return fit(problem, before, [joint] * len(before), iterations=0)


def with_short_blocks(problem: Problem) -> Problem:
    """The problem with blocks of cross-validation so short that a brief passage spans several of them.

    A chirp passes a resonance once, in less than a block: without that block nothing tells its frequency, and the error
    on data not fitted would be that of a guess. Short blocks are still many correlation times of the band.
    """
    return replace(problem, evidence=tuple(replace(e, block=min(e.block, SHORT_BLOCK)) for e in problem.evidence))


def with_predictable(problem: Problem, effects: Sequence[Effect]) -> Problem:
    """The problem without the samples that tell nothing of a plant with these effects.

    Where those that are left fill fewer blocks than there are folds, the blocks are shortened: under a test signal that
    never pauses, free play is chaotic but for some tenths of a second, of which no fold may hold all.
    """
    plant = problem.machine(effects)
    kept = tuple(e.where_predictable(problem.predictor.to_fit(plant, e)) for e in problem.evidence)
    if any(not e.fit_rows.any() for e in kept):
        return problem
    left = replace(problem, evidence=kept)
    return with_short_blocks(left) if len(np.unique(block_numbers(left))) < FOLDS else left
