"""The part of docs/recovery.md about machines described by their parts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from tests.recovery.fleet.table import wilson
from tests.recovery.parts.cases import MACHINES, NULLS, PUBLISHED, WHAT
from tests.recovery.parts.run import FLOOR, Row

BEGIN, END = "<!-- parts -->", "<!-- end of parts -->"

PLANTED = {
    "nothing": "nothing", "nut": "nut -20 %", "bearing": "near bearing -30 %", "drive": "coupling -25 %",
    "payload": "payload", "backlash": "free play", "bump": "friction bump", "lead": "periodic lead error",
    "stribeck": "Stribeck",
}  # fmt: skip

UNITS = {"mass": (1.0, "kg"), "width": (1e6, "µm"), "amplitude": (1e6, "µm"), "peak": (1.0, "N"), "centre": (1e3, "mm"),
         "half_width": (1e3, "mm"), "delta_force": (1.0, "N"), "velocity": (1e3, "mm/s"), "order": (1.0, ""),
         "phase": (1.0, "rad"), "factor": (1.0, "")}  # fmt: skip

INTRODUCTION = (
    "The shipped machines of parts are recorded by 60 finite elements of the screw",
    "(`tests/generator/screw_elements.py`), 9 s to fit and 7 s to judge, and diagnosed with their parts file alone.",
    "`make recovery-parts` goes on where it was stopped. A part that is softer than declared by no more than its",
    "tolerance is right where nothing is named and the calibrated stiffnesses hold what is true, or where it is named,",
    "or is said to do as well as what is named. Values are right within 5 %, or where their 95 % interval holds what",
    "was planted. Errors are over the noise that the generator added.",
)


def section(records: Sequence[dict[str, Any]]) -> str:
    """The section, between its marks."""
    rows = [Row(one) for one in records]
    rows.sort(key=lambda r: (WHAT.index(r.record["what"]), MACHINES.index(r.record["machine"]), r.record["draw"]))
    draws, states = {r.record["draw"] for r in rows}, sorted({r.record["state"] for r in rows})
    used = "published" if min(draws, default=0) >= PUBLISHED else "development"
    lines = [BEGIN, "## Machines described by their parts", "", *INTRODUCTION, ""]
    asked = len(MACHINES) * (len(WHAT) + NULLS - 1)
    lines += [f"State of code {', '.join(states)}; {len(rows)} of {asked} cases, draws of {used}.", ""]
    lines += ["| figure | asked | found | 95 % | cases |", "| --- | --- | --- | --- | --- |"]
    nulls = [r for r in rows if r.record["what"] == "nothing"]
    planted = [r for r in rows if r.record["what"] != "nothing"]
    values = [ok for r in planted for *_, ok in r.values()]
    lines += [
        _share("named right, or in a set of three", "90 %", [r.right for r in planted]),
        _share("values of what was named", "all", values),
        _share(f"error after within {FLOOR} of the noise", "all", [r.at_floor for r in rows]),
        _share("nothing named where nothing is planted", "all", [r.right for r in nulls]),
        _share("intervals of calibrated values that hold the declared one, nothing planted", "95 %",
               [key not in r.missed for r in nulls for key in r.record.get("calibrated", ())]),
    ]  # fmt: skip
    lines += [
        "",
        "| planted | machine | named | value found (planted) | error after over noise: torque, table | right |",
    ]
    lines += ["| --- | --- | --- | --- | --- | --- |", *map(_row, rows), END, ""]
    return "\n".join(lines)


def _share(what: str, asked: str, hits: Sequence[bool]) -> str:
    low, high = wilson(sum(hits), len(hits))
    found = f"{100 * sum(hits) / len(hits):.0f} %" if hits else "-"
    return f"| {what} | {asked} | {found} | {100 * low:.0f} to {100 * high:.0f} % | {len(hits)} |"


def _row(row: Row) -> str:
    record = row.record
    head = f"| {PLANTED[record['what']]} | `{record['machine']}` |"
    if record["outcome"] != "done":
        return f"{head} {record['outcome']} | | | no |"
    told = [_value(key, found, true) for key, found, true, _ in row.values()]
    part = record["values"].get("part")
    key = f"{part}_stiffness"
    if not told and key in record["calibrated"]:
        one = record["calibrated"][key]
        low, high = one["ci95"]
        told = [f"calibrated {one['value']:.2f}, {low:.2f} to {high:.2f} ({record['values']['factor']:.2f})"]
    floors = ", ".join(f"{ratio:.2f}" for ratio in row.over_floor.values())
    names = ", ".join(row.named) or "nothing"
    sets = "; ".join("like " + ", ".join(one[1:]) for one in record["ambiguous"])
    right = "yes" if row.right else "no"
    return f"{head} {names}{f' ({sets})' if sets else ''} | {', '.join(told)} | {floors} | {right} |"


def _value(key: str, found: float, true: float) -> str:
    factor, unit = UNITS[key]
    return f"{key} {found * factor:.3g} {unit} ({true * factor:.3g})".replace("  ", " ")
