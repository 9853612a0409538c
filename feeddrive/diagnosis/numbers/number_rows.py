"""Measured numbers beside recordings: each is one more row of the likelihood, behind those of all recordings.

    r_j = w (y_j - f_j) / s_j,    w = sqrt(λ)

| symbol | meaning | unit |
|---|---|---|
| y_j, s_j | measured number, its standard deviation | SI |
| f_j | what the plant gives | SI |
| λ | variance of a row of a recording that stands for one independent value (`feeddrive.diagnosis.calibration`) | 1 |

A row of a recording is correlated with its neighbours: λ of its squares are worth one. So a number, which is known to
s_j by itself, weighs as λ of them.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from feeddrive.diagnosis.numbers.measured_file import MeasuredNumber
from feeddrive.errors import InputError, ValidityWarning
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray

REMEMBERED = 64
"""Plants whose numbers are kept: slopes and steps come back to the same plant."""


@dataclass(frozen=True, eq=False)
class MeasuredRows:
    """Measured numbers as rows.

    Attributes:
        numbers: that were measured.
        weight: w.
    """

    numbers: tuple[MeasuredNumber, ...] = ()
    weight: float = 1.0
    _known: dict[Any, FloatArray] = field(default_factory=dict, repr=False)

    def __len__(self) -> int:
        """How many rows."""
        return len(self.numbers)

    def with_variance(self, variance: float) -> MeasuredRows:
        """The rows beside recordings of which λ squares are worth one."""
        return replace(self, weight=float(np.sqrt(variance)))

    def given(self, plant: Plant) -> FloatArray:
        """What a plant gives but for what one recording alone has, (n,) SI; NaN where there is no such machine."""
        plant = replace(plant, effects=tuple(e for e in plant.effects if e.name != "recording_shift"))
        key = (
            tuple(plant.chain.values.items()),
            tuple((e.label, e.place, tuple(e.values.items())) for e in plant.effects),
        )
        if key not in self._known:
            with warnings.catch_warnings():
                # values that no part has are tried on the way
                warnings.simplefilter("ignore", ValidityWarning)
                found = np.array([_given(plant, one) for one in self.numbers])
            if len(self._known) >= REMEMBERED:
                self._known.clear()
            self._known[key] = found
        return self._known[key]

    def predicted(self, plant: Plant) -> FloatArray:
        """w f / s of a plant, (n,) [1]."""
        return self.weight * self.given(plant) / self._deviations

    def measured(self) -> FloatArray:
        """w y / s, (n,) [1]."""
        return self.weight * np.array([one.value for one in self.numbers]) / self._deviations

    @property
    def _deviations(self) -> FloatArray:
        return np.array([one.deviation for one in self.numbers])


def refuse_ungiven(rows: MeasuredRows, plant: Plant) -> None:
    """Refuse numbers that the declared plant cannot give.

    Raises:
        InputError: such as a second natural frequency of a plant with one.
    """
    for number in rows.numbers:
        number.kind.of(plant, number.setting)


def _given(plant: Plant, number: MeasuredNumber) -> float:
    try:
        return number.kind.of(plant, number.setting)
    except InputError:
        return float("nan")


@dataclass(frozen=True)
class NumberResult:
    """A measured number beside what the plant gives, before and after.

    Attributes:
        number: as measured.
        before, after: of the declared plant, and of the plant with what was found [SI].
        fitted: whether it was; not where it is likelier to be wrong (`doubted`).
    """

    number: MeasuredNumber
    before: float
    after: float
    fitted: bool = True

    @property
    def met(self) -> bool:
        """Whether the plant after gives it within the number's tolerance, which is two of its standard deviations."""
        return abs(self.after - self.number.value) <= 2 * self.number.deviation

    def record(self) -> dict[str, Any]:
        """Its keys in `diagnosis.json`."""
        one = self.number
        return {
            "name": one.name, "unit": one.kind.unit, "value": one.value, "tolerance": 2 * one.deviation,
            "before": self.before, "after": self.after, "met": self.met, "fitted": self.fitted,
        }  # fmt: skip


def number_results(rows: MeasuredRows, before: Plant, after: Plant, wrong: int = 0) -> tuple[NumberResult, ...]:
    """Every number with what the two plants give for it; so many at the end were wrong and not fitted."""
    fitted = len(rows) - wrong
    pairs = zip(rows.numbers, rows.given(before), rows.given(after), strict=True)
    return tuple(NumberResult(one, float(was), float(now), i < fitted) for i, (one, was, now) in enumerate(pairs))
