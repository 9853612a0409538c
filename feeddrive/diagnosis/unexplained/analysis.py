"""One channel's residual taken apart on the fitted data, and its terms looked at on the judged data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.diagnosis.likelihood.cross_validation import LEAST_GAIN, compare_left_out
from feeddrive.diagnosis.likelihood.predictor import CHANCE
from feeddrive.diagnosis.unexplained.floor import Excess, excess
from feeddrive.diagnosis.unexplained.functional_anova import Decomposition, Found, decompose
from feeddrive.diagnosis.unexplained.shape import (
    in_travel,
    is_locked,
    period_words,
    seen_on,
    statement_of,
    table_of,
)
from feeddrive.diagnosis.unexplained.term import Form, Term
from feeddrive.diagnosis.unexplained.tried_terms import finer_steps, sines, terms_of
from feeddrive.diagnosis.unexplained.unexplained_result import Dependence
from feeddrive.diagnosis.unexplained.view import View, sample_of
from feeddrive.typing import FloatArray, IntegerArray

FEWEST = 60
"""Samples below which a residual is not taken apart."""


@dataclass(frozen=True)
class Analysis:
    """What one channel's residual follows.

    Attributes:
        found: terms, the strongest first.
        dependences: the same for a person, in the same order.
        above: beside the noise, on the judged data; None where nothing is judged.
    """

    found: tuple[Found, ...]
    dependences: tuple[Dependence, ...]
    above: Excess | None


def analyse(fitted: Sequence[View], judged: Sequence[View], unit: str, radius: float) -> Analysis:
    """Take what is left of a channel apart.

    Args:
        fitted: views of the fitted samples; terms are found here.
        judged: views of the judged samples; terms are confirmed here.
        unit: of the channel.
        radius: travel per motor angle [m/rad]; 0 where there is none.
    """
    fitted = [view for view in fitted if view.rows.sum() >= FEWEST]
    judged = [view for view in judged if view.rows.any()]
    above = excess([_centred(v) for v in judged], [v.blocks for v in judged], [v.floor for v in judged])
    if not fitted:
        return Analysis((), (), above)
    parts = decompose(sample_of(fitted, _least(fitted)), terms_of(fitted), sines(fitted), finer_steps(fitted))
    return Analysis(parts.found, tuple(_dependences(parts, judged, unit, radius)), above)


def _least(views: Sequence[View]) -> float:
    """Least share: half a percent, or what the luckiest of many wrong terms takes from noise of this band."""
    seconds = sum(
        float(view.rows.sum()) * view.evidence.thinning * view.evidence.recording.sample_time for view in views
    )
    return max(LEAST_GAIN, CHANCE / max(2 * views[0].evidence.edge * seconds, 1.0))


def _centred(view: View) -> FloatArray:
    """The residual where it counts, the zero of a scale taken out."""
    residual = view.residual[view.rows]
    return residual - residual.mean() if view.channel in view.evidence.floating else residual


def _dependences(parts: Decomposition, judged: Sequence[View], unit: str, radius: float) -> list[Dependence]:
    components = {one.term: [view.columns(one.term) @ one.values for view in judged] for one in parts.found}
    residual = [_centred(view) for view in judged]
    left = [_about_mean(e - _sum(components, i)) for i, e in enumerate(residual)]
    whole = sum(float(np.sum(_about_mean(e) ** 2)) for e in residual)
    result = []
    for one in parts.found:
        without = [_about_mean(e - _sum(components, i, one.term)) for i, e in enumerate(residual)]
        before, after = np.concatenate(without), np.concatenate(left)
        comparison = compare_left_out(before, after, _counted_on(judged), 0.0)
        share = comparison.gain * float(before @ before) / whole
        sure = comparison.gain > LEAST_GAIN and comparison.gain > comparison.standard_error
        result.append(_dependence(one, unit, radius, share, sure, judged, after))
    return result


def _dependence(
    one: Found, unit: str, radius: float, share: float, confirmed: bool, judged: Sequence[View], left: FloatArray
) -> Dependence:
    term, table = one.term, table_of(one, unit)
    order = 2 * np.pi / term.nodes[0] if term.form is Form.SINE else 0.0
    variable, seen = term.variable, seen_on(judged, one, left)
    if order and radius and not is_locked(order):
        variable, table, seen = (
            "table_position",
            in_travel(table, radius),
            replace(seen, centre=_scaled(seen.centre, radius)),
        )
    return Dependence(
        variable,
        one.share,
        period_words(order, radius) if order and radius else None,
        term.times,
        str(Form.CURVE if term.form is Form.POWERS else term.form),
        share,
        confirmed,
        order,
        0.5 * float(np.ptp(table.values)) if len(table.values) > 1 else abs(table.values[0]),
        statement_of(term, table),
        table,
        seen,
        tuple(_name(other) for other in one.alike),
    )


def _scaled(numbers: Sequence[float], factor: float) -> tuple[float, ...]:
    return tuple(factor * number for number in numbers)


def _name(term: Term) -> str:
    return f"{term.variable} x {term.times}" if term.times else term.variable


def _about_mean(series: FloatArray) -> FloatArray:
    centred: FloatArray = series - series.mean()
    return centred


def _sum(components: dict[Term, list[FloatArray]], recording: int, leaving: Term | None = None) -> FloatArray | float:
    return sum((parts[recording] for term, parts in components.items() if term != leaving), 0.0)


def _counted_on(views: Sequence[View]) -> IntegerArray:
    blocks, first = [], 0
    for view in views:
        blocks.append(first + view.blocks)
        first += int(view.blocks.max(initial=0)) + 1
    return np.concatenate(blocks)
