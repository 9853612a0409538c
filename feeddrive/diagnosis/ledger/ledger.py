"""The ledger of a diagnosis: every run with its files, what was tried, what was kept and why; runs are only added.

ledger.json
{ "format": "feeddrive-ledger/1", "runs": [ { "run": 1, "continues": null, "plant": {...}, "fit": [...],
  "validate": [...], "split": 0.75, "measured": null, "channels": [...], "tried": [...], "effects": [...],
  "refused": [...], "values": [...], "covariance": {...}, "changes": [...], "since": [...] } ] }
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from feeddrive import __version__
from feeddrive.diagnosis.judging.result import Diagnosis, EffectResult, ParameterResult
from feeddrive.diagnosis.likelihood.outputs import diagnosis_record
from feeddrive.diagnosis.recordings.change_candidates import LEAST_CHANGE
from feeddrive.diagnosis.recordings.change_words import from_to
from feeddrive.effects.base import Effect, Port
from feeddrive.effects.catalogue import THERMAL_EFFECTS, find_effect
from feeddrive.errors import InputError
from feeddrive.files import write_text_atomically

FORMAT = "feeddrive-ledger/1"
NAME = "ledger.json"

COPIED = ("channels", "effects", "refused", "ambiguous", "rehomed", "changes", "per_recording", "shared",
          "changes_tried", "notes")  # fmt: skip
"""Keys of `diagnosis.json` that a run of the ledger keeps as they are."""


@dataclass(frozen=True)
class FileUse:
    """A recording file with what is needed to read it again.

    Attributes:
        path: absolute.
        sha256: of its content.
        mapping: mapping file that it was read with, absolute; None where there was none.
        decimal: decimal sign that it was read with; None where the file tells.
    """

    path: Path
    sha256: str
    mapping: Path | None = None
    decimal: str | None = None


@dataclass(frozen=True)
class RunFiles:
    """Files and options of one run."""

    plant: FileUse
    fit: tuple[FileUse, ...]
    validate: tuple[FileUse, ...]
    split: float
    continues: int | None = None
    measured: FileUse | None = None


def checksum(path: Path) -> str:
    """SHA-256 of a file.

    Raises:
        InputError: it cannot be read.
    """
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", str(path), "put it back, or diagnose anew") from None


def runs_of(folder: Path) -> list[dict[str, Any]]:
    """The runs that the ledger of a folder holds; none where there is no ledger.

    Raises:
        InputError: a file of that name that is no ledger.
    """
    path = folder / NAME
    if not path.exists():
        return []
    mend = "move it away, or give another folder by --out"
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        raise InputError("the ledger cannot be read", str(path), mend) from None
    if not isinstance(record, dict) or record.get("format") != FORMAT or not _are_runs(record.get("runs")):
        raise InputError(f"not a ledger of format {FORMAT}", str(path), mend)
    runs: list[dict[str, Any]] = record["runs"]
    return runs


def _are_runs(runs: Any) -> bool:
    return isinstance(runs, list) and all(isinstance(run, dict) for run in runs)


def write_ledger(folder: Path, runs: Sequence[dict[str, Any]], result: Diagnosis, effects: Sequence[Effect],
                 files: RunFiles) -> None:  # fmt: skip
    """Write the ledger with one more run, at once or not at all.

    Args:
        folder: of the diagnosis, with the other files of the new run.
        runs: that were before.
        result: of the new run.
        effects: of the machine as it was in the last recording.
        files: of the new run.
    """
    written = [path.name for path in folder.iterdir()]
    record = {"format": FORMAT, "runs": [*runs, _run(len(runs) + 1, result, effects, files, written)]}
    text = json.dumps(record, indent=1, ensure_ascii=False, allow_nan=False)
    write_text_atomically(folder / NAME, text + "\n")


def written_earlier(runs: Sequence[dict[str, Any]]) -> tuple[str, ...]:
    """Names of the files that the last run has written into the folder of its ledger."""
    names = runs[-1].get("written", []) if runs else []
    return tuple(name for name in names if isinstance(name, str)) if isinstance(names, list) else ()


def _run(
    number: int, result: Diagnosis, effects: Sequence[Effect], files: RunFiles, written: Sequence[str]
) -> dict[str, Any]:
    record = diagnosis_record(result)
    return {
        "run": number,
        "continues": files.continues,
        "version": __version__,
        "plant": {"name": result.plant, "path": str(files.plant.path), "sha256": files.plant.sha256},
        "fit": [_file(one) for one in files.fit],
        "validate": [_file(one) for one in files.validate],
        "split": files.split,
        "measured": None if files.measured is None else _file(files.measured),
        **{key: record[key] for key in COPIED},
        "tried": [_plain(one) for one in result.kept.tried],
        "values": [_effect(effect) for effect in effects],
        "covariance": result.kept.covariance,
        "since": list(result.kept.since),
        "written": sorted([NAME, *written]),
    }  # fmt: skip


def _file(one: FileUse) -> dict[str, Any]:
    mapping = None if one.mapping is None else str(one.mapping)
    return {"path": str(one.path), "sha256": one.sha256, "mapping": mapping, "decimal": one.decimal}


def _effect(effect: Effect) -> dict[str, Any]:
    return {"name": effect.name, "port": str(effect.port), "place": effect.place, "values": _plain(effect.values)}


def _plain(values: Any) -> dict[str, Any]:
    """Values as JSON has them: tables as lists, numbers that are none as null."""
    return {key: _number(value) for key, value in dict(values).items()}


def _number(value: Any) -> Any:
    if isinstance(value, dict):
        return _plain(value)
    if isinstance(value, list | tuple):
        return [_number(one) for one in value]
    return None if isinstance(value, float) and not abs(value) < float("inf") else value


@dataclass(frozen=True)
class Earlier:
    """The last run of a ledger.

    Attributes:
        runs: all runs as they stand in the file.
        plant: file of the declared plant.
        fit: recordings that were fitted.
        validate: recordings that were judged.
        split: share that was fitted where there were none.
        effects: found, with their values.
        reported: effects as they were reported, name to parameters.
        measured: file of the numbers that were measured beside the recordings; None where there was none.
    """

    runs: list[dict[str, Any]]
    plant: Path
    fit: tuple[FileUse, ...]
    validate: tuple[FileUse, ...]
    split: float
    effects: tuple[Effect, ...]
    reported: tuple[dict[str, Any], ...]
    measured: FileUse | None = None


def earlier_run(folder: Path) -> Earlier:
    """The last run in the ledger of a folder, its files checked against their checksums.

    Raises:
        InputError: no ledger, a ledger that cannot be read, or a file that is missing or not what it was.
    """
    runs = runs_of(folder)
    if not runs:
        raise InputError(f"no {NAME} to continue", str(folder), "name the folder of an earlier diagnosis")
    last = runs[-1]
    try:
        plant = Path(last["plant"]["path"])
        _unchanged(FileUse(plant, last["plant"]["sha256"]))
        fit, validate = (tuple(_use(one) for one in last[key]) for key in ("fit", "validate"))
        effects = tuple(_effect_of(one) for one in last["values"])
        numbers = last.get("measured")  # a ledger of an earlier version has no such entry
        measured = None if numbers is None else _use(numbers)
        result = Earlier(runs, plant, fit, validate, float(last["split"]), effects, tuple(last["effects"]), measured)
    except (KeyError, TypeError, AttributeError, OverflowError, ValueError) as error:
        if isinstance(error, InputError) and error.where != "":
            raise
        raise InputError(f"run {len(runs)} lacks entries", str(folder / NAME), "diagnose anew") from None
    for one in (*result.fit, *result.validate, *([measured] if measured is not None else [])):
        _unchanged(one)
    return result


def _use(entry: dict[str, Any]) -> FileUse:
    mapping = entry["mapping"]
    return FileUse(Path(entry["path"]), entry["sha256"], None if mapping is None else Path(mapping), entry["decimal"])


def _unchanged(use: FileUse) -> None:
    if not use.path.is_file():
        raise InputError("a file of the earlier diagnosis is missing", str(use.path), "put it back, or diagnose anew")
    if checksum(use.path) != use.sha256:
        what = "the file is not what it was when it was diagnosed"
        raise InputError(what, str(use.path), "put the old one back, or diagnose anew without --continue")


def _effect_of(entry: dict[str, Any]) -> Effect:
    name = entry["name"]
    kind = THERMAL_EFFECTS[name] if name in THERMAL_EFFECTS else find_effect(name, NAME)
    values = {key: tuple(value) if isinstance(value, list) else value for key, value in entry["values"].items()}
    known = {parameter.key for parameter in kind.parameters}
    return kind.of(Port(entry["port"]), entry["place"], **{k: v for k, v in values.items() if k in known})


def changed_since(before: Sequence[dict[str, Any]], now: Sequence[EffectResult]) -> tuple[str, ...]:
    """What the new run says otherwise than the one before, in sentences.

    Args:
        before: effects as the ledger reported them.
        now: effects found.
    """
    reported = []
    old = {_place(one["name"], one["parameters"]): one for one in before}
    new = {_place(one.name, {k: {"value": p.value} for k, p in one.parameters.items()}): one for one in now}
    for place, one in new.items():
        if place not in old:
            reported.append(f"{place} is new")
            continue
        pairs = [(key, old[place]["parameters"].get(key), now) for key, now in one.parameters.items()]
        other = [_moved(*pair) for pair in pairs if _is_other(*pair[1:])]
        moved = [text for text in (_moved(*pair) for pair in pairs) if text]
        said, values = ("is another one", other) if other else ("is confirmed", moved)
        reported.append(f"{place} {said}{': ' if values else ''}{', '.join(values)}")
    reported += [f"{place} no longer pays with all recordings" for place in old if place not in new]
    return tuple(reported)


def _place(name: str, parameters: dict[str, Any]) -> str:
    """Name and the words that say where it acts."""
    words = [entry["value"] for entry in parameters.values() if isinstance(entry["value"], str)]
    return f"{name} ({', '.join(words)})" if words else name


def _moved(key: str, before: dict[str, Any] | None, now: ParameterResult) -> str:
    if before is None or not isinstance(now.value, float) or not isinstance(before["value"], float):
        return ""
    return f"{key} {from_to(before['value'], now.value, now.unit)}"


def _is_other(before: dict[str, Any] | None, now: ParameterResult) -> bool:
    """Whether a value is clearly another than before: intervals apart, by as much as counts as a change."""
    if before is None or not isinstance(now.value, float) or not isinstance(before["value"], float):
        return False
    if now.unit == "rad":  # counted from an encoder's zero, whole turns apart alike
        return False
    first, last = float(before["value"]), now.value
    earlier, span = before.get("ci95") or (first, first), now.ci95 or (last, last)
    if not isinstance(span[0], float) or not isinstance(span[1], float):
        return False
    apart = max(earlier[0], span[0]) > min(earlier[1], span[1])
    return bool(apart and abs(last - first) >= LEAST_CHANGE * max(abs(first), abs(last)))
