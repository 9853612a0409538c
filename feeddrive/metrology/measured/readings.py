"""A table of readings: columns `name [unit]` and lines `# key = value` above them.

    # radius = 150 mm
    angle [deg],radial [µm],direction [1]

Column names are free of meaning here; `forms` says which of them make which test.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from feeddrive.errors import InputError, quoted
from feeddrive.metrology.measured.laser_file import is_laser_file, laser_columns
from feeddrive.recording.files.csv_file import Layout, find_table
from feeddrive.recording.files.opening import decode, first_bytes, head_of, open_file
from feeddrive.recording.files.text_blocks import TextFile
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import parse, unit_conversion

_HEADING = re.compile(r"(?P<name>[^\[\]()]*?)\s*(?:[\[(](?P<unit>[^\[\]()]*)[\])])?")
_REMARK = re.compile(r"#\s*(?P<key>[A-Za-z_ ]+?)\s*=\s*(?P<value>[^,;\t]+)")


_SIDES = {"up": "up", "forward": "up", "fwd": "up", "vor": "up", "vorwärts": "up", "+": "up", "↑": "up",
          "down": "down", "backward": "down", "reverse": "down", "rev": "down", "bwd": "down", "zurück": "down",
          "rückwärts": "down", "-": "down", "↓": "down"}  # fmt: skip
_RUN = re.compile(
    r"(?:(?:run|lauf) ?)?(?P<before>\d*) ?(?P<side>"
    + "|".join(map(re.escape, sorted(_SIDES, key=len, reverse=True)))
    + r") ?(?P<behind>\d*)"
)
_SPELLINGS = {
    "nominal": "target", "nominal position": "target", "target position": "target", "soll": "target",
    "sollposition": "target", "zielposition": "target", "actual position": "position", "measured position": "position",
    "istposition": "position", "error": "deviation", "abweichung": "deviation", "deviation error": "deviation",
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
            raise InputError(f'column "{name}" has no unit', self.where, f'write "{name} [{unit}]" in the header')
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
    table = find_table(source.blocks(), Layout(), where).numbers(decimal)
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
