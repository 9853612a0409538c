"""Declared values fitted within their tolerances beside a set of effects."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.diagnosis.calibration.calibration import Calibration
from feeddrive.diagnosis.calibration.declared import CalibratedValue, calibrated_values
from feeddrive.diagnosis.calibration.known import known_values
from feeddrive.diagnosis.calibration.value_slopes import ENOUGH, slopes_of, with_slopes
from feeddrive.diagnosis.certainty.noise_colour import score_covariance
from feeddrive.diagnosis.likelihood.evidence import UNSEEN, Evidence
from feeddrive.diagnosis.likelihood.fit import Fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.preparing import weighed_by
from feeddrive.effects.base import Effect
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.recording.long.joined import is_joined
from feeddrive.typing import FloatArray

PASSES = 8
"""New slopes at most, before anything is found and beside a value that is beyond its tolerance."""


def calibrated(problem: Problem) -> Problem:
    """The problem with its declared values fitted within their tolerances, nothing else being there."""
    if problem.calibration is not None or not problem.predictor.answers_chain:
        return problem
    values = calibrated_values(problem.plant)
    if not values:
        return problem
    start = replace(problem, calibration=Calibration(values, np.zeros(len(values)), {}, 1.0))
    if of_hours(problem):
        return weighed_by_rest(_without_unseen(weighed_by_rest(start, ())), ())
    start = _without_unseen(recalibrated(start, (), rough=True))
    for turn in range(PASSES):
        before, start = start, recalibrated(start, (), rough=turn == 0)
        if turn > 0 and np.max(np.abs(moved(before, start)), initial=0.0) < ENOUGH:
            break
    return _levelled_beside_encoder(start)


def _levelled_beside_encoder(start: Problem) -> Problem:
    """The problem with no channel's noise above what is left of it, the encoder's error weighed beside that noise.

    A torque that answers the steps of the encoder is no noise of its sensor, and hides what they do to the comparison.
    """
    for turn in range(PASSES):
        levelled = start.levelled()
        quieter = [a.noise != b.noise for a, b in zip(levelled.evidence, start.evidence, strict=True)]
        if turn and not any(quieter):
            break
        plant, before = showing_encoder(levelled, ()), levelled.evidence
        weighed = tuple(weighed_by(e, plant, quiet) for e, quiet in zip(before, quieter, strict=True))
        start = recalibrated(replace(levelled, evidence=weighed), ())
    return start


def showing_encoder(problem: Problem, effects: Sequence[Effect]) -> Plant:
    """The machine that shows what the encoder's error makes: that of a set, its dampings no greater than declared.

    At a resonance the error draws a damping up, and a machine with that damping shows the error less, so that it counts
    more: weights and damping would follow each other, to ten times what is declared on a machine that has no other.
    """
    known = problem.calibration
    if known is None:
        return problem.machine(effects)
    most = [0.0 if value.is_damping else np.inf for value in known.values]
    return problem.at_values(np.minimum(known.coordinates, most)).machine(effects)


def recalibrated(problem: Problem, effects: Sequence[Effect], rough: bool = False) -> Problem:
    """The problem with slopes of where it is, and its declared values as they are most likely beside these effects.

    Args:
        problem: with the values to begin from.
        effects: beside them.
        rough: slopes from one side only, where the values are far away still.
    """
    known = problem.calibration
    if known is None or not known.values:
        return problem
    sloped = with_slopes(problem, effects, rough)
    assert sloped.calibration is not None
    slopes = [rows for channels in sloped.calibration.slopes.values() for rows in channels.values()]
    if not all(np.all(np.isfinite(rows)) for rows in slopes):  # a machine near this one cannot be simulated
        return problem
    assert sloped.whitener is not None
    residual = sloped.unwhitened(effects)
    # what is left once the values are as they are most likely tells how much a row is worth
    left = residual - sloped.whitener.columns @ (sloped.whitener.most_likely(residual) - known.coordinates)
    variance = _variance(sloped, left)
    sloped = sloped.at_values(known.coordinates, variance)
    if len(problem.numbers):
        sloped = replace(sloped, numbers=problem.numbers.with_variance(variance))
        residual = sloped.unwhitened(effects)
    return sloped.stepped(effects, residual)


def at_declared(problem: Problem) -> Problem:
    """The problem with its declared values as they are declared, the slopes as they are."""
    known = problem.calibration
    if known is None:
        return problem
    return problem.at_values(np.zeros(len(known.values)))


def of_hours(problem: Problem) -> bool:
    """Whether a recording is cut out of hours, which hold much that has no name."""
    return any(is_joined(e.recording) for e in problem.evidence)


def weighed_by_rest(problem: Problem, effects: Sequence[Effect]) -> Problem:
    """The problem with no channel weighed by more than what is left of it, its declared values fitted anew from there.

    A channel of which much is left has an error of the model, not of its sensor. Its variance is not known; the most
    likely one is its mean square, n/2 log r'r in place of r'r / 2 σ², which is met by weighing in turn: begun at the
    declared values, so that none of two channels is given up for the other.

    Args:
        problem: with declared values that are fitted.
        effects: beside them.
    """
    known = problem.calibration
    if known is None or not known.values:
        return problem
    return _weighed_in_turn(at_declared(problem), effects)


def recalibrated_by_rest(problem: Problem, effects: Sequence[Effect]) -> Problem:
    """The problem as `recalibrated`, where channels are weighed by what is left of them by what these effects leave."""
    if not of_hours(problem):
        return recalibrated(problem, effects)
    return _weighed_in_turn(problem, effects)


def _weighed_in_turn(there: Problem, effects: Sequence[Effect]) -> Problem:
    if there.calibration is None or not there.calibration.values:
        return there
    for turn in range(PASSES):
        before = there
        evidence = tuple(replace(e, left=left) for e, left in zip(there.evidence, _left(there, effects), strict=True))
        there = recalibrated(replace(there, evidence=evidence), effects, rough=turn == 0)
        if turn and np.max(np.abs(moved(before, there)), initial=0.0) < ENOUGH:
            break
    return there


def _left(problem: Problem, effects: Sequence[Effect]) -> list[dict[str, float]]:
    """Per recording, channel to the rms of what is left of it over its noise, at least 1."""
    recordings = problem.by_channel(problem.unwhitened(effects))
    return [
        {name: max(math.sqrt(float(np.mean(one**2))) * e.left.get(name, 1.0), 1.0) for name, one in rows.items()}
        for e, rows in zip(problem.evidence, recordings, strict=True)
    ]


def weighed_alike(evidence: Evidence, like: Sequence[Evidence]) -> Evidence:
    """A recording with its channels weighed as those of fitted ones are, by the rms of what is left of these.

    Where a lead map is open in these it is open in it.
    """
    evidence = evidence.with_map(any(one.open_map for one in like))
    left = {
        name: math.sqrt(float(np.mean([one.left.get(name, 1.0) ** 2 for one in like if name in one.channels] or [1.0])))
        for name in evidence.channels
    }
    return replace(evidence, left=left) if any(one.left for one in like) else evidence


def levelled_alike(evidence: Evidence, before: Sequence[Evidence], after: Sequence[Evidence], plant: Plant) -> Evidence:
    """A recording with its noise put right as that of fitted ones was (`Problem.levelled`), its encoder beside that.

    Args:
        evidence: of the recording.
        before, after: the fitted recordings as they were prepared, and with their noise put right.
        plant: that shows the encoder's error.
    """
    share = {}
    for name, noise in evidence.noise.items():
        pairs = [(a.noise[name], b.noise[name]) for a, b in zip(before, after, strict=True) if name in a.noise]
        ratios = [math.log(b / a) for a, b in pairs if a > 0 and b > 0]
        if ratios and noise > 0 and (ratio := math.exp(float(np.mean(ratios)))) < 1:
            share[name] = ratio
    if not share:
        return evidence
    noise_there = {name: noise * share.get(name, 1.0) for name, noise in evidence.noise.items()}
    return weighed_by(replace(evidence, noise=noise_there), plant, quieter=True)


def with_recordings(problem: Problem, effects: Sequence[Effect], more: Sequence[Evidence]) -> Problem:
    """The problem with further recordings, their slopes beside those of the others."""
    joined = replace(problem, evidence=(*problem.evidence, *more))
    known = problem.calibration
    if known is None or not known.values:
        return joined
    slopes: dict[Recording, dict[str, FloatArray]] = {e.recording: slopes_of(problem, effects, e) for e in more}
    return replace(joined, calibration=replace(known, slopes={**slopes, **known.slopes}))


def _variance(problem: Problem, residual: FloatArray) -> float:
    """λ: square of a row times the rows that one independent value stands for, along the slopes of the values."""
    assert problem.whitener is not None
    columns = problem.whitener.columns
    score = score_covariance(problem.evidence, [e.fit_rows for e in problem.evidence], residual, columns)
    squares = np.sum(columns**2, axis=0)
    informed = squares > 0
    return float(np.median(np.diag(score)[informed] / squares[informed])) if informed.any() else 1.0


def _without_unseen(problem: Problem) -> Problem:
    """The problem without values that its recordings would not see if nothing but noise were left.

    What is left at the declared values is no measure: a value that is not seen beside an inertia off by half is seen
    once that is named, and an effect that says the same would be named for it.
    """
    assert problem.whitener is not None
    return with_kept(problem, np.sum(problem.whitener.columns**2, axis=0) > UNSEEN**2)


def with_kept(problem: Problem, kept: Sequence[bool] | np.ndarray[tuple[int], np.dtype[np.bool_]]) -> Problem:
    """The problem with some of its declared values fitted, the others as declared."""
    known = problem.calibration
    assert known is not None
    places = np.flatnonzero(np.asarray(kept))
    return replace(
        problem,
        calibration=replace(
            known,
            values=tuple(known.values[i] for i in places),
            coordinates=known.coordinates[places],
            slopes={of: {name: k[:, places] for name, k in one.items()} for of, one in known.slopes.items()},
            number_slopes=known.number_slopes[:, places] if known.number_slopes.size else known.number_slopes,
        ),
    )


def moved(before: Problem, after: Problem) -> FloatArray:
    """How far the coordinates of the declared values have moved, (k,)."""
    assert before.calibration is not None and after.calibration is not None
    return after.calibration.coordinates - before.calibration.coordinates


@dataclass(frozen=True)
class Calibrated:
    """A declared value, fitted within its tolerance.

    Attributes:
        value: which.
        coordinate: most likely, as the plant has it.
        deviation: of the coordinate, given the recordings and the tolerances of all as deviations.
        ends: of its 95 % interval as coordinates, the value inside (`Known.interval_about`).
    """

    value: CalibratedValue
    coordinate: float
    deviation: float
    ends: tuple[float, float]

    @property
    def number(self) -> float:
        """Most likely value [SI]."""
        return self.value.declared * self.value.factor(self.coordinate)

    @property
    def ci95(self) -> tuple[float, float]:
        """Interval of 95 % [SI]."""
        low, high = (self.value.declared * self.value.factor(end) for end in self.ends)
        return low, high


def calibrated_list(problem: Problem, found: Fit) -> tuple[Calibrated, ...]:
    """What is known of the declared values beside a fitted set."""
    known, settled = known_values(problem, found), problem.settled(found.effects).calibration
    if known is None or settled is None:
        return ()
    deviations = np.sqrt(np.diag(known.covariance))
    result = []
    for i, value in enumerate(known.values):
        coordinate = float(settled.coordinates[i])
        result.append(Calibrated(value, coordinate, float(deviations[i]), known.interval_about(i, coordinate)))
    return tuple(result)
