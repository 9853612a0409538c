"""Encoder zeros: where a new recording counts its angle from another zero, position-locked effects are shifted with it.

Phases refer to the recorded angle and curves to the recorded position; after a machine was homed again both count from
elsewhere. The shift is found on the first 15 % of the recording, by the error there, and errors are taken on the rest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize_scalar

from feeddrive.diagnosis.judging.judge import judged_residual, shifted
from feeddrive.diagnosis.likelihood.cross_validation import compare_left_out
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.effects.base import Effect
from feeddrive.plant.plant import Plant

FIRST_SHARE = 0.15
"""Share of the recording on which the shift is found."""

WORTH = 0.1
"""Share of the squared error on that part that a shift must take away."""

SCAN = 48
"""Shifts tried over one revolution."""


@dataclass(frozen=True)
class Rehomed:
    """A recording with its effects shifted [rad of the motor], the first part no longer judged."""

    plant: Plant
    shift: float
    evidence: Evidence
    statement: str


def rehomed_plant(problem: Problem, effects: Sequence[Effect], evidence: Evidence) -> Rehomed | None:
    """The plant with its periodic effects shifted to the recording's zero, or None where nothing is to be shifted.

    Only whole recordings that were not fitted are looked at; the last part of a fitted one has the same zero.
    """
    locked = [effect for effect in effects if "phase" in effect.values]
    if not locked or evidence.fitted.any():
        return None
    first = replace(evidence, counted=evidence.counted & _first_part(evidence))
    if first.judged_rows.sum() < 2 / evidence.recording.sample_time:
        return None
    base, blocks = judged_residual(problem, [(problem.machine(effects), first)])

    def error(shift: float) -> float:
        plant = problem.machine(shifted(effects, shift))
        residual, _ = judged_residual(problem, [(plant, first)])
        return float(residual @ residual)

    grid = np.linspace(-np.pi, np.pi, SCAN, endpoint=False)
    best = float(min(grid, key=error))
    width = 2 * np.pi / SCAN
    found = minimize_scalar(error, bounds=(best - width, best + width), method="bounded", options={"maxiter": 12})
    plant = problem.machine(shifted(effects, float(found.x)))
    gain = compare_left_out(base, judged_residual(problem, [(plant, first)])[0], blocks, WORTH)
    if not gain.pays:
        return None
    rest = replace(evidence, counted=evidence.counted & ~_first_part(evidence))
    names = ", ".join(sorted({effect.name for effect in locked}))
    statement = (
        f"{names} shifted by {np.degrees(found.x):.1f} degrees of the motor on the first 15 %; judged on the rest"
    )
    return Rehomed(plant, float(found.x), rest, statement)


def _first_part(evidence: Evidence) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    n = len(evidence.recording)
    return np.arange(n) < FIRST_SHARE * n
