"""The part of docs/recovery.md about machines described by their parts."""

from __future__ import annotations

from collections.abc import Sequence

from tests.recovery.fleet.run import Record
from tests.recovery.fleet.table import wilson
from tests.recovery.parts.cases import MACHINES, NULLS, PUBLISHED, WHAT
from tests.recovery.parts.responses import ResponseRow
from tests.recovery.parts.run import FLOOR, Row

BEGIN, END = "<!-- parts -->", "<!-- end of parts -->"

PLANTED = {
    "nothing": "nothing", "nut": "nut -20 %", "bearing": "near bearing -30 %", "drive": "coupling -25 %",
    "payload": "payload", "backlash": "free play", "bump": "friction bump", "lead": "periodic lead error",
    "stribeck": "Stribeck", "coupling": "coupling softer", "mode": "further mode",
}  # fmt: skip

RANK = {what: rank for rank, what in enumerate(PLANTED)}

_COLUMNS = "planted | machine | named | value found (planted) | error after over noise: torque, table | right | CPU s"

HEADS = {
    "recording": ((), _COLUMNS),
    "lumped": (
        ("Beside the file of three inertias that `feeddrive lump` writes, the error is what lumping costs:",), _COLUMNS
    ),
    "response": (
        ("Frequency responses of the same elements, 2 % of scatter, lines every 4 Hz; frequencies (of the machine,",
         "or of the mode) and static stiffness of the file after, beside those of the elements:"),
        "planted | machine | named | frequencies off | stiffness off | error over scatter | right | CPU s",
    ),
}  # fmt: skip
"""Kind of case to what stands above its rows."""

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


def section(records: Sequence[Record]) -> str:
    """The section, between its marks."""
    ordered = sorted(records, key=lambda r: (RANK[r["what"]], MACHINES.index(r["machine"]), r["draw"]))
    of = {kind: [row_of(r) for r in ordered if r.get("kind", "recording") == kind] for kind in HEADS}
    rows = [row for row in of["recording"] if isinstance(row, Row)]
    draws, states = {r["draw"] for r in records}, sorted({r["state"] for r in records})
    used = "publication" if min(draws, default=0) >= PUBLISHED else "development"
    lines = [BEGIN, "## Machines described by their parts", "", *INTRODUCTION, ""]
    asked = len(MACHINES) * (len(WHAT) + 1) + 2 * NULLS  # what is planted, a further mode and a lumped file; nulls
    hours = sum(float(r["cpu"]) for r in records) / 3600
    lines += [
        f"State of code {', '.join(states)}; {len(records)} of {asked} cases, draws of {used} from "
        f"{min(draws, default=0)}; {hours:.1f} h of processor time.",
        "",
    ]
    lines += ["| figure | asked | found | 95 % | cases |", "| --- | --- | --- | --- | --- |"]
    nulls = [r for r in rows if r.record["what"] == "nothing"]
    planted = [r for r in rows if r.record["what"] != "nothing"]
    values = [ok for r in planted for *_, ok in r.values()]
    responses = {what: [r.right for r in of["response"] if (r.record["what"] == "nothing") == (what == "nothing")]
                 for what in ("nothing", "planted")}  # fmt: skip
    lines += [
        _share("named right, or in a set of three", "90 %", [r.right for r in planted]),
        _share("values of what was named", "all", values),
        _share(f"error after within {FLOOR} of the noise", "all", [r.at_floor for r in rows]),
        _share("nothing named where nothing is planted", "all", [r.right for r in nulls]),
        _share("intervals of calibrated values that hold the declared one, nothing planted", "95 %",
               [key not in r.missed for r in nulls for key in r.record.get("calibrated", ())]),
        _share("frequency responses with nothing planted: nothing named, the file right", "all", responses["nothing"]),
        _share("frequency responses with something planted: named, the file right", "all", responses["planted"]),
        _share("nothing named beside the lumped file, nothing planted", "all", [r.right for r in of["lumped"]]),
    ]  # fmt: skip
    for kind, (words, head) in HEADS.items():
        if of[kind]:
            marks = " | ".join(["---"] * (head.count("|") + 1))
            lines += ["", *words, "", f"| {head} |", f"| {marks} |", *map(_row, of[kind])]
    return "\n".join([*lines, END, ""])


def row_of(record: Record) -> Row | ResponseRow:
    """A record with its questions answered."""
    return ResponseRow(record) if record.get("kind") == "response" else Row(record)


def _share(what: str, asked: str, hits: Sequence[bool]) -> str:
    low, high = wilson(sum(hits), len(hits))
    found = f"{100 * sum(hits) / len(hits):.0f} %" if hits else "-"
    return f"| {what} | {asked} | {found} | {100 * low:.0f} to {100 * high:.0f} % | {len(hits)} |"


def _row(row: Row | ResponseRow) -> str:
    record = row.record
    head = f"| {PLANTED[record['what']]} | `{record['machine']}` |"
    tail = f"{'yes' if row.right else 'no'} | {record['cpu']:.0f} |"
    if record["outcome"] != "done":
        return f"{head} {record['outcome']} | {' |' * (2 if isinstance(row, ResponseRow) else 1)} | {tail}"
    if isinstance(row, ResponseRow):
        first, second = (100 * off for off in record["frequency_off"])
        file = f"{first:+.3f}, {second:+.3f} % | {100 * record['stiffness_off']:+.2f} %"
        return f"{head} {row.told or 'nothing'} | {file} | {row.over_scatter:.2f} | {tail}"
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
    return f"{head} {names}{f' ({sets})' if sets else ''} | {', '.join(told)} | {floors} | {tail}"


def _value(key: str, found: float, true: float) -> str:
    factor, unit = UNITS[key]
    return f"{key} {found * factor:.3g} {unit} ({true * factor:.3g})".replace("  ", " ")
