"""Judged recordings that go beyond the fitted stroke are told with the share of their rows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from feeddrive.diagnosis.judging.fitted_stroke import beyond_fitted_stroke, fitted_stroke
from feeddrive.diagnosis.judging.judge import Judged
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.preparing import prepare
from tests.recovery.planted import axis_plant, pair


def at_places(places: list[float], share: float) -> AxisEvidence:
    """The bench's recording with its table at some places, one after the other for as long each."""
    plant, recording = axis_plant("bench"), pair("bench", "null")[0]
    evidence = prepare(recording, plant, share)
    rows = np.flatnonzero(evidence.fit_rows if share else evidence.judged_rows)
    position = recording["table_position"].copy()
    for place, some in zip(places, np.array_split(rows, len(places)), strict=True):
        position[some] = place
    moved = replace(recording, channels={**recording.channels, "table_position": position})
    return replace(evidence, recording=moved)


def test_the_share_of_the_rows_beyond_is_told() -> None:
    plant, fitted = axis_plant("bench"), at_places([0.2, 0.4], 1.0)
    assert fitted_stroke([fitted], 0.0) == (0.2, 0.4)
    there = Judged(at_places([0.1, 0.3, 0.3, 0.55], 0.0), plant, plant)
    (said,) = beyond_fitted_stroke([fitted], [there])
    assert "50 % of its rows lie beyond the stroke that was fitted (200 mm to 400 mm)" in said


def test_the_same_stroke_is_no_word() -> None:
    """A tenth of the stroke beyond its ends is as good as in it."""
    plant, fitted = axis_plant("bench"), at_places([0.2, 0.4], 1.0)
    there = Judged(at_places([0.185, 0.3, 0.415], 0.0), plant, plant)
    assert beyond_fitted_stroke([fitted], [there]) == ()


def test_a_recording_of_which_no_row_is_judged_is_no_word() -> None:
    plant, fitted = axis_plant("bench"), at_places([0.2, 0.4], 1.0)
    there = at_places([0.7], 0.0)
    nothing = replace(there, counted=np.zeros_like(there.counted))
    assert not nothing.judged_rows.any()
    assert beyond_fitted_stroke([fitted], [Judged(nothing, plant, plant)]) == ()
