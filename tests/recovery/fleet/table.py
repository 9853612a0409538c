"""The part of docs/recovery.md that the fleet fills: what is asked, what was found, with binomial intervals."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence

import numpy as np

from tests.recovery.fleet.verdict import Verdict

BEGIN, END = "<!-- fleet -->", "<!-- end of fleet -->"
PUBLISHED = 100_000
"""Seeds below are for development; those of the published table begin here."""

NORMAL = 1.96


def wilson(hits: int, of: int) -> tuple[float, float]:
    """Return the 95 % interval of a share (Wilson, J. Am. Stat. Assoc. 22 (1927) 209); 0 to 1 where there are none."""
    if of == 0:
        return 0.0, 1.0
    share, z = hits / of, NORMAL
    middle = (share + z * z / (2 * of)) / (1 + z * z / of)
    half = z / (1 + z * z / of) * math.sqrt(share * (1 - share) / of + z * z / (4 * of * of))
    return max(0.0, middle - half), min(1.0, middle + half)


def section(verdicts: Sequence[Verdict], state: str) -> str:
    """Return the section, between its marks."""
    seeds = [v.truth["seed"] for v in verdicts]
    used = "published" if seeds and min(seeds) >= PUBLISHED else "development"
    span = f"{min(seeds)} to {max(seeds)}" if seeds else "none"
    lines = [BEGIN, "## Fleet", "", *INTRODUCTION, ""]
    lines += [f"State of code {state}; {len(seeds)} cases, seeds {span} ({used}).", ""]
    lines += ["| figure | asked | found | 95 % | cases | |", "| --- | --- | --- | --- | --- | --- |"]
    lines += rows(verdicts)
    lines += ["", "### What was planted, by effect", "", *by_effect(verdicts)]
    lines += ["", "### Odds", "", *odds(verdicts)]
    lines += ["", "### Cases that are not right", "", *wrong(verdicts), END, ""]
    return "\n".join(lines)


INTRODUCTION = (
    "Machines drawn at random (`tests/generator/machines.py`), programmes of three kinds (`programmes.py`), the",
    "catalogue's laws and relatives of them (`drawn_effects.py`), sizes from 1.1 to 8 times the floor: error without",
    "the effect over that with it, computed by the generator, in the band where it shows most. A fifth has",
    "nothing planted, 15 % are spoilt recordings, 15 % hold two effects; in half of all, declared values are off, each",
    "within its tolerance and two of them up to twice. Names of values beyond their tolerance count neither way.",
    "Intervals of shares are Wilson's.",
)


def rows(verdicts: Sequence[Verdict]) -> list[str]:
    """Return the rows of the figures."""
    done = [v for v in verdicts if v.done]
    singles = [v for v in verdicts if v.kind == "single"]
    laws, relatives = [v for v in singles if not v.relative], [v for v in singles if v.relative]
    pairs, nulls, spoilt = ([v for v in verdicts if v.kind == kind] for kind in ("pair", "null", "corrupted"))
    planted, sound = singles + pairs, [v for v in verdicts if not v.truth["spoiling"]]
    with_floor = [v for v in done if v.over_floor is not None]
    size = float(np.mean([v.set_size for v in planted if v.done])) if any(v.done for v in planted) else 1.0
    inside = [hit for v in done for _, hit in v.intervals]
    seconds = [v.record["cpu"] for v in verdicts]
    return [
        _share("one effect, the catalogue's law: asserted exactly right", ">= 95 %", [v.right for v in laws]),
        _share("one effect, a relative: asserted exactly right", ">= 90 %", [v.right for v in relatives]),
        _share(f"one effect, possible names counted (mean {size:.2f})", ">= 99 %", [v.right_in_sets for v in singles]),
        _share("two effects: asserted exactly right", ">= 90 %", [v.right for v in pairs]),
        _count("nothing planted: cases with a false name", "0 of 120", [bool(v.extra) for v in nulls]),
        *[_count(f"as declared, encoder of {bits} bits", "1 in all", hits) for bits, hits in _encoders(verdicts)],
        _count("spoilt recordings: cases with a false name", "1 of 90", [bool(v.extra) for v in spoilt]),
        _share("spoilt recordings: refused or reported", "-", [v.record["outcome"] == "refused" for v in spoilt]),
        _count("sound recordings refused", "-", [v.record["outcome"] == "refused" for v in sound]),
        _count("planted: cases with a name too many", "<= 3 %", [bool(v.extra) for v in planted]),
        _count("declared values off: false names", "-", [bool(v.extra) for v in verdicts if v.truth["off"]]),
        _count("a channel worse than declared", "0", [bool(v.worse_channels) for v in done]),
        _count("values out of physical range", "0", [bool(v.out_of_range) for v in done]),
        _count("plant_after unreadable", "0", [v.record["plant_after"] != "readable" for v in done]),
        _share(
            "error after <= 1.15 times the floor, catalogue's laws and none", ">= 98 %",
            [(v.over_floor or 0.0) <= 1.15 for v in with_floor if not v.relative],
        ),
        _share(
            "error after <= 1.3 times the floor, relatives", ">= 98 %",
            [(v.over_floor or 0.0) <= 1.3 for v in with_floor if v.relative],
        ),
        _share("planted parameters inside their 95 % intervals", "92 to 98 %", inside),
        _count("diagnoses that end in an error", "0", [v.record["outcome"] == "raised" for v in verdicts]),
        _count("diagnoses beyond the time limit", "0", [v.record["outcome"] == "time limit" for v in verdicts]),
        f"| processor seconds of a case: median, largest | <= 60 | {_middle(seconds)} | | {len(seconds)} | |",
    ]  # fmt: skip


def _encoders(verdicts: Sequence[Verdict]) -> list[tuple[int, list[bool]]]:
    """Return false names of the machines as declared, by the bits of their encoders."""
    found: dict[int, list[bool]] = {}
    for v in verdicts:
        if v.kind == "encoder null":
            found.setdefault(v.truth["bits"], []).append(bool(v.extra))
    return sorted(found.items())


def _middle(seconds: Sequence[float]) -> str:
    return f"{np.median(seconds):.1f}, {max(seconds):.1f}" if seconds else "-"


def _share(what: str, asked: str, hits: Sequence[bool]) -> str:
    low, high = wilson(sum(hits), len(hits))
    found = f"{100 * sum(hits) / len(hits):.1f} %" if hits else "-"
    return f"| {what} | {asked} | {found} | {100 * low:.0f} to {100 * high:.0f} % | {len(hits)} | |"


def _count(what: str, asked: str, hits: Sequence[bool]) -> str:
    low, high = wilson(sum(hits), len(hits))
    return f"| {what} | {asked} | {sum(hits)} | {100 * low:.0f} to {100 * high:.0f} % | {len(hits)} | |"


def by_effect(verdicts: Sequence[Verdict]) -> list[str]:
    """Return a table of the planted effects: law and relative, right of all."""
    counts: Counter[tuple[str, bool, bool]] = Counter()
    for v in verdicts:
        names = {name for name, _ in v.named}
        for one in v.truth["planted"]:
            counts[one["name"], one["relative"], one["name"] in names] += 1
    lines = ["| effect | law named | relative named |", "| --- | --- | --- |"]
    for name in sorted({name for name, _, _ in counts}):
        cells = [
            f"{counts[name, relative, True]}/{counts[name, relative, True] + counts[name, relative, False]}"
            for relative in (False, True)
        ]
        lines.append(f"| `{name}` | {cells[0]} | {cells[1]} |")
    return lines


def odds(verdicts: Sequence[Verdict]) -> list[str]:
    """Return stated probability against frequency by tenths, where names carry odds."""
    stated: list[tuple[float, bool]] = []
    for v in verdicts:
        true = {name for name, _ in v.planted} | set(v.truth["may"])
        for one in v.record.get("found", []):
            if one["odds"] is not None:
                ratio = float(one["odds"])
                stated.append((ratio / (1.0 + ratio) if math.isfinite(ratio) else 1.0, one["name"] in true))
    if not stated:
        return ["The names of this state carry no odds."]
    lines = ["| stated probability | names | right | 95 % |", "| --- | --- | --- | --- |"]
    for tenth in range(10):
        inside = [hit for share, hit in stated if tenth <= 10 * share < tenth + 1 or (tenth == 9 and share == 1.0)]
        if inside:
            low, high = wilson(sum(inside), len(inside))
            lines.append(
                f"| {tenth / 10:.1f} to {(tenth + 1) / 10:.1f} | {len(inside)} | {sum(inside)} "
                f"| {100 * low:.0f} to {100 * high:.0f} % |"
            )
    return lines


def wrong(verdicts: Sequence[Verdict]) -> list[str]:
    """Return a line for each case that is not right."""
    lines = ["| seed | planted | said |", "| --- | --- | --- |"]
    for v in sorted(verdicts, key=lambda one: one.truth["seed"]):
        bad = bool(v.extra) if not v.truth["planted"] else not v.right
        if not bad:
            continue
        planted = ", ".join(f"{'relative ' * p['relative']}{p['name']} x{p['size']:.1f}" for p in v.truth["planted"])
        planted = planted or v.truth["spoiling"] or "nothing"
        said = ", ".join(one["name"] for one in v.asserted) or v.record["outcome"].replace("done", "nothing")
        lines.append(f"| {v.truth['seed']} | {planted}{' (off)' if v.truth['off'] else ''} | {said} |")
    return lines
