"""The part of docs/recovery.md that sets the fleet beside its rivals, on the same cases."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from tests.recovery.fleet.table import wilson
from tests.recovery.fleet.verdict import Verdict
from tests.recovery.fleet_rivals.run import named_by_regression

BEGIN, END = "<!-- rivals -->", "<!-- end of rivals -->"

Record = dict[str, Any]

INTRODUCTION = (
    "The cases of the fleet above whose recordings are sound, errors over the same floor, on the worst channel.",
    "Sparse regression (PySINDy, STLSQ) and a Gaussian process correct the declared plant as in the suite above;",
    "a regression names an effect where one of its three strongest terms of a channel is the effect's, whatever else",
    "it keeps, and a Gaussian process names nothing. The earlier method is this project as it was before declared",
    "values had tolerances and one likelihood decided (commit {previous}), on as many cases as there was time for.",
)


def section(fleet: Sequence[Record], rivals: dict[int, Record], previous: str) -> str:
    """Return the section, between its marks."""
    pairs = [(record, rivals[record["seed"]]) for record in fleet if record["seed"] in rivals]
    state = ", ".join(sorted({record["state"] for record, _ in pairs}))
    lines = [BEGIN, "## The fleet beside what else one would do", ""]
    lines += [one.format(previous=previous) for one in INTRODUCTION]
    lines += ["", f"State of code {state}; {len(pairs)} cases.", ""]
    lines += ["|  | feeddrive | sparse regression | black box |", "| --- | --- | --- | --- |"]
    lines += corrected(pairs)
    both = [(Verdict(record), earlier(record, found)) for record, found in pairs if "previous" in found]
    if both:
        lines += ["", f"The method as it is and as it was, on {len(both)} cases that both have met:", ""]
        lines += ["|  | as it is | as it was |", "| --- | --- | --- |", *compared(both)]
    return "\n".join([*lines, END, ""])


def corrected(pairs: Sequence[tuple[Record, Record]]) -> list[str]:
    """Return the rows of errors and names beside sparse regression and the black box."""
    planted = [(record, found) for record, found in pairs if record["truth"]["planted"]]
    nulls = [(record, found) for record, found in pairs if not record["truth"]["planted"]]
    rows = []
    for label, some in (("planted", planted), ("nothing planted", nulls)):
        own = [over(record, record["after"]) for record, _ in some]
        others = [[over(record, found[key]["after"]) for record, found in some] for key in ("sparse", "black box")]
        for what, of in ERRORS:
            rows.append(f"| {label}, {len(some)} cases: error after over the floor, {what} | "
                        + " | ".join(of(one) for one in (own, *others)) + " |")  # fmt: skip
    count = sum(len({one["name"] for one in record["truth"]["planted"]}) for record, _ in planted)
    own_names = sum(len(Verdict(r).planted & Verdict(r).named) for r, _ in planted)
    regressed = sum(len(named_by_regression(record, found["sparse"])) for record, found in planted)
    rows.append(f"| planted effects that are named | {own_names}/{count} | {regressed}/{count} | none |")
    kept = [sum(found["sparse"]["kept"].values()) for _, found in planted]
    names = [len(Verdict(record).asserted) for record, _ in planted]
    rows.append(f"| names or terms in the answer, median | {np.median(names):.0f} | {np.median(kept):.0f} | - |")
    false = sum(bool(Verdict(record).extra) for record, _ in nulls)
    says = sum(any(found["sparse"]["kept"].values()) for _, found in nulls)
    rows.append(
        f"| says something that is not so where nothing is planted | {false}/{len(nulls)} | {says}/{len(nulls)} | - |"
    )
    return rows


def over(record: Record, after: dict[str, float]) -> float:
    """Return an error over the floor, on the worst channel."""
    return max(after[name] / value for name, value in record["floor"].items())


ERRORS: tuple[tuple[str, Callable[[Sequence[float]], str]], ...] = (
    ("median", lambda one: f"{np.median(one):.2f}" if one else "-"),
    ("largest", lambda one: f"{max(one):.3g}" if one else "-"),
    ("cases up to 1.15", lambda one: f"{sum(e <= 1.15 for e in one)}/{len(one)}"),
)


def earlier(record: Record, found: Record) -> Verdict:
    """Return what the earlier method said, asked the same questions beside the same floor."""
    said = {"found": [], "ambiguous": [], "after": {}, "before": {}, "band": {}} | found["previous"]
    return Verdict(record | said)


def compared(both: Sequence[tuple[Verdict, Verdict]]) -> list[str]:
    """Return the rows of the method as it is and as it was."""
    columns = [[pair[side] for pair in both] for side in (0, 1)]
    seconds = (f"{np.median(s):.0f}, {max(s):.0f}" for s in ([v.record["cpu"] for v in one] for one in columns))
    return [
        _row("one effect, the catalogue's law: exactly right", columns, _singles(relative=False), lambda v: v.right),
        _row("one effect, a relative: exactly right", columns, _singles(relative=True), lambda v: v.right),
        _row("two effects: exactly right", columns, lambda v: v.kind == "pair", lambda v: v.right),
        _row("nothing planted: a false name", columns, lambda v: v.kind == "null", lambda v: bool(v.extra)),
        _row("a name too many where something is planted", columns, _is_planted, lambda v: bool(v.extra)),
        _row("a channel worse than declared", columns, _done, lambda v: bool(v.worse_channels)),
        _row("values out of physical range", columns, _done, lambda v: bool(v.out_of_range)),
        _row("error after up to 1.15 times the floor", columns, _done, lambda v: (v.over_floor or 0.0) <= 1.15),
        _row("planted parameters inside their 95 % intervals", columns, _done, _inside),
        _row("not done: an error, a refusal, beyond the time", columns, lambda v: True, lambda v: not v.done),
        f"| processor seconds: median, largest | {' | '.join(seconds)} |",
    ]


def _done(verdict: Verdict) -> bool:
    return verdict.done


def _singles(relative: bool) -> Callable[[Verdict], bool]:
    return lambda v: v.kind == "single" and v.relative == relative


def _is_planted(verdict: Verdict) -> bool:
    return bool(verdict.truth["planted"])


def _inside(verdict: Verdict) -> list[bool]:
    return [hit for _, hit in verdict.intervals]


def _row(
    label: str, columns: Sequence[Sequence[Verdict]], counts: Callable[[Verdict], bool],
    asked: Callable[[Verdict], bool | list[bool]],
) -> str:  # fmt: skip
    cells = []
    for column in columns:
        answers = [asked(verdict) for verdict in column if counts(verdict)]
        hits = [hit for one in answers for hit in (one if isinstance(one, list) else [one])]
        low, high = wilson(sum(hits), len(hits))
        cells.append(f"{sum(hits)}/{len(hits)} ({100 * low:.0f} to {100 * high:.0f} %)")
    return f"| {label} | {' | '.join(cells)} |"
