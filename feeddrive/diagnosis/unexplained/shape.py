"""The shape of a term that was found: as a table with standard errors, and in words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from feeddrive.diagnosis.unexplained.functional_anova import Found
from feeddrive.diagnosis.unexplained.term import Form, Term
from feeddrive.diagnosis.unexplained.unexplained_result import Seen, Table
from feeddrive.diagnosis.unexplained.view import View
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity

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


def table_of(found: Found, unit: str) -> Table:
    """The term as a table over its own variable; a sine over one period of the motor angle.

    Args:
        found: term and its values.
        unit: of the residual.
    """
    term = found.term
    over = UNITS.get(term.variable, "1")
    at = _breakpoints(term)
    shape = _plain(term).columns({term.variable: at})
    values = shape @ found.values
    # errors of hats are those of their values; of sums of columns the root of squares, correlation left out
    errors = np.sqrt((shape**2) @ found.errors**2)
    unit = {"table_velocity": f"{unit} s/m"}.get(term.times, unit)
    period = term.nodes[0] if term.form is Form.SINE else 0.0
    return Table(tuple(at.tolist()), over, tuple(values.tolist()), tuple(errors.tolist()), unit, period)


def _plain(term: Term) -> Term:
    return Term(term.form, term.variable, "", term.nodes)


def _breakpoints(term: Term) -> FloatArray:
    if term.form is Form.CURVE:
        return np.array(term.nodes)
    if term.form is Form.SINE:
        return term.nodes[0] * np.arange(PERIOD_NODES) / PERIOD_NODES
    if term.form is Form.POWERS:
        half = term.nodes[0] * np.array(POWER_NODES)
        return np.concatenate([-half[::-1], [0.0], half])
    return np.array([np.nextafter(term.nodes[0], -np.inf), term.nodes[0]]) if term.form is Form.STEP else np.ones(1)


def statement_of(term: Term, table: Table) -> str:
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
        f"{share:.0%} of it {word}" for share, word in zip(shares, ("once", "twice", "three times"), strict=True)
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
    return f"{share:.0%} of it odd in the velocity"


def _shown(value: float, unit: str) -> str:
    return format_quantity(float(value), unit)


def period_words(order: float, radius: float) -> str:
    """A period in revolutions and in travel; `radius` is the travel per motor angle [m/rad]."""
    return f"{_shown(2 * np.pi * radius / order, 'm')} of travel ({order:.4g} per revolution of the motor)"


def is_locked(order: float) -> bool:
    """Whether a period goes whole times into a revolution of the motor."""
    return round(order) >= 1 and abs(order - round(order)) < WHOLE * max(1.0, 0.2 * order)


def in_travel(table: Table, radius: float) -> Table:
    """A table over the motor angle as one over the table position; `radius` is the travel per motor angle [m/rad]."""
    breakpoints = tuple(radius * at for at in table.breakpoints)
    return replace(table, breakpoints=breakpoints, breakpoint_unit="m", period=radius * table.period)


def seen_on(views: Sequence[View], found: Found, left: FloatArray) -> Seen:
    """Means of what is left, the term itself put back, over the variable of a term.

    Args:
        views: judged recordings.
        found: the term.
        left: residual less all terms, at the rows of all views, (m,).
    """
    term = found.term
    at = np.concatenate([view.values[term.variable][view.rows] for view in views])
    if term.form is Form.SINE:
        at = np.mod(at, term.nodes[0])
    factor = np.ones(len(at))
    if term.times:
        factor = np.concatenate([view.values[term.times][view.rows] for view in views])
    own = np.vstack([view.columns(term) for view in views]) @ found.values
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
