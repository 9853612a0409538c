"""What became of the claims, as a table; and docs/claims.md, which is written from the list."""

from __future__ import annotations

import shutil
import textwrap
from collections.abc import Iterable, Mapping, Sequence

from tests.claims.book import CLAIMS, Claim
from tests.claims.run import Outcome

INSIDE, OUTSIDE, SKIPPED = "inside", "OUTSIDE", "not checked"

HEAD = """\
# Claims, and what shows them

Written from [claims.toml](claims.toml) by `python -m tests.claims page`; do not edit it here. Every number of the
README and the documents stands in that list with its bound. The tests take their bounds from it, and

    make check

runs all that is named below, the slow tests too, and prints claim, bound, measured value, and whether it is inside. It
ends with an error where one is not. It takes some 25 minutes of processor time on two cores, tells them, and goes
on where it was stopped; no test or script may take more than a quarter of an hour. A test that needs recordings that
are not part of the project is skipped and says so. What takes hours, or an idle machine, stands at the end.

| claim | bound | command | measured by |
|---|---|---|---|
"""

TAIL = """
Not part of `make check`: how often planted effects are named, with what intervals and errors, beside sparse regression
and a Gaussian process ([recovery.md](recovery.md), `make recovery`, hours), the state of the code being told on the
page; and how much faster a sweep is by several processes (`python benchmarks/sweep.py --runs 1000`), which needs an
idle machine.
"""


def page(claims: Iterable[Claim] = CLAIMS.values()) -> str:
    """docs/claims.md."""
    rows = []
    for claim in claims:
        note = f" ({claim.note})" if claim.note else ""
        command = f"`{claim.command}`" if claim.command else "–"
        rows.append(f"| {claim.says}{note} | {claim.bound()} | {command} | {', '.join(f'`{by}`' for by in claim.by)} |")
    return HEAD + "\n".join(rows) + "\n" + TAIL


def judged(claim: Claim, outcomes: Mapping[str, Outcome]) -> tuple[str, str, str]:
    """What was measured, the verdict, and why it is not inside.

    A claim with a number is judged by its measured values, whatever the tests say beside it; all of them count.
    """
    mine = [outcomes[target] for target in claim.by]
    failed = [outcome for outcome in mine if outcome.ended == "failed"]
    skipped = [outcome for outcome in mine if outcome.ended == "skipped"]
    values = [value for outcome in mine for value in outcome.measured.get(claim.key, [])]
    shown = _shown(values, claim.unit)
    if failed:
        return shown, OUTSIDE, f"{failed[0].target}: {failed[0].why}"
    if claim.numeric and not all(map(claim.inside, values)):
        return shown, OUTSIDE, "measured outside the bound"
    if skipped:
        return shown, SKIPPED, skipped[0].why
    if claim.numeric and not values:
        return shown, OUTSIDE, f"{', '.join(claim.by)} measures nothing of it"
    return shown or "passes", INSIDE, ""


def _shown(values: Sequence[float], unit: str) -> str:
    if not values:
        return ""
    ends = dict.fromkeys(f"{value:.4g}" for value in (min(values), max(values)))
    return " to ".join(ends) + (f" {unit}" if unit else "")


def table(claims: Sequence[Claim], outcomes: Mapping[str, Outcome]) -> tuple[str, int]:
    """The table, and how many claims are outside their bounds."""
    width = max(100, shutil.get_terminal_size((120, 24)).columns)
    lines, outside, skipped = [], 0, 0
    for claim in claims:
        measured, verdict, why = judged(claim, outcomes)
        outside += verdict == OUTSIDE
        skipped += verdict == SKIPPED
        said = textwrap.wrap(claim.says, width - 60)
        lines.append(f"{said[0]:{width - 60}s}  {claim.bound():24s} {measured:20s} {verdict}")
        lines += [f"  {line}" for line in said[1:]]
        lines += [f"    {line}" for line in textwrap.wrap(why, width - 8)]
    lines.append(f"\n{len(claims)} claims, {outside} outside, {skipped} not checked")
    return "\n".join(lines), outside
