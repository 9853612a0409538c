"""From a search to what the ledger keeps of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from feeddrive.diagnosis.certainty.correlation import value_labels
from feeddrive.diagnosis.certainty.uncertainty import Certainty
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.ledger.ledger_result import Covariance, Kept, Tried
from feeddrive.diagnosis.likelihood.coordinates import value_slopes
from feeddrive.diagnosis.likelihood.cross_validation import SIGNIFICANCE, Comparison
from feeddrive.diagnosis.recordings.recordings import RecordingShift, without_shifts
from feeddrive.effects.base import Effect


def kept_of(found: Search, known: Certainty) -> Kept:
    """All trials of a search, and the covariance of the values that it ended with."""
    return Kept(_tried(found), _covariance(found, known))


def _tried(found: Search) -> tuple[Tried, ...]:
    result = []
    for number, attempts in enumerate(found.rounds, start=1):
        taken = next((trial.name for trial in found.trials if trial.round == number and trial.taken), "")
        for attempt in attempts:
            effect, comparison = attempt.fit.effects[-1], attempt.comparison
            is_taken = attempt.name in taken.split(" with ")
            reason = _reason(comparison, is_taken, taken)
            if is_taken and attempt.name in found.impossible:
                reason = f"taken, and refused in the end: {found.impossible[attempt.name]}"
            result.append(
                Tried(
                    number, attempt.name, str(effect.port), effect.place, dict(effect.values), comparison.gain,
                    comparison.standard_error, comparison.least, is_taken, reason,
                )
            )  # fmt: skip
    return tuple(result)


def _reason(comparison: Comparison, taken: bool, winner: str) -> str:
    if taken:
        return "taken: it lowers the error on blocks left out the most, or as much as the best with fewer parameters"
    if comparison.gain <= 0:
        return "refused: it does not lower the error on blocks left out"
    if comparison.gain <= comparison.least:
        return f"refused: a gain of {comparison.gain:.2%} is less than the {comparison.least:.2%} asked for"
    if not comparison.pays:
        return f"refused: its gain is less than {SIGNIFICANCE:g} times its scatter, or than what luck brings"
    if not winner:
        return "refused: too small to matter on this machine"
    return f"waits: {winner} does better in this round"


def _covariance(found: Search, known: Certainty) -> Covariance:
    effects = found.fit.effects
    if not effects:
        return Covariance()
    moves = value_slopes(effects, found.problem.plant, found.fit.coordinates)
    matrix = moves @ known.covariance @ moves.T
    kept = np.flatnonzero(np.diag(matrix) > 0)
    labels = _labels(effects)
    rows = matrix[np.ix_(kept, kept)]
    return Covariance(tuple(labels[i] for i in kept), tuple(map(tuple, rows.tolist())))


def _labels(effects: Sequence[Effect]) -> list[str]:
    """Names of all numbers; a shift is named by what it moves and the recording, in fit coordinates."""
    labels = value_labels(without_shifts(effects))
    for effect in effects:
        if isinstance(effect, RecordingShift):
            target = effect.target
            values = effect.values["shift"]
            many = len(values) if isinstance(values, tuple) else 1
            where = f"{target.name}@{target.port}#{target.coordinate}"
            labels += [f"{where} in recording {effect.recording + 1}, shift[{i}]" for i in range(many)]
    return labels
