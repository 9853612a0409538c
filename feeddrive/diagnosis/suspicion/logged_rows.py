"""A torque written more slowly than the rows: each value repeated until the next.

    T_recorded(t_i) = T(t_k),   k = first + m floor((i - first) / m)

The drive may hold it so long, or the recorder may read it only so often. What a drive holds acts on the machine as
recorded; what a recorder holds does not, and what was predicted is read and repeated in the same way before both are
compared. Neither is known beforehand: the declared machine is asked which one it follows.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.band import white_noise
from feeddrive.diagnosis.suspicion.quality import Quality
from feeddrive.typing import FloatArray

MOST_ROWS = 200
"""Rows that a value is repeated for at most."""

FEWEST_VALUES = 100
"""Values that tell the rhythm: by chance 100 changes fall on every second row once in 10^30."""


def rhythm(samples: FloatArray) -> tuple[int, int] | None:
    """Rows that a value stands for, and the first row of one; None where values change at any row, (n,)."""
    changes = np.flatnonzero(np.diff(samples)) + 1
    if len(changes) < FEWEST_VALUES:
        return None
    every = int(np.gcd.reduce(np.diff(changes)))
    if not 2 <= every <= MOST_ROWS or len(changes) * every < len(samples) / 2:
        return None
    return every, int(changes[0]) % every


def with_recorder_that_holds(
    problem: Problem, judged: Sequence[Evidence]
) -> tuple[Problem, list[Evidence], tuple[Quality, ...]]:
    """The recordings with the torque read as the recorder writes it, where the declared machine follows it better so.

    Args:
        problem: the recordings that are fitted, and the plant as declared.
        judged: recordings to judge on, some of them the fitted ones.
    """
    known = {e: _as_written(e) for e in dict.fromkeys((*problem.evidence, *judged))}
    held = replace(problem, evidence=tuple(known[e] for e in problem.evidence))
    if all(a is b for a, b in zip(held.evidence, problem.evidence, strict=True)):
        return problem, list(judged), ()
    # with one noise for both, so that they are compared with one weight
    pairs = zip(problem.evidence, held.evidence, strict=True)
    as_recorded = replace(problem, evidence=tuple(replace(one, noise=other.noise) for one, other in pairs))
    before, after = (float(np.sum(one.unwhitened(()) ** 2)) for one in (as_recorded, held))
    if not after < before:
        return problem, list(judged), ()
    written = [e for e in known.values() if isinstance(e, AxisEvidence)]
    remarks = tuple(_quality(e, e.torque_rows[0], 1 - after / before) for e in written if e.torque_rows is not None)
    return held, [known[e] for e in judged], remarks


def _as_written(evidence: Evidence) -> Evidence:
    name = "motor_torque"
    if not isinstance(evidence, AxisEvidence) or name not in evidence.channels or evidence.scaled_from:
        return evidence
    raw = evidence.recording[name]
    found = rhythm(raw)
    if found is None:
        return evidence
    every, first = found
    seconds = every * evidence.recording.sample_time
    # repeated, a value's noise lies below half the rate of the values: all of it in the band where that is wider
    noise = white_noise(raw[first::every], 1 / seconds) * min(1.0, math.sqrt(2 * evidence.edge * seconds))
    measured = {**evidence.measured, name: evidence.band.filter(raw)}
    return replace(evidence, measured=measured, noise={**evidence.noise, name: noise}, torque_rows=found)


def _quality(evidence: Evidence, rows: int, explains: float) -> Quality:
    seconds, name = rows * evidence.recording.sample_time, evidence.recording.name
    what = f"{name}: the torque is written every {1e3 * seconds:.3g} ms, {rows} rows, and repeated between"
    mend = "let the recorder read it at every row; it is compared as it is written"
    return Quality("channel_hold", "motor_torque", seconds, "s", what, mend, explains=explains, mended=True)
