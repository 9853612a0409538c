"""The search goes on without the names that are denied, and asks those again whose denial it has overtaken.

The first name that goes is denied beside all the others. Those that go after it are denied beside a set that lacks what
the first one stood for, and say less of themselves: beside a nut without its play no structure rings as it did. So they
are asked once more beside what the search then puts in its place, and judged as any other.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from feeddrive.diagnosis.finding.members import members_of
from feeddrive.diagnosis.finding.search import Search, search
from feeddrive.diagnosis.judging.judge import Judged
from feeddrive.diagnosis.judging.veto import without_denied
from feeddrive.diagnosis.likelihood.standing import Standing, odds_between
from feeddrive.diagnosis.recordings.recordings import is_shift

Found = tuple[Search, list[Judged]]
"""A search, and the recordings judged on with what it found."""


def settled_names(
    found: Search, judged: list[Judged], judge: Callable[[Search], list[Judged]], progress: Callable[[str], None]
) -> Found:
    """The names that data not fitted leave, once the search has gone on without those that they deny.

    Args:
        found: what the search took.
        judged: recordings with the found effects in.
        judge: judges other effects.
        progress: called with a line that says what is going on.
    """
    budget = found.problem.budget
    kept, judged = without_denied(found, judged, judge)
    if kept is found or any(is_shift(effect) for effect in kept.fit.effects):
        return kept, judged
    if budget.skips("a search without the names that are denied"):
        return kept, judged
    progress("searching again without the names that are denied")
    other = _gone_on(kept, judge, progress)
    overtaken = _denied_later(found, kept)
    if other is None:
        return kept, judged
    if not overtaken or budget.skips("names denied beside what is no longer named"):
        return other
    progress(f"asking again beside what is named now: {', '.join(overtaken)}")
    reasons = {name: why for name, why in other[0].denied.items() if name not in overtaken}
    more = _gone_on(replace(other[0], denied=reasons), judge, progress)
    if more is None:
        return other
    names = {effect.name for effect in more[0].fit.effects}
    denied = {name: why for name, why in other[0].denied.items() if name not in names}
    return replace(more[0], denied={**denied, **more[0].denied}), more[1]


def _gone_on(kept: Search, judge: Callable[[Search], list[Judged]], progress: Callable[[str], None]) -> Found | None:
    """Other names that a search from some finds and data not fitted leave; None where none are likelier."""
    again = search(kept.problem, progress, kept)
    found, judged = without_denied(again, judge(again), judge)
    if members_of(found.fit.effects) == members_of(kept.fit.effects):
        return None
    before, after = (Standing(one.problem, one.fit) for one in (kept, found))
    return (found, judged) if odds_between(before, after, found.count) > 0 else None


def _denied_later(found: Search, kept: Search) -> list[str]:
    """Names that were denied once another one had gone, in their order."""
    return [name for name in kept.denied if name not in found.denied][1:]
