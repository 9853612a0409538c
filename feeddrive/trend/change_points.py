"""Which courses a series holds, since when, and at what odds.

Courses are added one after the other, the likeliest first, and moved to where they fit best beside the others; the
set of highest evidence times prior odds is kept, and what no longer pays in it is dropped.

Prior: in a whole watch one course of any kind, in any quantity, at any date, is as likely as none. So each of m
candidates of a kind, of K kinds in Q quantities, has prior odds 1 / (Q K m). A Bayes factor exceeds c by chance with
probability 1/c at most, at whatever moment one looks (J. Ville, 1939: it is a martingale where nothing changes), so
that asserting at odds of 100 lets at most one watch in a hundred tell of a change that is none.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.optimize import minimize, minimize_scalar
from scipy.special import logsumexp

from feeddrive.trend.series_evidence import JUMP, ODD, SETTLING, SLOPE, Atom, Series, before_gap
from feeddrive.typing import FloatArray

ASSERTED = 100.0
"""Odds from which a change is reported: at most one false one in a hundred watches, see above."""

KINDS = (JUMP, SLOPE, SETTLING, ODD)
FEWEST = 8
"""Recordings from which changes are looked for: two before, two after, and a scatter known to a third."""

MOST = 12
"""Courses of one series at most; a machine on which more happened is shown by its graph."""

AHEAD = 2
"""Courses that are added beyond the likeliest set before growing ends: a loss and a jump back pay together only."""

SWEEPS = 3
"""Times that all courses are moved beside the others; a sweep that moves none ends it."""

LEAST_GAIN = 0.01
"""Log evidence that a move has to bring: above what single precision leaves open."""


@dataclass(frozen=True)
class Found:
    """One course of a series.

    Attributes:
        atom: kind, date, time constant.
        odds: of some such course against none, the others as they are.
        dates: interval that holds the date with 95 %.
        posterior: dates that are possible, and log of the probability of each, (d,) each.
        size, deviation: of the course and its standard deviation: the height of a jump, the mean rate of a slope.
        time_constants: interval with 95 %, of a course that settles.
        settles: log odds of a course that settles against a slope, wherever either begins; 0 of a sudden one.
        since: of each possible date of a jump the recording before it, where a gap lies between, (d,); else the date.
    """

    atom: Atom
    odds: float
    dates: tuple[float, float]
    posterior: tuple[FloatArray, FloatArray]
    size: float
    deviation: float
    time_constants: tuple[float, float] = (0.0, 0.0)
    settles: float = 0.0
    since: FloatArray = field(default_factory=lambda: np.empty(0))


@dataclass(frozen=True)
class Course:
    """What a series did.

    Attributes:
        level: at the beginning, with its standard deviation.
        scatter: of one value about the courses.
        found: asserted courses, by date.
        fitted: the courses at the times of the series, (n,).
        band: their standard deviation, (n,).
    """

    level: tuple[float, float]
    scatter: float
    found: tuple[Found, ...]
    fitted: FloatArray
    band: FloatArray


def course_of(series: Series, quantities: int) -> Course:
    """Find the courses of a series.

    Args:
        series: with at least two values.
        quantities: how many are watched together.
    """
    search = _Search(series, quantities)
    atoms = search.settled(search.grown()) if len(series.values) >= FEWEST else []
    odds = [search.odds_of(atoms, place) for place in range(len(atoms))]
    while atoms and min(odds) < ASSERTED:
        del atoms[int(np.argmin(odds))]
        odds = [search.odds_of(atoms, place) for place in range(len(atoms))]
    atoms = sorted(atoms, key=lambda atom: atom.date)
    mean, spread, scatter = series.estimate(atoms)
    columns = np.column_stack([np.ones(len(series.values)), *(atom.course(series.line.time) for atom in atoms)])
    band = np.sqrt(np.clip(np.einsum("ij,jk,ik->i", columns, spread, columns), 0, None))
    found = []
    for i, atom in enumerate(atoms):
        posterior, settles = search.dates(atoms, i)
        size, deviation = float(mean[1 + i]), float(np.sqrt(spread[1 + i, 1 + i]))
        since = before_gap(series.line.time, posterior[0]) if atom.kind == JUMP else posterior[0]
        found.append(Found(atom, search.odds_of(atoms, i), most_likely(*posterior, since), posterior, size, deviation,
                           search.time_constants(atoms, i), settles, since))  # fmt: skip
    return Course((float(mean[0]), float(np.sqrt(spread[0, 0]))), scatter, tuple(found), columns @ mean, band)


@dataclass(frozen=True, eq=False)
class _Search:
    """Looks for courses in one series."""

    series: Series
    quantities: int

    @property
    def log_prior(self) -> FloatArray:
        """Log prior odds of each candidate, (m,)."""
        tried = self.series.line.tried
        many = Counter(atom.kind for atom in tried)
        return -np.log([self.quantities * len(KINDS) * many[atom.kind] for atom in tried])

    def grown(self) -> list[Atom]:
        """The likeliest courses, added one after the other; opposite ones that hide each other are found together."""
        best: list[Atom] = []
        atoms: list[Atom] = []
        highest = self.likelihood(best)
        while len(atoms) < min(MOST, len(best) + AHEAD):
            more = self.series.with_one_more(atoms) + self.log_prior
            atoms = self.moved(self.refined([*atoms, self.series.line.tried[int(np.argmax(more))]]))
            reached = self.likelihood(atoms)
            if reached > highest:
                best, highest = list(atoms), reached
        return best

    def likelihood(self, atoms: Sequence[Atom]) -> float:
        """Log of evidence times prior odds of a set of courses."""
        return self.series.summed(atoms) + sum(map(self._prior_of, atoms))

    def moved(self, atoms: list[Atom]) -> list[Atom]:
        """Each course in turn where it fits best beside the others, until none moves."""
        for _ in range(SWEEPS if len(atoms) > 1 else 0):
            before = list(atoms)
            for atom in before:
                others = [one for one in atoms if one is not atom]
                more = self.series.with_one_more(others) + self.log_prior
                best = self.series.line.tried[int(np.argmax(more))]
                held = self.series.summed([*others, atom]) + self._prior_of(atom)
                better = float(np.max(more)) > held + LEAST_GAIN
                atoms = self.refined([*others, best]) if better else [*others, atom]
            if set(atoms) == set(before):
                break
        return self.polished(atoms)

    def settled(self, atoms: list[Atom]) -> list[Atom]:
        """Courses less those that no longer pay beside the others, the others moved again."""
        while atoms:
            odds = [self.odds_of(atoms, place) for place in range(len(atoms))]
            if min(odds) >= 1:
                break
            del atoms[int(np.argmin(odds))]
            atoms = self.moved(atoms)
        return atoms

    def _prior_of(self, atom: Atom) -> float:
        tried = self.series.line.tried
        return -float(np.log(self.quantities * len(KINDS) * sum(one.kind == atom.kind for one in tried)))

    def refined(self, atoms: list[Atom]) -> list[Atom]:
        """The last course, where it settles, with its best time constant beside the others."""
        last = atoms[-1]
        if last.kind != SETTLING:
            return atoms

        def worse(log: float) -> float:
            return -self.series.summed([*atoms[:-1], replace(last, time_constant=float(np.exp(log)))])

        about = float(np.log(last.time_constant))
        best = minimize_scalar(worse, bounds=(about - 1.0, about + 1.0), method="bounded", options={"xatol": 1e-3})
        return [*atoms[:-1], replace(last, time_constant=float(np.exp(best.x)))]

    def polished(self, atoms: list[Atom]) -> list[Atom]:
        """Time constants of several that settle, moved together."""
        settling = [i for i, atom in enumerate(atoms) if atom.kind == SETTLING]
        if len(settling) < 2:
            return atoms

        def tried(logs: FloatArray) -> list[Atom]:
            found = list(atoms)
            for i, log in zip(settling, logs, strict=True):
                found[i] = replace(atoms[i], time_constant=float(np.exp(log)))
            return found

        about = np.log([atoms[i].time_constant for i in settling])
        simplex = np.vstack([about, *(about + 0.3 * row for row in np.eye(len(about)))])
        options = {"initial_simplex": simplex, "xatol": 1e-3, "fatol": 1e-2, "maxfev": 50 * len(about)}
        return tried(
            minimize(lambda logs: -self.series.summed(tried(logs)), about, method="Nelder-Mead", options=options).x
        )

    def odds_of(self, atoms: Sequence[Atom], place: int) -> float:
        """Odds of a course of any kind and date in the place of one, against none; 1e300 at most."""
        others = [atom for i, atom in enumerate(atoms) if i != place]
        more = self.series.with_one_more(others) + self.log_prior
        alone = self.series.summed(others)
        refined = self.series.summed(atoms) + self._prior_of(atoms[place])
        return float(np.exp(min(float(logsumexp([*more, refined])) - alone, 690.0)))

    def dates(self, atoms: Sequence[Atom], place: int) -> tuple[tuple[FloatArray, FloatArray], float]:
        """Possible dates of a course and the log of the probability of each, (d,) each; log odds of settling.

        A slow course is dated by what settles and by slopes together: which of the two it is, is not known either.
        """
        atom, tried, time = atoms[place], self.series.line.tried, self.series.line.time
        others = [one for i, one in enumerate(atoms) if i != place]
        more = self.series.with_one_more(others) + self.log_prior
        by_kind = {kind: [i for i, one in enumerate(tried) if one.kind == kind] for kind in KINDS}
        chosen = by_kind[SLOPE if atom.kind == SETTLING else atom.kind]
        dates, logs = np.array([tried[i].date for i in chosen]), more[chosen]
        settling = more[by_kind[SETTLING]]
        if atom.kind == SETTLING:  # few dates are tried of these: now all that are near
            near = _around([replace(atom, date=float(date)) for date in time[: len(time) - 2]], atom)
            settling = np.array([self.series.summed([*others, one]) for one in near]) + self._prior_of(atom)
            dates, logs = np.concatenate([dates, [one.date for one in near]]), np.concatenate([logs, settling])
        possible = np.unique(dates)
        together = np.array([float(logsumexp(logs[dates == date])) for date in possible])
        slow = atom.kind in (SLOPE, SETTLING) and settling.size > 0
        odds = float(logsumexp(settling) - logsumexp(more[by_kind[SLOPE]])) if slow else 0.0
        return (possible, together - logsumexp(together)), odds

    def time_constants(self, atoms: Sequence[Atom], place: int) -> tuple[float, float]:
        """Interval with 95 % of a time constant."""
        atom = atoms[place]
        if atom.kind != SETTLING:
            return 0.0, 0.0
        others = [one for i, one in enumerate(atoms) if i != place]
        spread = np.linspace(-1.0, 1.0, 9)
        for _ in range(3):  # narrower about what weighs
            tried = [replace(atom, time_constant=float(atom.time_constant * np.exp(s))) for s in spread]
            logs = np.array([self.series.summed([*others, one]) for one in tried])
            weighing = spread[logs > logs.max() - 8]
            low, high = float(weighing.min()), float(weighing.max())
            step = float(spread[1] - spread[0])
            if high - low > 3 * step:
                break
            spread = np.linspace(low - step, high + step, 9)
        weights = np.exp(logs - logsumexp(logs))
        mean = float(weights @ spread)
        deviation = float(np.sqrt(weights @ (spread - mean) ** 2))
        return tuple(float(atom.time_constant * np.exp(mean + s * 1.96 * deviation)) for s in (-1, 1))  # type: ignore[return-value]


def most_likely(dates: FloatArray, logs: FloatArray, since: FloatArray) -> tuple[float, float]:
    """The interval that holds a date with 95 %, from log probabilities, (d,); the likeliest dates first.

    `since` is of each the beginning of the gap in which it is, or the date.
    """
    weights = np.exp(logs - logsumexp(logs))
    order = np.argsort(-weights)
    held = order[: int(np.searchsorted(np.cumsum(weights[order]), 0.95)) + 1]
    return float(since[held].min()), float(dates[held].max())


def _around(near: list[Atom], atom: Atom) -> list[Atom]:
    """The twenty-five dates nearest to that of a course."""
    return sorted(near, key=lambda one: abs(one.date - atom.date))[:25]
