"""What a sweep gives: one row per run, its values, what came of it, its metrics; as CSV and as JSON.

Varied values stand in the unit in which they were asked for, metrics in SI. An empty cell is a number that did not come
about: of a run that failed, or a time that is never reached.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from feeddrive import __version__
from feeddrive.simulate.sweep.sweep_design import Design
from feeddrive.simulate.sweep.sweep_store import SWEEP_FORMAT
from feeddrive.simulate.sweep.sweep_values import Parameter, Value


@dataclass(frozen=True)
class SweepRow:
    """One run.

    Attributes:
        values: one per parameter, in its unit.
        reason: why it failed; empty if it did not.
        warnings: what left the range of its formula.
        metrics: name to SI value; None where there is none.
    """

    values: tuple[Value, ...]
    reason: str
    warnings: tuple[str, ...]
    metrics: Mapping[str, float | None]


@dataclass(frozen=True)
class SweepTable:
    """All runs.

    Attributes:
        parameters: that were varied.
        units: metric to SI unit, in the order of the columns.
        rows: in the order of the runs.
    """

    parameters: tuple[Parameter, ...]
    units: Mapping[str, str]
    rows: tuple[SweepRow, ...]

    @property
    def finished(self) -> list[SweepRow]:
        """Runs that did not fail."""
        return [row for row in self.rows if not row.reason]


_MAIN_OF_EACH = 2
_SAME = 1e-3
"""Share of its size by which a metric must vary to be worth a look."""

_WHOLE_RUN = ("following_error.maximum", "motor_torque.maximum")


def main_metrics(table: SweepTable, most: int) -> list[str]:
    """What to look at first: two numbers of each figure that the scenario asks for, then those of the whole run.

    Metrics that are the same for all runs are left out.
    """
    taken: dict[str, int] = {}
    found = []
    whole = tuple(name.partition(".")[0] + "." for name in _WHOLE_RUN)
    for name in (*(name for name in table.units if not name.startswith(whole)), *_WHOLE_RUN):
        stem = name.partition(".")[0]
        if taken.get(stem, 0) >= _MAIN_OF_EACH or not _varies([row.metrics.get(name) for row in table.finished]):
            continue
        taken[stem] = taken.get(stem, 0) + 1
        found.append(name)
    return found[:most] or [_WHOLE_RUN[0]]


def _varies(values: Sequence[float | None]) -> bool:
    known = [value for value in values if value is not None]
    if not known or len(known) < len(values):
        return bool(known)
    return max(known) - min(known) > _SAME * max(abs(value) for value in known)


def table_of(design: Design, runs: Sequence[Mapping[str, Any]]) -> SweepTable:
    """The table of the runs of all units, in order (see `simulate.sweep_unit`)."""
    units: dict[str, str] = {}
    rows = []
    for values, run in zip(design.rows, runs, strict=True):
        units |= {name: unit for name, (_, unit) in run["metrics"].items()}
        metrics = {name: value for name, (value, _) in run["metrics"].items()}
        rows.append(SweepRow(values, run["reason"], tuple(run["warnings"]), metrics))
    return SweepTable(design.parameters, units, tuple(rows))


def as_csv(table: SweepTable) -> str:
    """The table as CSV; names with their unit in brackets."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    varied = [f"{one.key} [{one.unit}]" if one.unit else one.key for one in table.parameters]
    writer.writerow(["run", *varied, "status", "remark", *(f"{name} [{unit}]" for name, unit in table.units.items())])
    for number, row in enumerate(table.rows, 1):
        remark = row.reason or "; ".join(row.warnings)
        status = "failed" if row.reason else "finished"
        cells = (row.metrics.get(name) for name in table.units)
        writer.writerow([number, *row.values, status, remark, *("" if cell is None else repr(cell) for cell in cells)])
    return buffer.getvalue()


def as_json(design: Design, table: SweepTable) -> dict[str, Any]:
    """Everything as plain values; no time of day and no duration, so that the same sweep gives the same text."""
    return {
        "format": SWEEP_FORMAT,
        "version": __version__,
        "scenario": str(design.path),
        "settings": dict(design.settings),
        "digest": design.digest,
        "parameters": [{"key": one.key, "unit": one.unit, "random": one.random} for one in table.parameters],
        "metrics": dict(table.units),
        "runs": [
            {
                "run": number,
                "values": {one.key: value for one, value in zip(table.parameters, row.values, strict=True)},
                "failed": row.reason or None,
                "warnings": list(row.warnings),
                "metrics": dict(row.metrics),
            }
            for number, row in enumerate(table.rows, 1)
        ],
    }


def as_text(content: Mapping[str, Any]) -> str:
    """JSON of plain values."""
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
