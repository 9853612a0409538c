"""docs/recovery.md: the figures, every effect beside what else one would do, and every case that failed."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable, Sequence

import numpy as np

from feeddrive import __version__
from tests.generator.sizing import SHARES
from tests.recovery.suite.cases import Case, Kind, unreachable
from tests.recovery.suite.figures import LARGER, Figure, figures
from tests.recovery.suite.planting import MACHINES, variants
from tests.recovery.suite.sizes import NEVER_SMALL
from tests.recovery.suite.verdict import Verdict

TEXT = """\
# Recovery

Every effect is planted by a simulator that shares no code with the package (`tests/generator`), diagnosed as a user
would, and set beside the truth. This file is written by `make recovery`, which goes on where it was stopped;
`make recovery-smoke` does one case an effect.

{holds}

How a case is made and judged:

- Two axes, `bench` and `light`, and for heat one rig under two programmes, `warm-up` and `short warm-up`; sensors with
  the declared noise and with three times as much. Recordings for fitting and judging of 12 s and 7.6 s (`bench`), 6.8 s
  and 6 s (`light`; 10 s and 6 s for effects that settle with time).
- Sizes: 2 %, 10 % and 50 % is what the true plant takes away from the error (rms) of the declared one on the recording
  that is judged, on the channel where it takes away most. `service` is what a service engineer would meet, mostly much
  larger. {presliding} cannot be made small and is planted at half, once and twice the size of service.
- Named right: exactly what was planted and nothing else, each at its port, part or channel.
- In parentheses: tables of what no name explains, which the diagnosis adds after the names.
- Floor: the error of the true plant, the package's own plant with the planted values, on the same samples.
- Bound: the narrowest 95 % interval that any unbiased estimate can have in this noise, its colour counted
  (Cramér–Rao), for heat the gain of 0.1 % too that sensor and model leave open; `tests/recovery/suite/bound.py`.
- Sparse regression: the declared plant's error regressed by PySINDy (STLSQ) on a library of some forty terms, the
  threshold by held-out blocks and the one-standard-error rule. It counts as naming an effect where a term
  that is the effect's (`tests/recovery/suite/regression_terms.py`) is among the three strongest of a channel, whatever
  else it keeps.
- Black box: a Gaussian process over x, v and sign v on at most 1000 points (warm-up: over the speed and what follows
  it); it names nothing.
- Errors are over the floor, on the worst channel, medians of the cases unless said otherwise.
"""

EFFECTS_TEXT = """\
2 %, 10 %, 50 %: cases named right at each size. In sets: at the two larger sizes, ambiguous sets counted, and their
mean size. Inside: planted parameters inside their 95 % intervals. Width: median half width over the bound. Before,
after, sparse, black box: errors over the floor of the declared plant, of the plant with what was found, and of what
else one would do. Named: cases in which sparse regression names the effect.

"""


def document(cases: Sequence[Case], verdicts: Sequence[Verdict]) -> str:
    """The whole file."""
    parts = [
        TEXT.format(holds=_holds(cases, verdicts), presliding=" and ".join(f"`{name}`" for name in NEVER_SMALL)),
        "## Figures\n\n" + _table(("figure", "asked", "found", "cases", ""), map(_figure_row, figures(verdicts))),
        "## One effect\n\n" + _effects(verdicts),
        "## Two effects\n\n" + _pairs(verdicts),
        "## Declared numbers off\n\n" + _offs(verdicts),
        "## What else one would do\n\n" + _otherwise(verdicts),
        "## Cases that failed\n\n" + _failed(verdicts),
        "## Time\n\n" + _time(verdicts),
    ]
    return "\n\n".join(part.rstrip() for part in parts) + "\n"


def _holds(cases: Sequence[Case], verdicts: Sequence[Verdict]) -> str:
    codes = {v.record["code"] for v in verdicts}
    if len(codes) > 1:
        raise ValueError(f"records of {len(codes)} states of the code make no table: {', '.join(sorted(codes))}")
    said = (
        f"It holds **{len(verdicts)} of {len(cases)} cases**, feeddrive {__version__}, state {''.join(codes) or 'none'}"
    )
    said += (
        " of the code (`python -m tests.recovery.suite state` tells that of a checkout); of another it says nothing."
    )
    if len(verdicts) < len(cases):
        said += " **The figures below are of this part only.**"
    if lost := unreachable():
        said += f" Not among the cases, as no size of the effect reaches the share: {', '.join(lost)}."
    return textwrap.fill(said, 118, break_long_words=False, break_on_hyphens=False)


def _figure_row(figure: Figure) -> tuple[str, ...]:
    met = {True: "pass", False: "**short**", None: ""}[figure.met]
    return figure.what, figure.asked, figure.found, str(figure.of), met


def _effects(verdicts: Sequence[Verdict]) -> str:
    singles = [v for v in verdicts if v.kind is Kind.SINGLE]
    heads = (
        "effect", *(f"{share:.0%}" for share in SHARES), "in sets", "set size", "inside", "width", "before", "after",
        "sparse", "named", "black box", "CPU s",
    )  # fmt: skip
    rows = []
    for name in dict.fromkeys(name for machine in MACHINES for name in variants(machine)):
        mine = [v for v in singles if name in v.planted]
        rows.append((f"`{name}`", *_effect_row(mine)))
    return EFFECTS_TEXT + _table(heads, rows)


def _effect_row(mine: Sequence[Verdict]) -> tuple[str, ...]:
    larger = [v for v in mine if v.record["size"] in LARGER]
    by_size = [[v.right for v in mine if v.record["size"] == f"{share:.0%}"] for share in SHARES]
    intervals = [interval for v in mine for interval in v.intervals]
    return (
        *(_count(held) for held in by_size),
        _count([v.right_in_sets for v in larger]),
        _middle([v.set_size for v in larger], np.mean),
        _count([interval.inside for interval in intervals]),
        _middle([interval.width for interval in intervals]),
        _middle([v.before for v in mine]),
        _middle([v.error for v in mine]),
        _middle([v.rival("sparse") for v in mine]),
        _count([v.sparse_named for v in mine if "sparse" in v.record]),
        _middle([v.rival("black box") for v in mine]),
        _middle([v.cpu for v in mine], digits=1),
    )


def _pairs(verdicts: Sequence[Verdict]) -> str:
    heads = ("pair", "size", "machine", "both right", "found", "after", "sparse regression", "both", "black box")
    rows = [
        (
            " + ".join(f"`{name}`" for name in v.planted), v.record["size"], v.record["machine"], _tick(v.right),
            _found(v), _middle([v.error]), _middle([v.rival("sparse")]), _tick(v.sparse_named),
            _middle([v.rival("black box")]),
        )
        for v in verdicts
        if v.kind is Kind.PAIR
    ]  # fmt: skip
    return _table(heads, rows)


def _offs(verdicts: Sequence[Verdict]) -> str:
    heads = ("axis", "off", "found", "not theirs", "before", "after", "sparse regression")
    rows = [
        (
            v.record["machine"], ", ".join(f"{name} × {factor:g}" for name, factor in v.record["off"].items()),
            _found(v), ", ".join(v.false_names) or "–", _middle([v.before]), _middle([v.error]),
            _middle([v.rival("sparse")]),
        )
        for v in verdicts
        if v.kind is Kind.OFF
    ]  # fmt: skip
    said = "Errors are over those with the true numbers. No limit is set; a name that is not theirs misleads.\n\n"
    return said + _table(heads, rows)


def _otherwise(verdicts: Sequence[Verdict]) -> str:
    heads = ("", "feeddrive", "sparse regression", "black box")
    mine = [v for v in verdicts if v.kind in (Kind.SINGLE, Kind.PAIR) and "sparse" in v.record]
    nulls = [v for v in verdicts if v.kind is Kind.NULL and "sparse" in v.record]
    rows = [
        ("error after, median", _middle([v.error for v in mine]), *_rival_row(mine, np.median)),
        ("error after, largest", _middle([v.error for v in mine], max), *_rival_row(mine, max)),
        (
            "every planted effect named",
            _count([set(v.planted) <= set(v.names) for v in mine]), _count([v.sparse_named for v in mine]), "none",
        ),
        (
            "names or terms in the answer, median",
            _middle([len(v.names) for v in mine], digits=0), _middle([v.sparse_kept for v in mine], digits=0), "–",
        ),
        (
            "says something where nothing is planted",
            _count([bool(v.names) for v in nulls]),
            _count([v.sparse_kept > 0 for v in nulls if v.sparse_kept is not None]), "–",
        ),
    ]  # fmt: skip
    return _table(heads, rows)


def _rival_row(mine: Sequence[Verdict], middle: Callable[..., float]) -> tuple[str, str]:
    return _middle([v.rival("sparse") for v in mine], middle), _middle([v.rival("black box") for v in mine], middle)


def _failed(verdicts: Sequence[Verdict]) -> str:
    failed = [v for v in verdicts if not v.right and v.kind is not Kind.OFF and v.record["size"] != f"{SHARES[0]:.0%}"]
    small = [v for v in verdicts if not v.right and v.record["size"] == f"{SHARES[0]:.0%}"]
    heads = ("case", "found", "ambiguous sets", "before", "after", "why not")
    rows = [
        (v.record["label"], _found(v), _sets(v), _middle([v.before]), _middle([v.error]), _why(v))
        for v in [*failed, *small]
    ]
    return "Not named right; the 2 % size, of which nothing is asked, last.\n\n" + _table(heads, rows)


def _time(verdicts: Sequence[Verdict]) -> str:
    parts = list(dict.fromkeys(part for v in verdicts for part in v.record["cpu"]))
    rows = [
        (kind, str(len(of)), *(_middle([v.record["cpu"].get(part) for v in of], digits=1) for part in parts),
         f"{np.median([v.cpu for v in of]):.1f}", f"{sum(v.cpu for v in of):.0f}")
        for kind in Kind
        if (of := [v for v in verdicts if v.kind is kind])
    ]  # fmt: skip
    slow = sorted(verdicts, key=lambda v: -v.cpu)[:10]
    said = f"CPU seconds a case, medians, and all together: {sum(v.cpu for v in verdicts):.0f} s.\n\n"
    listed = "; ".join(f"{v.record['label']} {v.cpu:.0f} s" for v in slow)
    return said + _table(("", "cases", *parts, "a case", "all"), rows) + f"\n\nThe slowest: {listed}."


def _found(v: Verdict) -> str:
    if "raised" in v.record:
        return "error: " + v.record["raised"].strip().splitlines()[-1][:120]
    names = [_in_words(v, one) for one in v.record["found"]]
    return ", ".join([*names, *(f"({name})" for name in v.record.get("tables", []))]) or "nothing"


def _in_words(v: Verdict, one: dict[str, object]) -> str:
    name = str(one["name"])
    wrong_place = name in v.planted and not v._placed(one)
    return f"{name} at {one['place']}" if wrong_place else name


def _sets(v: Verdict) -> str:
    return "; ".join(" / ".join(names) for names in v.record["ambiguous"]) or "–"


def _why(v: Verdict) -> str:
    return "; ".join(f"{name}: {reason}" for name, reason in v.record.get("refused", {}).items()) or "–"


def _tick(held: bool) -> str:
    return "yes" if held else "no"


def _count(held: Sequence[bool]) -> str:
    return f"{sum(held)}/{len(held)}" if held else "–"


def _middle(values: Iterable[float | None], middle: Callable[..., float] = np.median, digits: int = 2) -> str:
    numbers = [value for value in values if value is not None]
    return f"{float(middle(numbers)):.{digits}f}" if numbers else "–"


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    body = list(rows) or [["–"] * len(heads)]
    return "\n".join("| " + " | ".join(row) + " |" for row in [heads, ["---"] * len(heads), *body])
