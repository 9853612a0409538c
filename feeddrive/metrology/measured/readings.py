"""A table of readings: columns `name [unit]` and lines `# key = value` above them.

    # radius = 150 mm
    angle [deg],radial [µm],direction [1]

Column names are free of meaning here; `forms` says which of them make which test.

Linear test of a Renishaw laser system, `.rtl`: sections of text, deviations in rows of run, target, deviation.

    TARGET DATA::   Target-count: 5    Targets : 0.0 100.0 ...    Flags: ...
    RUNS::          Run-count: 4
    DEVIATIONS::    Run Target Data:   1 1 0.00, 1 2 -0.35, ...   ENVIRONMENT::

Targets are in mm and deviations in µm. Targets of a run that come in falling order were approached from above; the file
has no other sign of it. Layout from readers and a writer of such files in public repositories, no manual.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from feeddrive.errors import InputError, quoted
from feeddrive.recording.files.cells import with_numbers
from feeddrive.recording.files.csv_file import Layout, find_table, is_number
from feeddrive.recording.files.opening import TextFile, decode, first_bytes, head_of, open_file
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import parse, unit_conversion

_NUMBER = r"[+-]?\d+(?:[.,]\d*)?(?:[eE][+-]?\d+)?"
_TARGETS = re.compile(r"Targets\s*:(.*?)(?:Flags\s*:|[A-Z-]+::|\Z)", re.DOTALL)
_ROWS = re.compile(r"Run\s+Target\s+Data\s*:(.*?)(?:[A-Z][A-Z -]*::|\Z)", re.DOTALL)
_MEND = "export the test again from the laser's program, or type it as a table: docs/iso230.md"


def is_laser_file(head: str) -> bool:
    """Tell by its first letters whether a text is such a file."""
    return "TARGET DATA::" in head and "HEADER::" in head


def laser_columns(text: str, where: str) -> dict[str, tuple[str, FloatArray]]:
    """Columns target, run, direction and deviation with their units, (rows,) each.

    Raises:
        InputError: a section is missing, a test of angles, or rows that do not fit the targets.
    """
    kind = re.search(r"File\s*type\s*:\s*(\S+)", text, re.IGNORECASE)
    if kind is not None and kind[1].upper() not in ("LINEAR", "LIN", "RTL"):
        raise InputError(f"is a test of {kind[1].lower()[:20]}, not of positions", where, "name a linear test")
    found = _TARGETS.search(text), _ROWS.search(text)
    if found[0] is None or found[1] is None:
        raise InputError("the targets or the deviations are missing", where, _MEND)
    targets = np.array([float(one.replace(",", ".")) for one in re.findall(_NUMBER, found[0][1])])
    count = re.search(r"Target-count\s*:\s*(\d+)", text)
    if count is not None and int(count[1]) != targets.size:
        raise InputError(f"{targets.size} targets, {count[1]} are declared", where, _MEND)
    rows: list[tuple[int, int, float]] = []
    for number, line in enumerate(found[1][1].strip().split("\n"), start=1):
        cells = line.split()
        if not cells:
            continue
        if len(cells) != 3 or not all(re.fullmatch(_NUMBER, cell) for cell in cells):
            raise InputError("a row is not run, target, deviation", f"{where}, deviation {number}", _MEND)
        run, target = (float(cell.replace(",", ".")) for cell in cells[:2])
        if not (1 <= target <= targets.size and target.is_integer() and run.is_integer()):
            raise InputError(f"there is no target {cells[1]}", f"{where}, deviation {number}", _MEND)
        rows.append((int(run), int(target) - 1, float(cells[2].replace(",", "."))))
    if not rows:
        raise InputError("the file holds no deviation", where, _MEND)
    runs, at, deviation = (np.array(column) for column in zip(*rows, strict=True))
    side = np.ones(len(rows))
    for run in np.unique(runs):
        places = targets[at[runs == run]]
        falls = places[-1] < places[0]
        if np.any(np.diff(places) * (-1 if falls else 1) <= 0):
            raise InputError(f"the targets of run {run} come in no order", where, _MEND)
        side[runs == run] = -1.0 if falls else 1.0
    return {
        "target": ("mm", targets[at]),
        "run": ("", runs.astype(np.float64)),
        "direction": ("", side),
        "deviation": ("µm", deviation.astype(np.float64)),
    }


_HEADING = re.compile(r"(?P<name>[^\[\]()]*?)\s*(?:[\[(](?P<unit>[^\[\]()]*)[\])])?")
_REMARK = re.compile(r"#\s*(?P<key>[A-Za-z_ ]+?)\s*=\s*(?P<value>[^,;\t]+)")


_SIDES = {"up": "up", "forward": "up", "fwd": "up", "vor": "up", "vorwärts": "up", "+": "up", "↑": "up",
          "down": "down", "backward": "down", "reverse": "down", "rev": "down", "bwd": "down", "zurück": "down",
          "rückwärts": "down", "-": "down", "↓": "down", "ccw": "up", "cw": "down", "avanti": "up", "indietro": "down",
          "正向": "up", "反向": "down"}  # fmt: skip
_RUN = re.compile(
    r"(?:(?:run|lauf) ?)?(?P<before>\d*) ?(?P<side>"
    + "|".join(map(re.escape, sorted(_SIDES, key=len, reverse=True)))
    + r") ?(?P<behind>\d*)"
)
_SPELLINGS = {
    "nominal": "target", "nominal position": "target", "target position": "target", "soll": "target",
    "sollposition": "target", "zielposition": "target", "actual position": "position", "measured position": "position",
    "istposition": "position", "error": "deviation", "abweichung": "deviation", "deviation error": "deviation",
    "posizione": "target", "posizione nominale": "target", "quota": "target", "scostamento": "deviation",
    "errore": "deviation", "direzione": "direction", "目标位置": "target", "偏差": "deviation", "方向": "direction",
    "richtung": "direction", "lauf": "run", "zeit": "time", "winkel": "angle", "radius deviation": "radial",
}  # fmt: skip
"""Words of lasers' programs and of people for the names that `forms` knows."""


@dataclass(frozen=True, eq=False)
class Readings:
    """A table of readings as it was written.

    Attributes:
        where: file, for messages.
        columns: name in lower case, single blanks for `_`, to unit as written and numbers, (n,).
        remarks: what lines `# key = value` say, keys in lower case.
        sha256: of the file.
    """

    where: str
    columns: Mapping[str, tuple[str, FloatArray]]
    remarks: Mapping[str, str]
    sha256: str

    def __contains__(self, name: str) -> bool:
        return name in self.columns

    def si(self, name: str, unit: str) -> FloatArray:
        """A column in SI, (n,).

        Raises:
            InputError: no such column, no unit, or one of another dimension.
        """
        if name not in self.columns:
            held = ", ".join(map(quoted, self.columns))
            raise InputError(f'no column "{name}"', self.where, f"it has {held}")
        written, values = self.columns[name]
        if not written and unit != "1":
            usual = {"m": "mm" if name in ("target", "position", "x", "y", "radius") else "µm", "rad": "deg"}.get(
                unit, unit
            )
            raise InputError(f'column "{name}" has no unit', self.where, f'write "{name} [{usual}]" in the header')
        return unit_conversion(written or "1", unit, f'{self.where}, column "{name}"').apply(values)

    def remark(self, key: str, unit: str) -> float | None:
        """The quantity of a line `# key = value` in SI; None where there is none.

        Raises:
            InputError: it is no such quantity.
        """
        written = self.remarks.get(key)
        return None if written is None else parse(written, unit, f"{self.where}, # {key}")


def read_readings(path: Path, decimal: str | None = None) -> Readings:
    """Read a table of readings.

    Raises:
        InputError: the file cannot be read as a table of numbers; a heading comes twice; a number is not finite.
    """
    where = str(path)
    head = head_of(first_bytes(path))
    if is_laser_file(head):
        content = open_file(path)
        return Readings(where, laser_columns(decode(content)[0], where), {}, content.sha256)
    remarks = _remarks(head)
    source = TextFile(path)
    text_table = find_table(source.blocks(), Layout(), where)
    for column, heading in enumerate(text_table.names):
        if plain_name(re.sub(r"\s*[\[(].*", "", heading)) == "direction":
            text_table = with_numbers(text_table, column, _side)
    table = text_table.numbers(decimal)
    columns: dict[str, tuple[str, FloatArray]] = {}
    for heading, values in zip(table.names, table.columns, strict=True):
        match = _HEADING.fullmatch(heading.strip())
        name = "" if match is None else plain_name(match["name"])
        if match is None or not name:
            raise InputError(f'"{heading}" is not a column heading', where, 'write "name [unit]", e.g. "target [mm]"')
        if name in columns:
            raise InputError(f'two columns "{name}"', where, "keep one of them, or number them: up 1, up 2")
        if not np.isfinite(values).all():
            row = table.first_row + int(np.flatnonzero(~np.isfinite(values))[0])
            raise InputError("a reading is not finite", f'{where}, row {row}, column "{name}"', "leave the row away")
        columns[name] = ((match["unit"] or "").strip(), values)
    return Readings(where, columns, remarks, source.sha256)


def _side(cell: str, place: str) -> str:
    """Return a direction as a number, also where it is a word."""
    word = _SIDES.get(cell.lower())
    if word is None and not is_number(cell.replace(",", ".")):
        mend = "write 1 or up from below, -1 or down from above; of a circle 1 counter-clockwise, -1 clockwise"
        raise InputError(f'"{quoted(cell, 40)}" is no direction', place, mend)
    return cell if word is None else {"up": "1", "down": "-1"}[word]


def plain_name(written: str) -> str:
    """A column's name in lower case, `_` and blanks alike."""
    name = " ".join(written.lower().replace("_", " ").split())
    run = _RUN.fullmatch(name)
    if run is not None and (run["before"] or run["behind"]):
        return f"{_SIDES[run['side']]} {run['before'] or run['behind']}"
    return _SPELLINGS.get(name, name)


def _remarks(head: str) -> dict[str, str]:
    found: dict[str, str] = {}
    for line in head.split("\n"):
        if line.strip() and not line.lstrip().startswith("#"):
            break
        for match in _REMARK.finditer(line):
            found.setdefault(plain_name(match["key"]), match["value"].strip())
    return found
