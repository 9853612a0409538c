"""Columns of all sets of effects near the one at hand: what each is worth as far as slopes tell, nothing simulated.

With every effect's slopes taken at its own start,

    r_S = r - Σ_added (s_i + J_i θ_i) - Σ_dropped s_m - J_kept θ

| symbol | meaning | unit |
|---|---|---|
| r | residual of the set that was found | 1 |
| s_i, J_i | what an effect at its start takes from r, and its slopes there | 1 |
| s_m | what taking a member out takes from r | 1 |
| θ | coordinates, fitted by least squares in every set, within what is physical | 1 |

All products of these columns are taken once; a set then costs the solution of a small system.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.diagnosis.certainty.noise_colour import score_covariance
from feeddrive.diagnosis.finding.attempt import Attempt
from feeddrive.diagnosis.likelihood.coordinates import coordinate_ends, read_coordinates, write_coordinates
from feeddrive.diagnosis.likelihood.fit import Fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.set_evidence import discrepancy, log_odds, log_prior_of_size, log_volume
from feeddrive.effects.base import Effect
from feeddrive.typing import FloatArray, IntegerArray

TINY = 1e-300
"""In place of no variance at all."""


@dataclass(frozen=True)
class Neighbour:
    """A set that differs from the one found.

    Attributes:
        dropped: places of the members that are not in it.
        added: numbers of the attempts that are.
        gain: logarithm of the odds for it against the set found, as far as slopes tell.
        speaks: part of it that grows with the time recorded.
        effects: of the set, with values as slopes tell; empty where the set was not weighed closely.
    """

    dropped: tuple[int, ...]
    added: tuple[int, ...]
    gain: float
    speaks: float = 0.0
    effects: tuple[Effect, ...] = ()

    @property
    def is_next(self) -> bool:
        """Whether one move leads to it."""
        return len(self.added) <= 1 and len(self.dropped) <= 1


def not_told(normal: FloatArray, scatter: FloatArray, step: FloatArray, length: FloatArray) -> FloatArray:
    """Part of a step, (k,), that goes further than a size for less than p(θ) takes: there no slope tells the way.

    Args:
        normal, scatter: of columns of length one, products and covariance of their products with the residual, (k, k).
        step: in their coefficients, (k,).
        length: of the columns, (k,).
    """
    if not (np.all(np.isfinite(normal)) and np.all(np.isfinite(scatter)) and np.any(np.abs(step / length) > 1)):
        return np.zeros(len(step))
    information, ways = np.linalg.eigh(normal)
    along = ways.T @ step
    variance = np.sum(ways * (scatter @ ways), axis=0) / np.maximum(information, TINY)
    sizes = ways * along / length[:, None]
    gained = 0.5 * along**2 * information / np.maximum(variance, TINY)
    costly = (gained < np.sum(np.log1p(sizes**2), axis=0)) & (np.max(np.abs(sizes), axis=0) > 1)
    part: FloatArray = ways @ np.where(costly, along, 0.0)
    return part


def within(
    normal: FloatArray, wanted: FloatArray, step: FloatArray, low: FloatArray, high: FloatArray
) -> FloatArray:  # fmt: skip
    """A step, (k,), that no coordinate leaves its range by: those at an end stay there, the others are solved anew.

    A delay that would have to be negative explains as much as the delay of another channel, and is none.

    Args:
        normal, wanted: of the normal equations, (k, k) and (k,).
        step: their solution, or what is told of it, (k,).
        low, high: farthest steps to the ends of what is physical, (k,); none beyond where a coordinate is.
    """
    low, high = np.minimum(low, 0.0), np.maximum(high, 0.0)
    held = np.zeros(len(step), dtype=bool)
    while np.any(beyond := ~held & ((step < low) | (step > high))):
        step = np.where(beyond, np.clip(step, low, high), step)
        held |= beyond
        free = ~held
        there = wanted[free] - normal[np.ix_(free, held)] @ step[held]
        step[free] = np.linalg.lstsq(normal[np.ix_(free, free)], there, rcond=1e-10)[0]
    return step


class Columns:
    """All columns of the sets near one, and their products.

    Not a frozen record: it holds the products beside what they are of.
    """

    def __init__(self, problem: Problem, found: Fit, attempts: Sequence[Attempt], count: int) -> None:
        self.problem, self.found, self.count = problem, found, count
        self.own = [attempt.fit for attempt in attempts]
        sizes = [len(read_coordinates([effect], problem.plant)) for effect in found.effects]
        self.member = np.cumsum([0, *sizes])
        parts = [found.jacobian]
        for place in range(len(found.effects)):
            rest = (*found.effects[:place], *found.effects[place + 1 :])
            parts.append((found.residual - problem.residual(rest))[:, None])
        self.first_own: list[int] = []
        at = found.jacobian.shape[1] + len(found.effects)
        for fitted in self.own:
            parts += [(found.residual - fitted.residual)[:, None], fitted.jacobian]
            self.first_own.append(at)
            at += 1 + fitted.jacobian.shape[1]
        columns = np.hstack(parts)
        # ends of what is physical, of every column that has a coordinate
        self.low, self.high = np.full(columns.shape[1], -np.inf), np.full(columns.shape[1], np.inf)
        own = ((at + 1, fitted.effects[-1:]) for at, fitted in zip(self.first_own, self.own, strict=True))
        for first, effects in ((0, found.effects), *own):
            low, high = coordinate_ends(effects, problem.plant)
            self.low[first : first + len(low)], self.high[first : first + len(high)] = low, high
        # a member that cannot be left out, or a slope that no number can hold, is no way to go
        self.able = np.all(np.isfinite(columns), axis=0)
        self.columns = np.where(self.able, columns, 0.0)
        self.products = self.columns.T @ self.columns
        self.with_residual = self.columns.T @ found.residual
        rows = [evidence.fit_rows for evidence in problem.evidence]
        measured = self.columns[len(self.columns) - len(problem.numbers) :]
        self.scatter = score_covariance(problem.evidence, rows, found.residual, self.columns)
        self.scatter += problem.numbers.weight**2 * measured.T @ measured
        # what declared values cost: the square of these, (k,), less those that a set takes, over λ
        known = problem.whitener
        share = (
            np.zeros((0, len(found.residual))) if known is None else known.basis.T * np.sqrt(1 - known.kept**2)[:, None]
        )
        self.cost, self.cost_taken = share @ found.residual, share @ self.columns
        self.unit = 1.0 if known is None else known.variance

    def _taken(
        self, dropped: Sequence[int], added: Sequence[int]
    ) -> tuple[FloatArray, IntegerArray, tuple[Effect, ...], FloatArray]:
        """What all columns of a set take from the residual, the free ones of them, its effects and coordinates."""
        kept = [place for place in range(len(self.found.effects)) if place not in dropped]
        free = [i for place in kept for i in range(self.member[place], self.member[place + 1])]
        fixed = [self.found.jacobian.shape[1] + place for place in dropped]
        start = [self.found.coordinates[i] for i in free]
        for i in added:
            fixed.append(self.first_own[i])
            free += range(self.first_own[i] + 1, self.first_own[i] + 1 + self.own[i].jacobian.shape[1])
            start += list(self.own[i].coordinates)
        effects = (*(self.found.effects[place] for place in kept), *(self.own[i].effects[-1] for i in added))
        taken = np.zeros(len(self.products))
        taken[fixed] = 1.0
        places = np.array(free, dtype=np.int64)
        if len(places):
            wanted = self.with_residual[places] - self.products[np.ix_(places, fixed)].sum(axis=1)
            length = np.sqrt(np.diag(self.products)[places])
            length = np.where(length > 0, length, 1.0)
            scale, own = np.outer(length, length), np.ix_(places, places)
            normal, scatter = self.products[own] / scale, self.scatter[own] / scale
            step = np.linalg.lstsq(normal, wanted / length, rcond=1e-10)[0]
            step -= not_told(normal, scatter, step, length)
            room = [(ends[places] - start) * length for ends in (self.low, self.high)]
            taken[places] = within(normal, wanted / length, step, *room) / length
        if not np.all(self.able[fixed]):
            taken[:] = np.nan
        return taken, places, effects, np.array(start) + taken[places]

    def weighed(self, dropped: tuple[int, ...], added: tuple[int, ...]) -> Neighbour:
        """A set by the colour of the residual at hand, smaller by what the set takes away."""
        taken, free, effects, coordinates = self._taken(dropped, added)
        if not np.all(np.isfinite(taken)):
            return Neighbour(dropped, added, -np.inf)
        before = self.found.squared_error
        square = float(taken @ self.products @ taken)
        excess = 2 * float(taken @ self.with_residual) - square
        less = min(before, before - excess)
        if square <= 0 or less <= 0:
            return Neighbour(dropped, added, -np.inf)
        variance = float(taken @ self.scatter @ taken) / square * less / before
        variance += discrepancy(self.problem, less)
        after = self.cost - self.cost_taken @ taken
        cheaper = float(self.cost @ self.cost - after @ after)
        speaks = 0.5 * (excess - cheaper) / max(variance, TINY) + 0.5 * cheaper / self.unit
        return Neighbour(dropped, added, self._gain(speaks, variance, free, effects, coordinates), speaks)

    def _gain(
        self, speaks: float, variance: float, free: IntegerArray, effects: Sequence[Effect], coordinates: FloatArray
    ) -> float:
        plant, found = self.problem.plant, self.found
        mine = slice(0, found.jacobian.shape[1])
        after = log_volume(effects, plant, coordinates, self.products[np.ix_(free, free)], variance)
        before = log_volume(found.effects, plant, found.coordinates, self.products[mine, mine], variance)
        sizes = [log_prior_of_size(len(some), self.count) for some in (effects, found.effects)]
        return speaks + after - before + sizes[0] - sizes[1]

    def weighed_closely(self, one: Neighbour) -> Neighbour:
        """The set by the colour of what it leaves itself, where that is less."""
        taken, free, effects, coordinates = self._taken(one.dropped, one.added)
        if not np.all(np.isfinite(taken)):
            return one
        left = self.found.residual - self.columns @ taken
        there = Fit(effects, left, self.columns[:, free], coordinates)
        placed = write_coordinates(effects, self.problem.plant, coordinates)
        return replace(one, gain=log_odds(self.problem, self.found, there, self.count), effects=tuple(placed))
