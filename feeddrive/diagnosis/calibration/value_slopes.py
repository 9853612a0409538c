"""Slopes of predictions with the coordinates of declared values: taken anew, or kept where they hold still."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from feeddrive.diagnosis.calibration.declared import CalibratedValue
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.predictability import has_play
from feeddrive.effects.base import ChainEffect, Effect, listed
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray

STEP = 1e-3
"""Change of the logarithm of a value from which its slope is taken; ten times that of a coordinate of size one."""

SHORT, SHORTEST = 1.0, STEP / 30
"""Deviations of the noise by which the step of a slope moves all rows together at most, and the shortest step. What a
fine scale sees of a mass or a stiffness bends with the resonance: over a thousandth its slope was two per cent off, and
values that weigh against each other, an inertia, a mass, a torque constant, could not move together. Shorter ones show
where the solver changes its steps."""

LONG = 30 * STEP
"""Change of the logarithm where a prediction goes from cell to cell, or a table bounces (`slopes.COARSE`)."""

ENOUGH = 0.1
"""Move of a value over its deviation that needs no new slopes: it moves the evidence by a two-hundredth."""

ALIKE = 0.01
"""Share by which any other value of two machines differs at most where slopes are one, such as that of an effect. A
slope is off by about the share that the machine is. Values that weigh against each other, an inertia, a mass, a torque
constant, are told by a tenth of what each does alone, and by a tenth off for it."""


def with_slopes(problem: Problem, effects: Sequence[Effect], rough: bool = False) -> Problem:
    """The problem with slopes of its declared values beside these effects: those at hand where they hold still."""
    return problem if have_slopes(problem, effects) else with_new_slopes(problem, effects, rough)


def have_slopes(problem: Problem, effects: Sequence[Effect]) -> bool:
    """Whether the slopes at hand were taken of a machine that is nearly this one."""
    known = problem.calibration
    if known is None or not known.values:
        return True
    if known.taken is None or any(e.recording not in known.slopes for e in problem.evidence):
        return False
    shares = {value.key: ENOUGH * value.deviation / value.widened for value in known.values}
    return _are_alike(known.taken, problem.machine(effects), shares)


def _are_alike(one: Plant, other: Plant, shares: Mapping[str, float]) -> bool:
    """Whether two plants have the same effects, and every value alike: within a share of its own, or `ALIKE`."""
    chains, effects = (one.chain_values(), other.chain_values()), (_not_in_chain(one), _not_in_chain(other))
    if [_place(e) for e in effects[0]] != [_place(e) for e in effects[1]]:
        return False
    pairs = [(first, chains[1][key], 0.0, shares.get(key, ALIKE)) for key, first in chains[0].items()]
    for first, second in zip(*effects, strict=True):
        for key, values in first.values.items():
            numbers = listed(values), listed(second.values[key])
            if len(numbers[0]) != len(numbers[1]):
                return False
            size, share = first.parameter(key).size, shares.get(f"{first.port}.{key}", ALIKE)
            pairs += [(*both, size, share) for both in zip(*numbers, strict=True)]
    return all(abs(a - b) <= share * max(abs(a), abs(b), size) for a, b, size, share in pairs)


def _not_in_chain(plant: Plant) -> list[Effect]:
    return [e for e in plant.effects if not isinstance(e, ChainEffect) or e.adds_coordinate]


def _place(effect: Effect) -> tuple[str, str, str]:
    return effect.name, str(effect.port), effect.place


def with_new_slopes(problem: Problem, effects: Sequence[Effect], rough: bool = False) -> Problem:
    """The problem with the slopes of its declared values beside these effects, the values as they are."""
    if problem.calibration is None or not problem.calibration.values:
        return problem
    slopes = {e.recording: slopes_of(problem, effects, e, rough) for e in problem.evidence}
    more, taken = _number_slopes(problem, effects), None if rough else problem.machine(effects)
    return replace(problem, calibration=replace(problem.calibration, slopes=slopes, number_slopes=more, taken=taken))


def _inwards(value: CalibratedValue, coordinate: float, step: float) -> float:
    """A step from a coordinate, turned around where it leads beyond the factor that the value may have."""
    return step if abs(coordinate + step) <= value.farthest else -step


def _number_slopes(problem: Problem, effects: Sequence[Effect]) -> FloatArray:
    """Slope of the measured numbers with the coordinates of the declared values, over their deviations, (n, k)."""
    known, rows = problem.calibration, replace(problem.numbers, weight=1.0)
    assert known is not None
    if not len(rows):
        return np.zeros((0, len(known.values)))
    base, columns = rows.predicted(problem.machine(effects)), []
    for i, value in enumerate(known.values):
        step = _inwards(value, known.coordinates[i], STEP / value.deviation)
        coordinates = known.coordinates.copy()
        coordinates[i] += step
        there = replace(problem, calibration=replace(known, coordinates=coordinates)).machine(effects)
        columns.append((rows.predicted(there) - base) / step)
    return np.column_stack(columns)


def slopes_of(
    problem: Problem, effects: Sequence[Effect], evidence: Evidence, rough: bool = False
) -> dict[str, FloatArray]:
    """Channel to its slope with the coordinates of the declared values, (n, k), SI.

    From both sides where the step must be long (`LONG`): one side's slope would be that of half a step away, and where
    two values are alike, fits along it end where the slopes are wrong, not where the values are right. Masses,
    stiffnesses, dampings, frictions and the torque constant that all grow alike change no prediction where all are
    fitted: beside a free play a long step's secants, some per cent off, would tell of what no recording tells. What
    they do together is therefore taken from one step of all of them, and the slopes agree with it. No step leads
    beyond the factor that a value may have: there it would tell nothing.
    """
    known = problem.calibration
    assert known is not None

    def at(direction: FloatArray, step: float) -> dict[str, FloatArray]:
        coordinates = known.coordinates + direction * step
        there = replace(problem, calibration=replace(known, coordinates=coordinates)).machine(effects)
        return problem.predictor.predict(there, evidence)

    bounces = has_play(effects) and evidence.lost is not None
    each, alike = np.eye(len(known.values)), np.array([one.scales_with_force / one.deviation for one in known.values])
    for i, value in enumerate(known.values):
        ahead, back = (_inwards(value, float(known.coordinates[i]), way * LONG / value.deviation) for way in (1, -1))
        alike[i] *= ahead != back  # one at its end does not grow with the others
    smooth, base = problem.predictor.smooth(problem.plant) and not bounces, at(alike, 0.0)
    # column by column, as they are made and weighed
    slopes = {name: np.empty((len(base[name]), len(known.values)), order="F") for name in evidence.channels}
    sizes = np.zeros(len(known.values))
    if smooth and not rough and known.slopes and problem.whitener is not None:
        sizes = np.linalg.norm(problem.whitener.columns, axis=0)
    for i, value in enumerate(known.values):
        step = (STEP if smooth else LONG) / value.deviation
        step = max(min(step, SHORT / sizes[i]), SHORTEST / value.deviation) if sizes[i] > 0 else step
        ahead, back = (_inwards(value, float(known.coordinates[i]), one) for one in (step, -step))
        after, before, apart = at(each[i], ahead), base, ahead
        if not smooth and not rough and back != ahead:
            before, apart = at(each[i], back), ahead - back
        for name in evidence.channels:
            slopes[name][:, i] = (after[name] - before[name]) / apart
    if smooth:
        return slopes
    after, before, apart = at(alike, LONG), base, LONG
    if not rough:
        before, apart = at(alike, -LONG), 2 * LONG
    return {name: _agreeing(k, alike, (after[name] - before[name]) / apart) for name, k in slopes.items()}


def _agreeing(slopes: FloatArray, direction: FloatArray, along: FloatArray) -> FloatArray:
    """Slopes (n, k) that are `along`, (n,), in a direction (k,), each changed by the square of its share of a row."""
    shares = (slopes * direction) ** 2
    whole = np.sum(shares, axis=1, keepdims=True)
    shares = np.divide(shares, whole, out=np.zeros_like(shares), where=whole > 0)
    missed = along - slopes @ direction
    inverse = np.divide(1.0, direction, out=np.zeros_like(direction), where=direction != 0)
    agreeing: FloatArray = slopes + shares * missed[:, None] * inverse
    return agreeing
