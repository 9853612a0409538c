"""Errors of recordings, mended of a fault of the recorder or not, over the noise that they were recorded with."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from feeddrive.diagnosis.calibration.known import known_values
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence


def error_over_noise(mended: Problem, problem: Problem) -> float:
    """Squared error per row of mended recordings, beside no effect, over the noise of the recordings as they are."""
    return _over_noise_of(mended, problem).plain_error(())


def contradiction(problem: Problem, found: Fit) -> float:
    """Square by which recordings contradict the tolerances of the declared values beside a set (`Known.least`)."""
    known = known_values(problem, found)
    return 0.0 if known is None else known.least()


def error_within_tolerances(problem: Problem, found: Fit, first: Problem) -> float:
    """Squared error per row of a set beside declared values within their tolerances, over the noise of `first`.

    Left beside any values, and what it costs to have them within their tolerances. Infinite where the plant cannot be
    simulated: of recordings of another machine, declared values may end as a mass that is negative.
    """
    there = _over_noise_of(problem, first).plain
    error, rows = there.plain_error(found.effects), max(len(there.residual(found.effects)), 1)
    if not np.isfinite(error):
        return math.inf
    return error + contradiction(there, fit(there, found.effects, iterations=0)) / rows


def _over_noise_of(problem: Problem, first: Problem) -> Problem:
    """Recordings, mended or not, over the noise that was read of them as they were recorded.

    Two readings of a level differ by some per cent, and sets are told by half of one. A row's noise is what it is
    whatever its time; as much of it as the band takes is in the band, and a torque times a factor has it times that.

    Args:
        problem: of the recordings, with what was found or mended.
        first: of the recordings as they are, nothing being found.
    """
    evidence = []
    for e, other in zip(problem.evidence, first.evidence, strict=True):
        assert isinstance(e, AxisEvidence) and isinstance(other, AxisEvidence)  # no other has a suspect
        taken = e.band.noise_gain / other.band.noise_gain
        noise = {name: its * taken * _factor(other, e, name) for name, its in other.noise.items()}
        evidence.append(replace(e, noise=noise))
    return replace(problem, evidence=tuple(evidence))


def _factor(first: AxisEvidence, mended: AxisEvidence, name: str) -> float:
    """What a channel was multiplied by when it was mended; a drift is in no difference of rows."""
    before, after = (float(np.nanstd(np.diff(one.recording[name]))) for one in (first, mended))
    return after / before if before > 0 and after > 0 else 1.0
