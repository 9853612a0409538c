"""The files of a diagnosis: `diagnosis.json`, `prediction.csv`, `plant_after.toml`."""

from __future__ import annotations

import io
import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from feeddrive import __version__
from feeddrive.diagnosis.calibration.calibrated_result import calibrated_record
from feeddrive.diagnosis.judging.result import ChannelResult, Diagnosis, EffectResult, ErrorFigures, ParameterResult
from feeddrive.diagnosis.plant_text import with_calibrated_values
from feeddrive.diagnosis.suspicion.quality import is_recorders, quality_record
from feeddrive.effects.base import Effect
from feeddrive.files import write_text_atomically
from feeddrive.plant.file.lumped_text import plant_text_with_effects

FORMAT = "feeddrive-diagnosis/1"


def write_outputs(diagnosis: Diagnosis, effects: Sequence[Effect], plant_text: str, folder: Path) -> None:
    """Write the three files of the contract, each at once or not at all.

    Args:
        diagnosis: what was found.
        effects: found, with their values.
        plant_text: text of the declared plant's file.
        folder: made if missing.
    """
    folder.mkdir(parents=True, exist_ok=True)
    tables = [one.remark for left in diagnosis.unexplained.values() for one in left.carried]
    # what only changed between recordings comes last, and is no finding of its own
    count = len(effects) - len(diagnosis.effects) - len(tables)
    changed = ["as in the last recording; see changes in diagnosis.json"] * count
    remarks = [*(result.evidence for result in diagnosis.effects), *changed, *tables]
    own = [(one, remark) for one, remark in zip(effects, remarks, strict=True) if not is_recorders(one)]
    calibrated = with_calibrated_values(plant_text, diagnosis.calibrated)
    mended = plant_text_with_effects(calibrated, [one for one, _ in own], [remark for _, remark in own])
    write_text_atomically(folder / "plant_after.toml", mended)
    write_text_atomically(folder / "prediction.csv", prediction_table(diagnosis))
    write_text_atomically(folder / "diagnosis.json", diagnosis_json(diagnosis))


def diagnosis_json(diagnosis: Diagnosis) -> str:
    """The text of `diagnosis.json`."""
    return json.dumps(diagnosis_record(diagnosis), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def diagnosis_record(diagnosis: Diagnosis) -> dict[str, Any]:
    """The content of `diagnosis.json`."""
    record: dict[str, Any] = {
        "format": FORMAT,
        "version": __version__,
        "plant": diagnosis.plant,
        "fit": [{"file": stamp.file, "sha256": stamp.sha256} for stamp in diagnosis.fit],
        "validate": [{"file": stamp.file, "sha256": stamp.sha256} for stamp in diagnosis.validate],
        "channels": [_channel(channel) for channel in diagnosis.channels],
        "effects": [_effect(effect) for effect in diagnosis.effects],
        "calibrated": calibrated_record(diagnosis.calibrated),
        "possible": [
            {"name": one.name, "odds": one.odds, "instead_of": one.instead_of, "settles": one.settles}
            for one in diagnosis.possible
        ],
        "measured": [one.record() for one in diagnosis.measured],
        "quality": quality_record(diagnosis.quality),
        "refused": [{"name": refused.name, "reason": refused.reason} for refused in diagnosis.refused],
        "ambiguous": [list(names) for names in diagnosis.ambiguous],
        "ambiguous_reasons": [
            {"names": list(one.names), "distance_sigma": list(one.distances), "reason": one.reason}
            for one in diagnosis.alike
        ],
        "rehomed": list(diagnosis.rehomed),
        "recorded_stroke": None if diagnosis.recorded_stroke is None else list(diagnosis.recorded_stroke),
        "next_experiment": [
            {
                "question": list(one.question),
                "scenario": one.scenario,
                "kind": "interval" if len(one.question) == 1 else "distance_sigma",
                "figure": one.figure,
                "sentence": one.sentence,
                "ranking": [{"scenario": name, "figure": value} for name, value in one.ranking],
            }
            for one in diagnosis.next_experiments
        ],
        **diagnosis.changes.record(),
        "unexplained": {name: left.record() for name, left in diagnosis.unexplained.items()},
        "notes": list(diagnosis.notes),
        "plant_after": "plant_after.toml",
    }
    if diagnosis.simulation is not None:
        record["simulation"] = diagnosis.simulation.record()
    if diagnosis.correlation is not None:
        known = diagnosis.correlation
        condition = known.condition if math.isfinite(known.condition) else None
        record["correlation"] = {
            "parameters": list(known.names),
            "matrix": [list(row) for row in known.matrix],
            "condition": condition,
            "known_only_together": list(known.remarks),
        }
    return record


def _channel(channel: ChannelResult) -> dict[str, Any]:
    return {
        "name": channel.name,
        "unit": channel.unit,
        "band_hz": list(channel.band_hz),
        "noise_rms": channel.noise_rms,
        "before": _figures(channel.before),
        "after": _figures(channel.after),
    }


def _figures(figures: ErrorFigures) -> dict[str, float]:
    return {"rms": figures.rms, "max": figures.max, "relative": figures.relative}


def _effect(effect: EffectResult) -> dict[str, Any]:
    return {
        "name": effect.name,
        "parameters": {key: _parameter(parameter) for key, parameter in effect.parameters.items()},
        "explains": effect.explains,
        "carries": bool(effect.carries),
        "evidence": effect.evidence,
        "reading": effect.reading,
        "odds": effect.odds,
    }


def _parameter(parameter: ParameterResult) -> dict[str, Any]:
    result: dict[str, Any] = {"value": parameter.value, "unit": parameter.unit}
    if parameter.ci95 is not None:
        result["ci95"] = [list(span) if isinstance(span, tuple) else span for span in parameter.ci95]
    return result


def prediction_table(diagnosis: Diagnosis) -> str:
    """The text of `prediction.csv`: the band-limited series of the judged data; left-out cells are empty."""
    first = diagnosis.recordings[0]
    heads = ["time [s]"]
    for series in first.channels:
        heads += [f"{series.name} {kind} [{series.unit}]" for kind in ("measured", "before", "after")]
    several = len(diagnosis.recordings) > 1
    text = io.StringIO()
    text.write(",".join(heads + (["recording"] if several else [])) + "\n")
    for recording in diagnosis.recordings:
        columns = [column for s in recording.channels for column in (s.measured, s.before, s.after)]
        tail = f",{recording.name}" if several else ""
        line = "%.6f" + ",%.10g" * len(columns)
        rows = [line % tuple(row) for row in np.column_stack([recording.time, *columns]).tolist()]
        text.write("".join(f"{row.replace('nan', '')}{tail}\n" for row in rows))
    return text.getvalue()
