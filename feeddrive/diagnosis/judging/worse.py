"""A channel that is predicted worse than declared: which, by how much, and declared values that make none so."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.diagnosis.calibration.calibrate import weighed_by_rest, with_kept
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.judging.judge import Judged, error_series, judged_channels
from feeddrive.diagnosis.likelihood.cross_validation import SCATTER, worse_beyond_scatter
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.recordings.recordings import is_shift
from feeddrive.typing import FloatArray, IntegerArray


def not_worse_than_declared(
    found: Search, judged: list[Judged], judge: Callable[[Search], list[Judged]]
) -> tuple[Search, list[Judged]]:
    """The search with declared values that leave no channel worse than declared, where names are not what does it.

    What no name explains in one channel pulls the declared values, and another channel pays for it. They are fitted
    anew with every channel weighed by what is left of it; where that is worse than declared still, they stay declared.
    Where no name stands beside them, nothing but they can have made a channel worse: where all channels together are
    worse, it is granted the scatter of its own rms alone.

    Args:
        found: what was found.
        judged: recordings with it in.
        judge: judges another search.
    """
    known, alone = found.problem.calibration, not found.fit.effects

    def is_worse(problem: Problem, judged: Sequence[Judged]) -> bool:
        return bool(worst_channel(problem, judged)) or (alone and _all_worse(problem, judged))

    if known is None or not known.values or not is_worse(found.problem, judged):
        return found, judged
    if any(is_shift(effect) for effect in found.fit.effects):
        return found, judged  # what one recording has otherwise is told of as a change
    for problem in (
        weighed_by_rest(found.problem, found.fit.effects),
        with_kept(found.problem, [False] * len(known.values)),
    ):
        other = replace(found, problem=problem, fit=fit(problem, found.fit.effects))
        again = judge(other)
        if not is_worse(problem, again):
            return other, again
    return found, judged


def worst_channel(problem: Problem, judged: Sequence[Judged]) -> str:
    """The channel that is worse than declared by the most, beyond its scatter; empty where none is."""
    worse = {name: worse_by(problem, judged, name) for name in _telling(problem, judged)}
    name = max(worse, key=lambda one: worse[one], default="")
    return name if name and worse[name] > 0 else ""


def _telling(problem: Problem, judged: Sequence[Judged]) -> list[str]:
    """Channels that tell a better plant from a worse: not those of which no more is left than coarse steps make.

    Rounding holds over every passage of a motion: which of two plants it favours is chance, as large as it is itself.
    """
    told = []
    for name in judged_channels(judged):
        parts = [one.evidence for one in judged if name in one.evidence.channels]
        left = float(np.mean(_errors(problem, judged, name).after ** 2))
        if left > np.mean([e.rounded(name) ** 2 for e in parts]):
            told.append(name)
    return told


def _all_worse(problem: Problem, judged: Sequence[Judged]) -> bool:
    """Whether a channel is worse than declared beyond the scatter of its own rms, and all together are too."""
    pairs = [_errors(problem, judged, name) for name in _telling(problem, judged)]
    squares = [(float(one.before @ one.before), float(one.after @ one.after)) for one in pairs]
    worse = any(
        after > before * (1 + SCATTER * np.sqrt(2 / max(one.values, 1.0)))
        for (before, after), one in zip(squares, pairs, strict=True)
    )
    return worse and np.prod([before for before, _ in squares]) <= np.prod([after for _, after in squares])


@dataclass(frozen=True)
class _Errors:
    """Errors of a channel at the judged rows, (m,), as declared and with what was found.

    blocks: block of every row, (m,).
    values: independent values that the rows hold, 2 B T of T seconds in a band B.
    """

    before: FloatArray
    after: FloatArray
    blocks: IntegerArray
    values: float


def worse_by(problem: Problem, judged: Sequence[Judged], name: str, than_after: bool = False) -> float:
    """Share by which a channel's squared error as declared is smaller, beyond its scatter; negative where it is not.

    than_after: the other way round, by how much that with what was found is smaller.
    """
    errors = _errors(problem, judged, name)
    pair = (errors.after, errors.before) if than_after else (errors.before, errors.after)
    return worse_beyond_scatter(*pair, errors.blocks, errors.values)


def _errors(problem: Problem, judged: Sequence[Judged], name: str) -> _Errors:
    before, after, blocks, count, values = [], [], [], 0, 0.0
    for one in judged:
        if name not in one.evidence.channels:
            continue
        rows = one.evidence.judged_rows
        step = one.evidence.recording.sample_time
        numbers = (np.flatnonzero(rows) * step / one.evidence.block).astype(np.int64)
        before.append(error_series(problem, one.before, one.evidence)[name][rows])
        after.append(error_series(problem, one.after, one.evidence)[name][rows])
        blocks.append(count + numbers)
        count += int(numbers.max(initial=-1)) + 1
        values += 2 * one.evidence.edge * float(rows.sum()) * step
    return _Errors(np.concatenate(before), np.concatenate(after), np.concatenate(blocks), values)
