"""One channel's residual taken apart on the fitted data, and its terms looked at on the judged data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.diagnosis.likelihood.cross_validation import LEAST_GAIN, compare_left_out
from feeddrive.diagnosis.likelihood.folds import FOLDS
from feeddrive.diagnosis.likelihood.predictor import CHANCE
from feeddrive.diagnosis.unexplained.functional_anova import Found, Sample, decompose
from feeddrive.diagnosis.unexplained.terms import Form, Term, columns_in, finer_steps, sines, terms_of
from feeddrive.diagnosis.unexplained.unexplained_result import Above, Dependence, Seen, Table
from feeddrive.diagnosis.unexplained.view import View, above_noise
from feeddrive.typing import FloatArray, IntegerArray
from feeddrive.units.quantity import format_quantity, percent

FEWEST = 60
"""Samples below which a residual is not taken apart."""


UNITS = {
    "time": "s",
    "table_position": "m",
    "table_velocity": "m/s",
    "table_acceleration": "m/s^2",
    "predicted_torque": "N m",
    "motor_angle": "rad",
    "travel_since_reversal": "m",
    "screw_speed": "rad/s",
    "nut_rise": "K",
}
"""SI unit of a variable."""

PERIOD_NODES = 24
"""Breakpoints of one period; a sine between them is off by 0.9 % of its amplitude."""

POWER_NODES = (0.05, 0.2, 0.4, 0.6, 0.8, 1.0)
"""Breakpoints of a law of powers, as shares of the largest value."""

WHOLE = 0.01
"""Distance from a whole number of periods a revolution within which a term is locked to the shaft."""

BINS = 40
"""Bins of the figure."""


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
    above: Above | None


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
    above = above_noise(judged)
    if not fitted:
        return Analysis((), (), above)
    found = decompose(_sample_of(fitted, _least(fitted)), terms_of(fitted), sines(fitted), finer_steps(fitted))
    return Analysis(found, tuple(_dependences(found, judged, unit, radius)), above)


def _sample_of(views: Sequence[View], least: float) -> Sample:
    """All recordings as one sample; each has its own offset, and blocks are counted on."""
    residual = np.concatenate([view.residual[view.rows] for view in views])
    counts = [int(view.rows.sum()) for view in views]
    owner = np.repeat(np.arange(len(views)), counts)
    blocks, first = [], 0
    for view in views:
        blocks.append(first + view.dealt)
        first += FOLDS * (int(view.dealt.max(initial=0)) // FOLDS + 1)
    floors = np.array([view.floor.rms**2 for view in views])
    return Sample(
        residual,
        np.concatenate(blocks),
        (owner[:, None] == np.arange(len(views))).astype(float),
        lambda term: np.vstack([columns_in(view, term) for view in views]),
        float(np.average(floors, weights=counts)),
        least,
    )


def _least(views: Sequence[View]) -> float:
    """Least share: half a percent, or what the luckiest of many wrong terms takes from noise of this band."""
    seconds = sum(
        float(view.rows.sum()) * view.evidence.thinning * view.evidence.recording.sample_time for view in views
    )
    return max(LEAST_GAIN, CHANCE / max(2 * views[0].evidence.edge * seconds, 1.0))


def _dependences(found: Sequence[Found], judged: Sequence[View], unit: str, radius: float) -> list[Dependence]:
    components = {one.term: [columns_in(view, one.term) @ one.values for view in judged] for one in found}

    def left(leaving: Term | None = None) -> FloatArray:
        """What the terms, but for one, leave of all recordings, each about its mean."""
        series = []
        for number, view in enumerate(judged):
            e = view.left - sum((own[number] for term, own in components.items() if term != leaving), 0.0)
            series.append(e - e.mean())
        return np.concatenate(series)

    after = left()
    whole = sum(float(np.sum((view.left - view.left.mean()) ** 2)) for view in judged)
    result = []
    for one in found:
        before = left(one.term)
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
    variable, seen = term.variable, _seen_on(judged, one, left)
    # locked to the shaft is what goes whole times into a revolution of the motor; else it is one of the travel
    locked = round(order) >= 1 and abs(order - round(order)) < WHOLE * max(1.0, 0.2 * order)
    if order and radius and not locked:
        breakpoints = tuple(radius * at for at in table.breakpoints)
        table = replace(table, breakpoints=breakpoints, breakpoint_unit="m", period=radius * table.period)
        variable = "table_position"
        seen = replace(seen, centre=tuple(radius * number for number in seen.centre))
    return Dependence(
        variable=variable,
        share=one.share,
        period=_period_words(order, radius) if order and radius else None,
        times=term.times,
        form=str(Form.CURVE if term.form is Form.POWERS else term.form),
        judged_share=share,
        confirmed=confirmed,
        order=order,
        amplitude=0.5 * float(np.ptp(table.values)) if len(table.values) > 1 else abs(table.values[0]),
        statement=_statement_of(term, table),
        table=table,
        seen=seen,
        alike=tuple(f"{t.variable} x {t.times}" if t.times else t.variable for t in one.alike),
    )


def _counted_on(views: Sequence[View]) -> IntegerArray:
    blocks, first = [], 0
    for view in views:
        blocks.append(first + view.blocks)
        first += int(view.blocks.max(initial=0)) + 1
    return np.concatenate(blocks)


def table_of(found: Found, unit: str) -> Table:
    """The term as a table over its own variable; a sine over one period of the motor angle.

    Args:
        found: term and its values.
        unit: of the residual.
    """
    term = found.term
    over = UNITS.get(term.variable, "1")
    at = _breakpoints(term)
    shape = replace(term, times="").columns({term.variable: at})
    values = shape @ found.values
    # errors of hats are those of their values; of sums of columns the root of squares, correlation left out
    errors = np.sqrt((shape**2) @ found.errors**2)
    unit = {"table_velocity": f"{unit} s/m"}.get(term.times, unit)
    period = term.nodes[0] if term.form is Form.SINE else 0.0
    return Table(tuple(at.tolist()), over, tuple(values.tolist()), tuple(errors.tolist()), unit, period)


def _breakpoints(term: Term) -> FloatArray:
    if term.form is Form.CURVE:
        return np.array(term.nodes)
    if term.form is Form.SINE:
        return term.nodes[0] * np.arange(PERIOD_NODES) / PERIOD_NODES
    if term.form is Form.POWERS:
        half = term.nodes[0] * np.array(POWER_NODES)
        return np.concatenate([-half[::-1], [0.0], half])
    return np.array([np.nextafter(term.nodes[0], -np.inf), term.nodes[0]]) if term.form is Form.STEP else np.ones(1)


def _statement_of(term: Term, table: Table) -> str:
    """The shape in words: extremes and where they are, how odd it is in velocity, when a step is."""
    values = np.array(table.values)
    by = {"direction": ", against the motion", "table_velocity": ", times the velocity"}.get(term.times, "")
    if term.form is Form.STEP:
        return f"changes by {_shown(values[-1], table.unit)}{by} at {_shown(term.nodes[0], table.breakpoint_unit)}"
    if term.form is Form.LEVEL:
        return f"{_shown(values[0], table.unit)} against the motion"
    low, high = int(np.argmin(values)), int(np.argmax(values))
    if term.form is Form.SINE:
        harmonics = _harmonics(values)
        return f"amplitude {_shown(0.5 * float(np.ptp(values)), table.unit)}{by}; {harmonics}"
    ends = [
        f"{_shown(values[i], table.unit)} at {_shown(table.breakpoints[i], table.breakpoint_unit)}" for i in (low, high)
    ]
    odd = f"; {_odd(table)}" if term.variable == "table_velocity" and not term.times else ""
    return f"from {ends[0]} to {ends[1]}{by}{odd}"


def _harmonics(values: FloatArray) -> str:
    """How much of the square of one period each of its harmonics holds."""
    powers = np.abs(np.fft.rfft(values))[1:4] ** 2
    shares = powers / powers.sum() if powers.sum() > 0 else powers
    phrases = [
        f"{percent(share)} of it {word}" for share, word in zip(shares, ("once", "twice", "three times"), strict=True)
    ]
    return f"{', '.join(phrases)} a period"


def _odd(table: Table) -> str:
    """Share of the shape's square that changes sign with the velocity."""
    at, values = np.array(table.breakpoints), np.array(table.values)
    half = np.linspace(0.02, 1.0, 50) * min(-at[0], at[-1])
    there, back = np.interp(half, at, values), np.interp(-half, at, values)
    odd, even = 0.5 * (there - back), 0.5 * (there + back)
    even = even - even.mean()
    total = float(odd @ odd + even @ even)
    share = float(odd @ odd) / total if total > 0 else 0.0
    return f"{percent(share)} of it odd in the velocity"


def _shown(value: float, unit: str) -> str:
    return format_quantity(float(value), unit)


def _period_words(order: float, radius: float) -> str:
    """A period in revolutions and in travel; `radius` is the travel per motor angle [m/rad]."""
    return f"{_shown(2 * np.pi * radius / order, 'm')} of travel ({order:.4g} per revolution of the motor)"


def _seen_on(views: Sequence[View], found: Found, left: FloatArray) -> Seen:
    """Means of what the terms leave, (m,) at the rows of all views, one put back, over its variable."""
    term = found.term
    at = np.concatenate([view.values[term.variable][view.rows] for view in views])
    if term.form is Form.SINE:
        at = np.mod(at, term.nodes[0])
    factor = np.ones(len(at))
    if term.times:
        factor = np.concatenate([view.values[term.times][view.rows] for view in views])
    own = np.vstack([columns_in(view, term) for view in views]) @ found.values
    low, high = (float(end) for end in np.quantile(at, [0.002, 0.998]))
    edges = np.linspace(low, high, BINS + 1)
    if term.variable == "travel_since_reversal":
        edges = np.geomspace(max(edges[-1] * 1e-5, 1e-9), edges[-1], BINS + 1)
    bins = np.clip(np.digitize(at, edges) - 1, 0, BINS - 1)
    weight = np.bincount(bins, weights=factor**2, minlength=BINS)
    moment = np.bincount(bins, weights=(left + own) * factor, minlength=BINS)
    filled = weight > 0.05 * weight.max(initial=1e-300) / BINS
    spread = float(np.std(left))
    return Seen(
        tuple(0.5 * (edges[1:] + edges[:-1])[filled]),
        tuple(moment[filled] / weight[filled]),
        tuple(spread / np.sqrt(weight[filled])),
    )
