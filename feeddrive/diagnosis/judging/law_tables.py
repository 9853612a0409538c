"""Tables carried beside laws of another form than ours.

A search weighs names beside the curve of a law (`likelihood.law_curve`), where the declared values are those of the
machine: with the curve closed they stand in for the form, each as far as it helps, and other motions are predicted
worse. So what the form leaves beside these values is taken apart, and the table over the variable of the law that pays
on data not fitted goes into the plant with it. A law that goes takes its table along.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from feeddrive.diagnosis.calibration.calibrate import with_kept
from feeddrive.diagnosis.finding.members import members_of
from feeddrive.diagnosis.finding.refitting import refitted
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.forms.open_map import open_curves, with_curves_of
from feeddrive.diagnosis.judging.judge import Judged, channel_results, judged_residual, shifted
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.unexplained.unexplained import CURVES, explain_rest
from feeddrive.effects.base import Effect
from feeddrive.effects.tabulated import Tabulated


def with_law_tables(found: Search, judged: Sequence[Judged], judge: Callable[[Search], list[Judged]]) -> Search:
    """The search with tables beside its laws of another form, where data not fitted are predicted better with them.

    Args:
        found: what the search took.
        judged: recordings with it in.
        judge: judges another search.
    """
    if found.opened is None:
        return found
    problem, opened = found.opened
    effects = opened.effects
    if members_of(effects) != members_of(found.fit.effects) or found.problem.budget.skips("tables of laws"):
        return found
    closed = with_curves_of(problem.settled(effects), ())
    at_rest = _with_values_at_rest(closed)
    alone = replace(found, problem=at_rest, fit=fit(at_rest, effects, iterations=0))
    there = judge(alone)
    rest = explain_rest(at_rest, effects, there, channel_results(at_rest, there))
    tables = _by_law(rest.effects, [effect for effect in effects if effect.name in open_curves(problem)])
    if not tables:
        return found
    carried = replace(closed, tables=tables)
    beside = refitted(carried, fit(carried, effects))
    other = replace(found, problem=beside[0], fit=beside[1])
    return other if _missed(other, judge(other)) < _missed(found, judged) else found


def without_tables(
    problem: Problem, effects: Sequence[Effect], judged: Sequence[Judged]
) -> tuple[Problem, list[Judged]]:
    """The problem without the tables that it carries, declared values as they are beside them; and what is judged."""
    if not problem.tables_of(effects):
        return problem, list(judged)
    bare = replace(problem.settled(effects), tables={})
    return bare, [replace(j, after=bare.machine(shifted(effects, j.shift))) for j in judged]


def _with_values_at_rest(problem: Problem) -> Problem:
    """The problem with its declared values where they are, none of them fitted."""
    known = problem.calibration
    if known is None or not known.values:
        return problem
    return with_kept(replace(problem, plant=problem.machine()), [False] * len(known.values))


def _by_law(tables: Sequence[Tabulated], laws: Sequence[Effect]) -> dict[str, tuple[Effect, ...]]:
    """The first law that each table may be the curve of, to its tables; others belong to none."""
    found: dict[str, tuple[Effect, ...]] = {}
    for table in tables:
        own = [law.name for law in laws if law.name in CURVES.get((table.name, table.place), ())]
        for name in own[:1]:
            found[name] = (*found.get(name, ()), table)
    return found


def _missed(found: Search, judged: Sequence[Judged]) -> float:
    """Weighted squared error on the judged data."""
    residual, _ = judged_residual(found.problem, [(j.after, j.evidence) for j in judged])
    return float(residual @ residual)
