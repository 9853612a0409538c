"""An earlier diagnosis taken up again: its recordings, its effects, and what is other now."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from feeddrive.diagnosis.judging.result import EffectResult, ParameterResult
from feeddrive.diagnosis.ledger.ledger import NAME, FileUse, checksum, runs_of
from feeddrive.effects.base import Effect, Port
from feeddrive.effects.catalogue import THERMAL_EFFECTS, find_effect
from feeddrive.errors import InputError
from feeddrive.units.quantity import format_quantity


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
        effects = tuple(_effect(one) for one in last["values"])
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


def _effect(entry: dict[str, Any]) -> Effect:
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
        values = [_moved(key, old[place]["parameters"].get(key), p) for key, p in one.parameters.items()]
        moved = [value for value in values if value]
        reported.append(f"{place} is confirmed" + (f": {', '.join(moved)}" if moved else ""))
    reported += [f"{place} no longer pays with all recordings" for place in old if place not in new]
    return tuple(reported)


def _place(name: str, parameters: dict[str, Any]) -> str:
    """Name and the words that say where it acts."""
    words = [entry["value"] for entry in parameters.values() if isinstance(entry["value"], str)]
    return f"{name} ({', '.join(words)})" if words else name


def _moved(key: str, before: dict[str, Any] | None, now: ParameterResult) -> str:
    if before is None or not isinstance(now.value, float) or not isinstance(before["value"], float):
        return ""
    return f"{key} {format_quantity(before['value'], now.unit)} → {format_quantity(now.value, now.unit)}"
