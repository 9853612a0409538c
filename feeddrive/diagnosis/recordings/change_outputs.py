"""The part of `diagnosis.json` about differences between recordings: `changes`, `per_recording`, `shared`."""

from __future__ import annotations

from typing import Any

from feeddrive.diagnosis.recordings.change_result import Measure, ParameterChange, PerRecording, RecordingChanges


def changes_record(changes: RecordingChanges) -> dict[str, Any]:
    """Keys of `diagnosis.json`; `changes` is empty where nothing differs, or where there is one recording."""
    return {
        "changes": [_change(one) for one in changes.changes],
        "per_recording": [_per_recording(one) for one in changes.per_recording],
        "shared": list(changes.shared),
        "changes_tried": [
            {
                "effect": one.effect,
                "parameter": one.parameter,
                "port": one.port,
                "of": "judged recordings" if one.judged else "fitted recordings",
                "gain": one.gain,
                "standard_error": one.standard_error,
                "taken": one.taken,
                "reason": one.reason,
            }
            for one in changes.trials
        ],
        "changes_explain": dict(changes.explains or {}),
    }


def _change(one: ParameterChange) -> dict[str, Any]:
    return {
        "effect": one.effect,
        "parameter": one.parameter,
        "port": one.port,
        "recording": one.recording,
        "unit": one.unit,
        **_measure(one.here),
        "against": one.against,
        "against_value": one.there.value,
        "against_ci95": list(one.there.ci95),
        "difference": one.difference.value,
        "difference_ci95": list(one.difference.ci95),
        "statement": one.statement,
        "reading": one.reading,
        "fitted": one.fitted,
    }


def _per_recording(one: PerRecording) -> dict[str, Any]:
    return {
        "effect": one.effect,
        "parameter": one.parameter,
        "port": one.port,
        "unit": one.unit,
        "values": [{"recording": name, **_measure(value)} for name, value in one.values.items()],
    }


def _measure(one: Measure) -> dict[str, Any]:
    return {"value": one.value, "ci95": list(one.ci95)}
