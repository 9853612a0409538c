"""The stroke of the fitted recordings, and judged recordings that go beyond it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from feeddrive.diagnosis.judging.judge import Judged
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity, percent

POSITION = "table_position"

NEAR = 0.1
"""Share of the fitted stroke beyond its ends that still counts as there: a law changes little over it."""


def fitted_stroke(evidence: Sequence[Evidence], radius: float) -> tuple[float, float] | None:
    """Least and greatest table position at the fitted samples [m]; None where none was recorded.

    Args:
        evidence: fitted recordings.
        radius: travel over the motor's angle [m/rad], for recordings without a table position.
    """
    found: list[FloatArray] = []
    for e in evidence:
        if POSITION in e.recording:
            found.append(e.recording[POSITION][e.fit_rows])
        elif "motor_angle" in e.recording:
            found.append(radius * e.recording["motor_angle"][e.fit_rows])
    known = np.concatenate(found) if found else np.empty(0)
    return (float(np.nanmin(known)), float(np.nanmax(known))) if len(known) else None


def beyond_fitted_stroke(evidence: Sequence[Evidence], judged: Sequence[Judged]) -> tuple[str, ...]:
    """A sentence per judged recording that goes where no fitted one went; none where not all have a table position."""
    stroke = fitted_stroke(evidence, 0.0)
    if stroke is None or any(POSITION not in one.recording for one in (*evidence, *(j.evidence for j in judged))):
        return ()
    low, high = stroke
    said = []
    for one in judged:
        place = one.evidence.recording[POSITION][one.evidence.judged_rows]
        away = np.count_nonzero((place < low - NEAR * (high - low)) | (place > high + NEAR * (high - low)))
        share = away / max(len(place), 1)
        if round(100 * share):
            said.append(
                f"{one.evidence.recording.name}: {percent(share)} of its rows lie beyond the stroke that was "
                f"fitted ({format_quantity(low, 'm')} to {format_quantity(high, 'm')}); what depends on the place is a "
                "guess there: fit a recording of the whole stroke"
            )
    return tuple(said)
