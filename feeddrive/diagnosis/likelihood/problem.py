"""What is fitted to what: declared plant and recordings, every channel weighted by its sensor noise.

    r_c = (measured_c - predicted_c) / noise_c      in the band, table position less its mean per recording

Declared values within their tolerances are whitened away, and stepped to where they are likeliest beside a set.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from feeddrive.diagnosis.budget import Budget
from feeddrive.diagnosis.calibration.calibration import Calibration, Whitener, whitener
from feeddrive.diagnosis.calibration.declared import with_values
from feeddrive.diagnosis.finding.remembered import Remembered, effects_key
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.predictor import Predictor
from feeddrive.diagnosis.numbers.number_rows import MeasuredRows
from feeddrive.effects.base import Effect
from feeddrive.plant.passive_friction import is_passive
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray

LEVEL = 0.8
"""Residual over the noise that a channel is stated to have, below which the noise is put right: a level read from
the quietest tenth of the blocks is known to some per cent."""

LONGEST = math.log(2.0)
"""Logarithm of a declared value by which one step moves it at most: a factor of two. What gives way falls as exp(-x)
and slopes tell 1 - x: of a stiffness doubled half is left and 0.31 told, and beyond 2.7 times less than nothing."""

UNEXPLAINED = 1.3
"""Weighted squared error per sample beyond which much is left; noise alone gives one."""

PREDICTIONS = 8_000_000
"""Bytes of predictions that a problem keeps: some twenty of a minute at 2 kHz."""

BENT_AT = 0.1
"""Share of a step at which its bend is read: a hundredth of that of the whole, and still some deviations of the noise
where a step fails."""


@dataclass(frozen=True)
class Problem:
    """Declared plant, recordings, what predicts them, and the declared values that are fitted within their tolerances.

    Attributes:
        plant: as declared.
        evidence: recordings.
        predictor: of their kind.
        calibration: of the declared values; None where all are taken as exact.
        numbers: measured beside the recordings; their rows stand behind those of all recordings.
        tables: name of a law to the tables that the plant carries beside it, for another form than ours.
        budget: of time.
    """

    plant: Plant
    evidence: tuple[Evidence, ...]
    predictor: Predictor[Any]
    calibration: Calibration | None = None
    numbers: MeasuredRows = field(default_factory=MeasuredRows)
    tables: Mapping[str, tuple[Effect, ...]] = field(default_factory=dict)
    budget: Budget = field(default_factory=Budget, compare=False)

    def machine(self, effects: Sequence[Effect] = ()) -> Plant:
        """The plant with its declared values as calibrated, and further effects, laws with their tables."""
        return self._calibrated.with_effects(*effects, *self.tables_of(effects))

    def tables_of(self, effects: Sequence[Effect]) -> tuple[Effect, ...]:
        """The tables that the plant carries beside some effects."""
        names = {effect.name for effect in effects}
        return tuple(table for name, tables in self.tables.items() if name in names for table in tables)

    @cached_property
    def _calibrated(self) -> Plant:
        if self.calibration is None:
            return self.plant
        return with_values(self.plant, self.calibration.values, self.calibration.coordinates)

    @cached_property
    def whitener(self) -> Whitener | None:
        """What takes away the part of a series that declared values within their tolerances may stand for."""
        known = self.calibration
        if known is None or not known.values:
            return None
        count = len(known.values)
        rows = sum(int(e.thinned(e.fit_rows).sum()) * len(e.channels) for e in self.evidence)
        columns = np.empty((rows + len(self.numbers), count))
        columns[rows:] = self.numbers.weight * known.number_slopes if len(self.numbers) else 0.0
        for i in range(count):
            parts = [
                e.weighted({name: known.slopes[e.recording][name][:, i] for name in e.channels}, e.thinned(e.fit_rows))
                for e in self.evidence
            ]
            columns[:rows, i] = np.concatenate(parts)
        return whitener(columns, known.coordinates, known.variance)

    def at_values(self, coordinates: FloatArray, variance: float | None = None) -> Problem:
        """The problem with other coordinates of its declared values, (k,), and another λ; its slopes as they are."""
        known = self.calibration
        assert known is not None
        variance = known.variance if variance is None else variance
        there = replace(self, calibration=replace(known, coordinates=coordinates, variance=variance))
        weighed = self.__dict__.get("whitener")  # where it was asked for: the slopes need not be weighed again
        if weighed is not None:
            there.__dict__["whitener"] = weighed.at(coordinates, variance)
        return there

    def levelled(self, effects: Sequence[Effect] = ()) -> Problem:
        """The problem with no channel's noise above what is left of it: a sensor adds no more than the residual holds.

        The noise is read from fourth differences, which in a stiff loop hold what the drive does as well. It is
        no less than what rounding makes: waves that it may have take away much of what is left, not of what it does.
        """
        evidence = []
        for e, rows in zip(self.evidence, self.by_channel(self.residual(effects)), strict=True):
            left = {name: float(np.mean(one**2)) / e.kept.get(name, 1.0) for name, one in rows.items()}
            level = {name: math.sqrt(one) if 0 < one < LEVEL**2 else 1.0 for name, one in left.items()}
            least = {name: min(e.rounded(name) / noise, 1.0) if noise else 0.0 for name, noise in e.noise.items()}
            level = {name: max(one, least[name]) for name, one in level.items()}
            evidence.append(replace(e, noise={name: noise * level.get(name, 1.0) for name, noise in e.noise.items()}))
        return replace(self, evidence=tuple(evidence))

    def by_channel(self, residual: FloatArray) -> list[dict[str, FloatArray]]:
        """Per recording, channel to its rows of a residual, (rows,) each."""
        found, first = [], 0
        for e in self.evidence:
            count, rows = int(e.thinned(e.fit_rows).sum()), {}
            for name in e.channels:
                rows[name] = residual[first : first + count]
                first += count
            found.append(rows)
        return found

    def balanced(self, effects: Sequence[Effect]) -> Problem:
        """The problem with each channel weighed by what is left of it, beside the channel that is met best.

        A channel whose noise is far below what the model reaches, a current with ripple and structure beside a scale,
        holds an error of the model, whose variance is not known: the most likely one is its mean square, n/2 log r'r in
        place of r'r / 2 σ². Weighed by its noise it would lead everything that the other channel tells astray.

        Args:
            effects: found, with the declared values as they are.
        """
        plain = self.plain
        if len({name for e in self.evidence for name in e.channels}) < 2 or not self.predictor.of_motion:
            return plain
        recordings = plain.by_channel(plain.residual(effects))
        left = {
            name: math.sqrt(float(np.mean(np.concatenate([rows[name] ** 2 for rows in recordings if name in rows]))))
            for name in dict.fromkeys(name for rows in recordings for name in rows)
        }
        if not all(np.isfinite(one) for one in left.values()):
            return self
        least = max(1.0, min(left.values()))
        used = self.evidence[0].left
        if all(LEVEL < left[name] / least / used.get(name, 1.0) < 1 / LEVEL for name in left):
            return self  # as it is weighed, but for a few
        return self.weighed({name: one / least for name, one in left.items() if one * LEVEL > least})

    @cached_property
    def noise_square(self) -> float:
        """What the noise alone is expected to leave of the squared residual, each channel weighed as it is."""
        parts = [
            e.kept.get(name, 1.0) * float(e.thinned(e.fit_rows).sum()) / e.left.get(name, 1.0) ** 2
            for e in self.evidence
            for name in e.channels
        ]
        return sum(parts) + len(self.numbers)

    def weighed(self, left: dict[str, float]) -> Problem:
        """The problem with other factors on the noise of channels."""
        if all(e.left == left for e in self.evidence):
            return self
        return replace(self, evidence=tuple(replace(e, left=left) for e in self.evidence))

    @property
    def plain(self) -> Problem:
        """The problem with every channel weighed by its noise."""
        return self.weighed({})

    def plain_error(self, effects: Sequence[Effect]) -> float:
        """Weighted squared error per row, every channel weighed by its noise."""
        residual = self.plain.residual(effects)
        return float(residual @ residual) / max(len(residual), 1)

    def plain_squares(self, effects: Sequence[Effect]) -> list[dict[str, float]]:
        """Per recording, channel to the mean square of its error over its noise, the declared values as they are.

        A channel of which nothing is fitted is left out.
        """
        recordings = self.by_channel(self.plain.unwhitened(effects))
        return [{c: float(np.mean(rows**2)) for c, rows in one.items() if len(rows)} for one in recordings]

    def unwhitened(self, effects: Sequence[Effect]) -> FloatArray:
        """Measured less predicted over the noise at the fitted samples of all recordings."""
        plant, parts = self.machine(effects), []
        for e in self.evidence:
            predicted = self.predictor.predict(plant, e)
            rows = e.thinned(e.fit_rows)
            parts.append(e.weighted(e.measured, rows) - e.weighted(predicted, rows))
        if len(self.numbers):
            parts.append(self.numbers.measured() - self._numbers(effects))
        return np.concatenate(parts)

    def _numbers(self, effects: Sequence[Effect]) -> FloatArray:
        """The rows of the measured numbers."""
        return self.numbers.predicted(self.machine(effects))

    def predicted(self, effects: Sequence[Effect]) -> FloatArray:
        """Weighted prediction at the fitted samples of all recordings, whitened; to be read only."""
        return self._predictions.found(None, effects_key(effects), lambda: self._predicted(effects))

    @cached_property
    def _predictions(self) -> Remembered[FloatArray]:
        """The latest predictions: every candidate of a round asks for the set at hand again."""
        return Remembered(lambda rows: rows.nbytes, PREDICTIONS)

    def _predicted(self, effects: Sequence[Effect]) -> FloatArray:
        plant = self.machine(effects)
        rows = np.concatenate(
            [e.weighted(self.predictor.predict(plant, e), e.thinned(e.fit_rows)) for e in self.evidence]
            + ([self._numbers(effects)] if len(self.numbers) else [])
        )
        known = self.whitener
        found = rows if known is None else known.applied(rows - known.offset)
        found.flags.writeable = False
        return found

    def possible(self, effects: Sequence[Effect]) -> bool:
        """Whether the plant with these effects is one that a file may hold: its friction takes power everywhere."""
        plant = self.machine(effects)
        return not self.predictor.of_motion or is_passive(plant)

    @cached_property
    def measured(self) -> FloatArray:
        """Weighted measurement at the fitted samples of all recordings, whitened."""
        rows = np.concatenate(
            [e.weighted(e.measured, e.thinned(e.fit_rows)) for e in self.evidence]
            + ([self.numbers.measured()] if len(self.numbers) else [])
        )
        return rows if self.whitener is None else self.whitener.applied(rows)

    def residual(self, effects: Sequence[Effect]) -> FloatArray:
        """Weighted residual at the fitted samples of all recordings, whitened."""
        return self.measured - self.predicted(effects)

    def settled(self, effects: Sequence[Effect]) -> Problem:
        """The problem with its declared values as they are most likely with these effects."""
        return self if self.whitener is None else self.stepped(effects, self.unwhitened(effects))

    def stepped(self, effects: Sequence[Effect], residual: FloatArray) -> Problem:
        """The problem at the most likely declared values, or as far towards them as the error falls.

        No value goes beyond the factor that it may have, and the straight step moves none by more than `LONGEST`. Where
        it takes less than half of what its slopes promise, what its tenth bends the prediction by is fitted as well,
        and the values go along c + s d + s^2 a: values that stand in for each other, an inertia, a mass and a torque
        constant, lie in a narrow valley, straight for some of them in the values and for others in their logarithms.
        Source: Transtrum and Sethna, arXiv:1201.5885 (2012), section 3.

        Args:
            effects: beside them.
            residual: not whitened, with the values as they are, (m,).
        """
        known, slopes = self.calibration, self.whitener
        if known is None or slopes is None or not np.all(np.isfinite(residual)):
            return self
        longest = LONGEST / np.array([value.deviation for value in known.values])
        farthest = np.array([value.farthest for value in known.values])
        low = np.maximum(known.coordinates - longest, -farthest)
        high = np.minimum(known.coordinates + longest, farthest)
        step = slopes.most_likely(residual, low, high) - known.coordinates
        possible = self.possible(effects)

        def at(share: float, bend: FloatArray) -> tuple[float, Problem, FloatArray]:
            coordinates = np.clip(known.coordinates + share * step + share**2 * bend, -farthest, farthest)
            there = self.at_values(coordinates)
            if possible and not there.possible(effects):  # friction that an effect takes more than all of
                return math.inf, there, residual
            left = there.unwhitened(effects)
            cost = float(left @ left) + known.variance * float(coordinates @ coordinates)
            return cost if math.isfinite(cost) else math.inf, there, left

        straight = np.zeros(len(step))
        before = float(residual @ residual) + known.variance * float(known.coordinates @ known.coordinates)
        promised = residual - slopes.columns @ step
        least = float(promised @ promised) + known.variance * float(np.sum((known.coordinates + step) ** 2))
        whole, there, _ = at(1.0, straight)
        if before - whole >= 0.5 * (before - least):
            return there
        best, other, left = at(BENT_AT, straight)
        if not math.isfinite(best):
            return there if whole < before else self
        best, there = min((whole, there), (best, other), key=lambda one: one[0])
        bent = (left - residual) / BENT_AT**2 + slopes.columns @ step / BENT_AT
        bend = slopes.most_likely(bent - slopes.offset)
        for share in (1.0, 0.5, 0.25):
            cost, other, _ = at(share, bend)
            if cost > best and best < before:
                break
            if cost < best:
                best, there = cost, other
        return there if best < before else self
