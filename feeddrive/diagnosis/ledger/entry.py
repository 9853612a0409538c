"""From a search to what the ledger keeps of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from feeddrive.diagnosis.certainty.correlation import value_labels
from feeddrive.diagnosis.certainty.uncertainty import Certainty
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.ledger.ledger_result import Kept
from feeddrive.diagnosis.likelihood.coordinates import value_slopes
from feeddrive.diagnosis.likelihood.cross_validation import SIGNIFICANCE, Comparison
from feeddrive.diagnosis.recordings.recordings import RecordingShift, without_shifts
from feeddrive.effects.base import Effect
from feeddrive.units.quantity import percent


def kept_of(found: Search, known: Certainty) -> Kept:
    """All trials of a search, and the covariance of the values that it ended with."""
    tried = []
    for number, attempts in enumerate(found.rounds, start=1):
        taken = next((trial.name for trial in found.trials if trial.round == number and trial.taken), "")
        for attempt in attempts:
            effect, comparison = attempt.fit.effects[-1], attempt.comparison
            is_taken = attempt.name in taken.split(" with ")
            reason = _reason(comparison, is_taken, taken)
            if is_taken and attempt.name in found.reasons:
                reason = f"taken, and refused in the end: {found.reasons[attempt.name]}"
            tried.append({
                "round": number, "effect": attempt.name, "port": str(effect.port), "place": effect.place,
                "values": dict(effect.values), "gain": comparison.gain, "standard_error": comparison.standard_error,
                "least": comparison.least, "taken": is_taken, "reason": reason,
            })  # fmt: skip
    return Kept(tuple(tried), _covariance(found, known))


def _reason(comparison: Comparison, taken: bool, winner: str) -> str:
    if taken:
        return "taken: it lowers the error on blocks left out the most, or as much as the best with fewer parameters"
    if comparison.gain <= 0:
        return "refused: it does not lower the error on blocks left out"
    if comparison.gain <= comparison.least:
        gain, least = percent(comparison.gain, 2), percent(comparison.least, 2)
        return f"refused: a gain of {gain} is less than the {least} asked for"
    if not comparison.pays:
        return f"refused: its gain is less than {SIGNIFICANCE:g} times its scatter, or than what luck brings"
    if not winner:
        return "refused: too small to matter on this machine"
    return f"waits: {winner} does better in this round"


def _covariance(found: Search, known: Certainty) -> dict[str, Any]:
    effects = found.fit.effects
    if not effects:
        return {"values": [], "matrix": []}
    moves = value_slopes(effects, found.problem.plant, found.fit.coordinates)
    matrix = moves @ known.covariance @ moves.T
    kept = np.flatnonzero(np.diag(matrix) > 0)
    labels = _labels(effects)
    return {"values": [labels[i] for i in kept], "matrix": matrix[np.ix_(kept, kept)].tolist()}


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
