"""What a diagnosis tells of the declared values that it fitted within their tolerances."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from feeddrive.diagnosis.calibration.calibrate import calibrated_list
from feeddrive.diagnosis.likelihood.fit import Fit, Problem

TOLD = 0.9
"""Deviation of a value over that of its tolerance, above which the recordings say nothing of it: it is not listed."""


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
