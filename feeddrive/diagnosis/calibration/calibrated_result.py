"""What a diagnosis tells of the declared values that it fitted within their tolerances."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from feeddrive.diagnosis.calibration.calibrate import calibrated_list
from feeddrive.diagnosis.calibration.known import known_values
from feeddrive.diagnosis.likelihood.fit import Fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.effects.chain.stiffness_deviation import PARTS
from feeddrive.plant.analysis.stiffness_budget import participation
from feeddrive.units.quantity import percent

TOLD = 0.9
"""Deviation of a value over that of its tolerance, above which the recordings say nothing of it: it is not listed."""

HALVED = math.sqrt(0.75)
"""Correlation of two values from which to know one would halve the deviation of the other."""


@dataclass(frozen=True)
class CalibratedResult:
    """A declared value that was fitted within its tolerance; no finding.

    Attributes:
        key: value of the chain, friction of a port, or torque_constant.
        words: what it is.
        unit: SI unit; 1 for a factor on all that is declared.
        declared, value: [unit].
        ci95: 95 % interval [unit].
        tolerance: share of the declared value.
        written: where it stands in a plant file: dotted key, unit and declared value [SI] of each.
    """

    key: str
    words: str
    unit: str
    declared: float
    value: float
    ci95: tuple[float, float]
    tolerance: float
    written: tuple[tuple[str, str, float], ...] = ()

    @property
    def is_beyond(self) -> bool:
        """Whether the whole interval lies beyond the tolerance, a factor of one plus it either way."""
        low, high = (end / self.declared for end in self.ci95)
        return low > 1 + self.tolerance or high < 1 / (1 + self.tolerance)


def calibrated_results(problem: Problem, found: Fit) -> tuple[CalibratedResult, ...]:
    """The declared values of which the recordings say more than their tolerance."""
    return tuple(
        CalibratedResult(
            one.value.key, one.value.words, one.value.unit, one.value.declared, one.number, one.ci95,
            one.value.tolerance, one.value.written,
        )
        for one in calibrated_list(problem, found)
        if one.deviation < TOLD
    )  # fmt: skip


def known_together(problem: Problem, found: Fit) -> tuple[str, ...]:
    """A sentence for every two stiffnesses of which the sum is known better than either, with what each gives way."""
    known, plant = known_values(problem, found), problem.plant
    if known is None:
        return ()
    deviations = np.sqrt(np.diag(known.covariance))
    alike = known.covariance / np.outer(deviations, deviations) < -HALVED
    remarks = []
    for i, first in enumerate(known.values):
        for j in range(i + 1, len(known.values)):
            second, keys = known.values[j], (first.key, known.values[j].key)
            if alike[i, j] and deviations[[i, j]].min() < TOLD and set(keys) <= set(PARTS.values()):
                shares = [percent(participation(plant, key, plant.middle)) for key in keys]
                remarks.append(
                    f"{first.words} and {second.words}: these recordings tell what both give way together much better "
                    f"than either; of the compliance at the table they have {shares[0]} and {shares[1]} in mid-stroke"
                )
    return tuple(remarks)


def calibrated_record(results: tuple[CalibratedResult, ...]) -> list[dict[str, Any]]:
    """The list `calibrated` of `diagnosis.json`."""
    return [
        {
            "key": one.key,
            "words": one.words,
            "unit": one.unit,
            "declared": one.declared,
            "value": one.value,
            "ci95": list(one.ci95),
            "tolerance": one.tolerance,
        }
        for one in results
    ]
