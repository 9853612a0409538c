"""The folder of a sweep: what it is, and the units that are finished, each written whole or not at all.

    sweep.json        digest of the sweep, and how its runs are cut into units
    units/0000.json   what a unit gives (`simulate.sweep_unit`)

Units are cut once, by the time that the first run takes, and stay so when a sweep is resumed.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from feeddrive.errors import InputError
from feeddrive.files import write_text_atomically
from feeddrive.output_folder import refuse_unusable
from feeddrive.simulate.sweep.sweep_design import Design
from feeddrive.simulate.sweep.sweep_unit import UNIT_FORMAT, is_list_of_runs

SWEEP_FORMAT = "feeddrive-sweep/1"
_PLAN = "sweep.json"


@dataclass(frozen=True)
class Cut:
    """How runs are cut into units: unit 0 is the first run alone.

    Attributes:
        runs: of the sweep.
        size: runs of each other unit; the last may have fewer.
    """

    runs: int
    size: int

    @property
    def units(self) -> int:
        """How many there are."""
        return 1 + -(-(self.runs - 1) // self.size)

    def span(self, unit: int) -> tuple[int, int]:
        """First run of a unit, and the one behind its last."""
        if unit == 0:
            return 0, 1
        start = 1 + (unit - 1) * self.size
        return start, min(self.runs, start + self.size)


def unit_path(folder: Path, unit: int) -> Path:
    """File of a unit."""
    return folder / "units" / f"{unit:04d}.json"


def write_cut(folder: Path, design: Design, cut: Cut) -> None:
    """Begin a sweep's folder.

    Raises:
        InputError: it cannot be written.
    """
    content = {
        "format": SWEEP_FORMAT,
        "digest": design.digest,
        "scenario": str(design.path),
        "runs": cut.runs,
        "unit_size": cut.size,
    }
    write_text_atomically(folder / _PLAN, json.dumps(content, indent=2) + "\n")


def read_cut(folder: Path, design: Design) -> Cut | None:
    """How a sweep that was begun in this folder is cut; None where none was begun.

    Raises:
        InputError: the folder is a file, or holds another sweep or something unreadable.
    """
    path = folder / _PLAN
    refuse_unusable(folder)
    if not path.exists():
        return None
    content = _json(path)
    runs, size, digest = content.get("runs"), content.get("unit_size"), content.get("digest")
    known = all(isinstance(count, int) and count > 0 for count in (runs, size))
    if not known or content.get("format") != SWEEP_FORMAT:
        raise InputError("is not the beginning of a sweep", str(path), "name another folder for --out")
    cut = Cut(content["runs"], content["unit_size"])
    if digest != design.digest or cut.runs != len(design.rows):
        what = "holds another sweep: scenario, plant, values or program differ"
        raise InputError(what, str(folder), "name another folder for --out, or remove this one")
    return cut


def read_units(folder: Path, design: Design, cut: Cut) -> dict[int, list[dict[str, Any]]]:
    """The runs of the finished units, by unit.

    Raises:
        InputError: a unit that is not one of this sweep.
    """
    found = {}
    for unit in range(cut.units):
        path = unit_path(folder, unit)
        if not path.exists():
            continue
        content, (first, end) = _json(path), cut.span(unit)
        runs = content.get("runs") if content.get("format") == UNIT_FORMAT else None
        if content.get("digest") != design.digest or not is_list_of_runs(runs, range(first, end)):
            raise InputError("is not a unit of this sweep", str(path), "remove it; its runs are then done again")
        found[unit] = runs or []
    return found


def _json(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, OSError, RecursionError):
        content = None
    if not isinstance(content, dict):
        raise InputError("cannot be read", str(path), "remove it; its runs are then done again")
    return content
