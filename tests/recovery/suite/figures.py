"""The figures that are kept, what is asked of each, and what the records say."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tests.generator.sizing import SHARES
from tests.recovery.suite.cases import Kind
from tests.recovery.suite.verdict import Interval, Verdict

LARGER = tuple(f"{share:.0%}" for share in SHARES[1:])
"""The two larger sizes."""

NAMED, IN_SETS, BOTH, FALSE_ALARMS = 0.95, 0.99, 0.85, 1
COVERED = (0.90, 0.98)
WIDTH, ERROR = 1.5, 1.15


@dataclass(frozen=True)
class Figure:
    """One line of the table: what, what is asked, what was found, over how many, and whether it is met.

    met is None where there are no cases.
    """

    what: str
    asked: str
    found: str
    of: int
    met: bool | None


def figures(verdicts: Sequence[Verdict]) -> list[Figure]:
    """All figures."""
    singles = [v for v in verdicts if v.kind is Kind.SINGLE]
    larger = [v for v in singles if v.record["size"] in LARGER]
    small = [v for v in singles if v.record["size"] not in LARGER]
    pairs, nulls, offs = ([v for v in verdicts if v.kind is kind] for kind in (Kind.PAIR, Kind.NULL, Kind.OFF))
    sets = float(np.mean([v.set_size for v in larger])) if larger else 1.0
    wrong = sum(bool(v.false_names) for v in offs)
    return [
        _share("one effect, the two larger sizes: named right", [v.right for v in larger], NAMED),
        _share(
            f"the same, ambiguous sets of at most three counted (mean set size {sets:.2f})",
            [v.right_in_sets for v in larger],
            IN_SETS,
        ),
        _share("two effects: both named right", [v.right for v in pairs], BOTH),
        _share("two effects, ambiguous sets counted", [v.right_in_sets for v in pairs], None),
        _alarms(nulls),
        _tables(nulls),
        *_intervals([i for v in verdicts if v.kind in (Kind.SINGLE, Kind.PAIR) for i in v.intervals]),
        *_errors([v for v in verdicts if v.kind is not Kind.OFF]),
        _share("one effect, the 2 % size: named right", [v.right for v in small], None),
        Figure("declared numbers off: cases with a name that is not theirs", "–", str(wrong), len(offs), None),
    ]  # fmt: skip


def _share(what: str, held: Sequence[bool], asked: float | None) -> Figure:
    found = float(np.mean(held)) if held else 0.0
    met = None if asked is None or not held else found >= asked
    return Figure(what, "–" if asked is None else f"≥ {asked:.0%}", f"{found:.1%}" if held else "–", len(held), met)


def _alarms(nulls: Sequence[Verdict]) -> Figure:
    """At most one; of fewer than forty cases nothing can be said but that there are too many."""
    alarms = sum(bool(v.names) for v in nulls)
    met = False if alarms > FALSE_ALARMS else (True if len(nulls) >= 40 else None)
    return Figure("nothing planted: false alarms", f"at most {FALSE_ALARMS} of 40", str(alarms), len(nulls), met)


def _tables(nulls: Sequence[Verdict]) -> Figure:
    """No name, but said to be there."""
    count = sum(bool(v.record.get("tables")) for v in nulls)
    return Figure("nothing planted: tables of what no name explains", "–", str(count), len(nulls), None)


def _intervals(intervals: Sequence[Interval]) -> list[Figure]:
    inside = [interval.inside for interval in intervals]
    widths = [interval.width for interval in intervals if interval.width is not None]
    low, high = COVERED
    covered = float(np.mean(inside)) if inside else 0.0
    width = float(np.median(widths)) if widths else 0.0
    return [
        Figure(
            "parameters inside their 95 % intervals", f"{low:.0%} to {high:.0%}", f"{covered:.1%}" if inside else "–",
            len(inside), low <= covered <= high if inside else None,
        ),
        Figure(
            "median half width over the coloured-noise Cramér–Rao bound", f"≤ {WIDTH:g}",
            f"{width:.2f}" if widths else "–", len(widths), width <= WIDTH if widths else None,
        ),
    ]  # fmt: skip


def _errors(verdicts: Sequence[Verdict]) -> list[Figure]:
    errors = [v.error for v in verdicts if v.error is not None]
    # Where little was missing the limit is met by an empty answer.
    large = [v.error for v in verdicts if v.error is not None and v.before > ERROR]
    failed = sum("raised" in v.record for v in verdicts)
    return [
        _within("validation error after over the floor, worst channel", errors),
        _within(f"the same, where the declared plant's is above {ERROR:g}", large),
        Figure("diagnoses that end in an error", "0", str(failed), len(verdicts), failed == 0 if verdicts else None),
    ]


def _within(what: str, errors: Sequence[float]) -> Figure:
    """Every case has to be within the limit."""
    if not errors:
        return Figure(what, f"≤ {ERROR:g}", "–", 0, None)
    within = [error <= ERROR for error in errors]
    said = f"{np.mean(within):.1%} of cases; median {np.median(errors):.3f}, largest {max(errors):.2f}"
    return Figure(what, f"≤ {ERROR:g}", said, len(errors), all(within))
