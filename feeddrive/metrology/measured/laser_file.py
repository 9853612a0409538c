"""Linear test of a Renishaw laser system, `.rtl`: sections of text, deviations in rows of run, target, deviation.

    TARGET DATA::   Target-count: 5    Targets : 0.0 100.0 ...    Flags: ...
    RUNS::          Run-count: 4
    DEVIATIONS::    Run Target Data:   1 1 0.00, 1 2 -0.35, ...   ENVIRONMENT::

Targets are in mm and deviations in µm. Targets of a run that come in falling order were approached from above; the file
has no other sign of it. Layout from readers and a writer of such files in public repositories, no manual.
"""

from __future__ import annotations

import re

import numpy as np

from feeddrive.errors import InputError
from feeddrive.typing import FloatArray

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
