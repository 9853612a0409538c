"""What a series of values may do, and the evidence of each: jump, begin to change, settle, be odd in one recording.

| kind | course, 0 before its date | |
|---|---|---|
| jump | 1 from its date on | a part gave way, was exchanged, was adjusted |
| slope | (t - date) ((t - date) / (end - date))^(power - 1): its size is the mean rate | wear, loss of preload |
| settling | 1 - exp(-(t - date) / time constant) | warming, running in |
| odd | 1 in one recording | it stands alone: another load, another programme |

How likely values are under a level and some courses, sizes integrated out:

    y = a + X b + e,    e ~ N(0, s^2 K),    p(a, s) ~ 1/s,    b ~ N(0, n s^2 (X' K^-1 X)^-1)

    log p(y | X, K) = -1/2 log |K| - 1/2 log (1' K^-1 1) - (n-1)/2 log S0 - (n-1)/2 log(1 - n/(1+n) R^2) - k/2 log(1+n)

S0 is the whitened sum of squares about the level, R^2 the share of it that the courses take. The prior of b holds as
much information as one value (Zellner's g-prior, g = n; R. E. Kass and L. Wasserman, JASA 90, 1995): no size has to
be set. Source of the closed form: F. Liang et al., Mixtures of g priors, JASA 103 (2008), eq. (5).

The noise e is the scatter from file to file, and what wanders with the days:

    K = (1 - nu) diag(w) + nu exp(-|t_i - t_j| / tau)

| symbol | meaning |
|---|---|
| w | relative variance of a value: 1, more where its recording tells less |
| nu | share of the variance that wanders: lubrication, temperature of the hall |
| tau | time within which it forgets |

Neither nu nor tau is known: every model of a series is judged over all of a grid of them, and the size of K is
integrated out. A series that wanders is thereby not taken for one that changes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.special import logsumexp

from feeddrive.typing import FloatArray

JUMP, SLOPE, SETTLING, ODD = "jump", "slope", "settling", "odd"

FEWEST_AFTER = 2
"""Recordings that a jump or a slope needs on either side: one alone cannot be distinguished from an odd recording."""

POWERS = (1.0, 1.5, 2.0)
"""How slopes rise: wear is even, but what it moves is seldom linear in it (compliance goes with 1 / stiffness), and a
line through a curve that steepens begins too late."""

SETTLING_DATES = 24
TIME_CONSTANTS = 10
"""Dates and time constants that are tried for a course that settles; it is refined from the best."""


@dataclass(frozen=True)
class Atom:
    """One course.

    Attributes:
        kind: see above.
        date: where it begins, in the time of the series.
        time_constant: of a course that settles; 0 else.
        power: of a slope: 1 for an even one, above for one that gets steeper.
    """

    kind: str
    date: float
    time_constant: float = 0.0
    power: float = 1.0

    def course(self, time: FloatArray) -> FloatArray:
        """Its values, (n,)."""
        since = time - self.date
        if self.kind == JUMP:
            return np.where(since >= 0, 1.0, 0.0)
        if self.kind == ODD:
            return np.where(since == 0, 1.0, 0.0)
        after = np.clip(since, 0.0, None)
        if self.kind == SETTLING:
            settled: FloatArray = -np.expm1(-after / self.time_constant)
            return settled
        steeper: FloatArray = after * (after / max(float(after[-1]), 1e-300)) ** (self.power - 1)
        return steeper


def candidates(time: FloatArray) -> tuple[Atom, ...]:
    """All that are tried for a series at times (n,), ascending."""
    count = len(time)
    inner = time[FEWEST_AFTER : count - FEWEST_AFTER + 1]
    found = [Atom(JUMP, float(date)) for date in inner]
    found += [Atom(SLOPE, date, 0.0, power) for date in _beginnings(time) for power in POWERS]
    found += [Atom(ODD, float(date)) for date in time]
    usual, span = float(np.median(np.diff(time))), float(time[-1] - time[0])
    dates = time[np.unique(np.linspace(0, count - 1 - FEWEST_AFTER, SETTLING_DATES).astype(int))]
    for date in dates:
        left = float(time[-1] - date)
        # one that settles within a file is a jump, one that takes longer than there are files is a slope
        constants = np.geomspace(1.5 * usual, 2 * span, TIME_CONSTANTS)
        found += [Atom(SETTLING, float(date), float(tau)) for tau in constants if tau <= 2 * left]
    return tuple(found)


LONG = 1.5
"""Usual distances of recordings beyond which there is a gap."""

IN_A_GAP = 12
"""Dates in a gap at most: wear that began in it is dated to a tenth of it."""


def _beginnings(time: FloatArray) -> list[float]:
    """Dates at which a slope may begin: of the recordings, and between two that lie far apart."""
    usual = float(np.median(np.diff(time)))
    found: list[float] = []
    for date, later in pairwise(time[: len(time) - FEWEST_AFTER + 1]):
        steps = min(IN_A_GAP, int((later - date) / usual)) if later - date > LONG * usual else 1
        found += [float(date + (later - date) * step / steps) for step in range(steps)]
    return found


def before_gap(time: FloatArray, dates: FloatArray) -> FloatArray:
    """The recording before each date of a jump where a gap lies between, else the date itself, (d,)."""
    usual, at = float(np.median(np.diff(time))), np.searchsorted(time, dates)
    earlier = time[np.maximum(at - 1, 0)]
    found: FloatArray = np.where(dates - earlier > LONG * usual, earlier, dates)
    return found


def courses(atoms: tuple[Atom, ...] | list[Atom], time: FloatArray) -> FloatArray:
    """Their values side by side, (n, k)."""
    if not atoms:
        return np.zeros((len(time), 0))
    return np.column_stack([atom.course(time) for atom in atoms])


LEAST_LEFT = 1e-12
"""Share of a candidate's or the values' squared length that others leave: less is rounding."""


SHARES = (0.3, 0.6, 0.9)
MEMORIES = (1.0, 3.0, 10.0, 30.0, 100.0)
"""What the wandering part may be: shares, and memories in usual distances of the recordings, in half-decades."""


@dataclass(frozen=True, eq=False)
class Noise:
    """All settings of the grid, h of them.

    Attributes:
        whitening: inverse of the lower Cholesky factor of each K, (h, n, n).
        log_determinant: of each K, (h,).
        log_prior: of each setting, (h,): a machine that does not wander is as likely as one that does in any way.
    """

    whitening: FloatArray
    log_determinant: FloatArray
    log_prior: FloatArray

    def white(self, columns: FloatArray) -> FloatArray:
        """Columns, (n, k), as they are where the noise is white and of size one, (h, n, k)."""
        found: FloatArray = self.whitening @ columns
        return found


def noise_of(time: FloatArray, variance: FloatArray) -> Noise:
    """The settings of the grid.

    Args:
        time: of the recordings, ascending, (n,).
        variance: relative, (n,).
    """
    usual = float(np.median(np.diff(time)))
    apart = np.abs(time[:, None] - time[None, :]) / usual
    settings = [(0.0, 1.0), *((share, memory) for share in SHARES for memory in MEMORIES)]
    inverses, logs = [], []
    for share, memory in settings:
        wandering = share * np.exp(-apart / memory) if share else 0.0
        factor = cholesky(np.diag((1 - share) * variance) + wandering, lower=True)
        inverses.append(solve_triangular(factor, np.eye(len(time)), lower=True))
        logs.append(2 * float(np.sum(np.log(np.diag(factor)))))
    prior = np.log([0.5, *([0.5 / (len(settings) - 1)] * (len(settings) - 1))])
    return Noise(np.array(inverses), np.array(logs), prior)


@dataclass(frozen=True, eq=False)
class Timeline:
    """Times and weights of a series, with all that does not depend on its values.

    Attributes:
        time: ascending, (n,).
        variance: relative, (n,).
    """

    time: FloatArray
    variance: FloatArray

    @cached_property
    def noise(self) -> Noise:
        """The noise that may be, h settings."""
        return noise_of(self.time, self.variance)

    @cached_property
    def tried(self) -> tuple[Atom, ...]:
        """Candidates."""
        return candidates(self.time)

    @cached_property
    def white_tried(self) -> tuple[FloatArray, FloatArray]:
        """Candidates in white noise, (h, n, m), and their squared lengths, (h, m); in single precision."""
        white = np.array([(one @ courses(self.tried, self.time)).astype(np.float32) for one in self.noise.whitening])
        return white, np.sum(white**2, axis=1, dtype=float)


@dataclass(frozen=True, eq=False)
class Parts:
    """A set of courses in white noise, one of each for every setting.

    Attributes:
        evidence: log p(y, K | atoms), (h,).
        total: S0, (h,).
        basis: orthonormal, of level and courses, (h, n, 1 + k).
        left: what they leave of the values, (h, n).
    """

    evidence: FloatArray
    total: FloatArray
    basis: FloatArray
    left: FloatArray


@dataclass(frozen=True, eq=False)
class Series:
    """Values of one quantity over the recordings.

    Attributes:
        line: their times.
        values: (n,), scaled to a spread of one for the sake of rounding.
    """

    line: Timeline
    values: FloatArray

    def evidence(self, atoms: Sequence[Atom]) -> FloatArray:
        """log p(y, K | atoms) for each setting of the noise, (h,)."""
        return self._parts(atoms).evidence

    def summed(self, atoms: Sequence[Atom]) -> float:
        """log p(y | atoms), settings of the noise summed out."""
        return float(logsumexp(self.evidence(atoms)))

    def with_one_more(self, atoms: Sequence[Atom]) -> FloatArray:
        """log p(y | atoms and one candidate), settings of the noise summed out, (m,)."""
        count = len(self.values)
        shrink = count / (1 + count)
        given = self._parts(atoms)
        white, length = self.line.white_tried
        inside = given.basis.transpose(0, 2, 1).astype(np.float32) @ white
        beyond = length - np.sum(inside**2, axis=1, dtype=float)
        possible = beyond > 1e-5 * length  # single precision
        along = (given.left[:, None, :].astype(np.float32) @ white)[:, 0, :].astype(float)
        gain = np.where(possible, along**2 / np.where(possible, beyond, 1.0), 0.0) / given.total[:, None]
        before = (1 - shrink * (1 - np.sum(given.left**2, axis=1) / given.total))[:, None]
        after = np.clip(before - shrink * gain, LEAST_LEFT, None)
        better = -0.5 * (count - 1) * (np.log(after) - np.log(before)) - 0.5 * np.log(1 + count)
        summed: FloatArray = logsumexp(given.evidence[:, None] + np.where(possible, better, -np.inf), axis=0)
        return summed

    @cached_property
    def _about(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """In white noise, of each setting: the level, (h, n); the values less their level, (h, n); its size, (h,)."""
        white = self.line.noise.white(np.column_stack([np.ones(len(self.values)), self.values]))
        level, whole = white[:, :, 0], white[:, :, 1]
        size = np.sum(level**2, axis=1)
        return level, whole - level * (np.sum(level * whole, axis=1) / size)[:, None], size

    def _parts(self, atoms: Sequence[Atom]) -> Parts:
        count = len(self.values)
        level, about, size = self._about
        total = np.maximum(np.sum(about**2, axis=1), LEAST_LEFT)
        columns = np.concatenate(
            [level[:, :, None], self.line.noise.white(courses(list(atoms), self.line.time))], axis=2
        )
        basis, triangle = np.linalg.qr(columns)
        kept = np.abs(np.diagonal(triangle, axis1=1, axis2=2)) > 1e-9 * np.linalg.norm(columns, axis=1)
        basis = basis * kept[:, None, :]
        left = about - (basis @ (basis.transpose(0, 2, 1) @ about[:, :, None]))[:, :, 0]
        share = 1 - np.sum(left**2, axis=1) / total
        log = (
            self.line.noise.log_prior
            - 0.5 * self.line.noise.log_determinant
            - 0.5 * np.log(size)
            - 0.5 * (count - 1) * np.log(total)
            - 0.5 * (count - 1) * np.log(np.maximum(1 - count / (1 + count) * share, LEAST_LEFT))
            - 0.5 * (np.sum(kept, axis=1) - 1) * np.log(1 + count)
        )
        return Parts(log, total, basis, left)

    def estimate(self, atoms: Sequence[Atom]) -> tuple[FloatArray, FloatArray, float]:
        """Level and sizes of the courses, (1 + k,), their covariance, and the scatter of a value about them.

        Over the settings of the noise, each by its evidence.
        """
        logs = self.evidence(atoms)
        weights = np.exp(logs - logsumexp(logs))
        columns = np.column_stack([np.ones(len(self.values)), courses(list(atoms), self.line.time)])
        freedom = max(1, len(self.values) - columns.shape[1])
        sizes, spreads, scatters = [], [], []
        for whitening in self.line.noise.whitening:
            white, y = whitening @ columns, whitening @ self.values
            inverse = np.linalg.pinv(white.T @ white)
            size = inverse @ (white.T @ y)
            variance = float(np.sum((y - white @ size) ** 2)) / freedom
            sizes.append(size)
            spreads.append(variance * inverse)
            scatters.append(variance)
        mean = np.einsum("h,hk->k", weights, np.array(sizes))
        about = np.array(sizes) - mean
        spread = np.einsum("h,hij->ij", weights, np.array(spreads)) + np.einsum("h,hi,hj->ij", weights, about, about)
        return mean, spread, float(np.sqrt(weights @ np.array(scatters)))
