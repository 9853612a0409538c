"""Functions of measured variables that what is left of a recording may follow, and which of them are tried."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from feeddrive.diagnosis.starts.sines import strongest_orders
from feeddrive.diagnosis.unexplained.sine_order import SineOrder
from feeddrive.diagnosis.unexplained.view import View
from feeddrive.typing import FloatArray

HARMONICS = 3
"""Sines of a periodic term: the order itself, twice and three times it."""


NODES = (8, 16, 32, 64)
"""Breakpoints tried over the stroke."""

SPEEDS = ((0.05, 0.2, 0.5, 1.0), (0.01, 0.03, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0))
"""Breakpoints over the velocity, either side of rest, as shares of the highest."""

SECONDS_A_NODE = 2.0
"""Time between breakpoints of a trend [s], four blocks, so that a block left out is spanned by its neighbours."""

STEPS = 32
"""Moments at which a step is tried."""

LEAST_TURNS = 2.0
"""Revolutions below which position and angle are one."""

SINES = 3
"""Peaks of the periodogram that are tried."""

FEW = 20
"""Samples that a breakpoint must see."""

Values = dict[str, FloatArray]


class Form(StrEnum):
    """What kind of function a term is."""

    CURVE = "curve"
    SINE = "periodic"
    STEP = "step"
    POWERS = "powers"
    LEVEL = "level"


@dataclass(frozen=True)
class Term:
    """A function of one variable, times a second one where `times` names it.

    Attributes:
        form: of the function.
        variable: whose function it is.
        times: factor, as "direction" or "table_velocity"; empty for none.
        nodes: breakpoints of a curve, the place of a step, the angle [rad] of one period of a sine, the largest value
            of powers; none for a level, which is the variable itself.
    """

    form: Form
    variable: str
    times: str = ""
    nodes: tuple[float, ...] = ()

    @property
    def size(self) -> int:
        """Number of columns."""
        return {Form.SINE: 2 * HARMONICS, Form.CURVE: len(self.nodes), Form.POWERS: 4}.get(self.form, 1)

    def columns(self, values: Mapping[str, FloatArray]) -> FloatArray:
        """The functions whose sum the term is, (n, size).

        Args:
            values: variable to its series, (n,), SI.
        """
        at = values[self.variable]
        if self.form is Form.CURVE:
            shape = hats(at, self.nodes)
        elif self.form is Form.STEP:
            shape = (at >= self.nodes[0]).astype(float)[:, None]
        elif self.form is Form.SINE:
            angles = 2 * np.pi * np.outer(at / self.nodes[0], np.arange(1, HARMONICS + 1))
            shape = np.hstack([np.sin(angles), np.cos(angles)])
        elif self.form is Form.POWERS:
            share = at / self.nodes[0]
            shape = np.column_stack([share, np.abs(share), share * np.abs(share), share**2])
        else:
            shape = at[:, None]
        return shape * values[self.times][:, None] if self.times else shape


def columns_in(view: View, term: Term) -> FloatArray:
    """Columns of a term as the recording would show them: in the band, at the rows that count, (m, k)."""
    evidence = view.evidence
    if term not in view.shown:
        # one by one, and thinned at once, which bounds the memory of long recordings
        columns = [evidence.thinly_in_band(column) for column in term.columns(view.values).T]
        view.shown[term] = np.column_stack(columns)
    return view.shown[term][view.rows[:: evidence.thinning]]


def hats(at: FloatArray, nodes: tuple[float, ...]) -> FloatArray:
    """Hat functions of a table that is linear between its nodes and constant outside, (n, k)."""
    result = np.zeros((len(at), len(nodes)))
    if len(nodes) == 1:
        return result + 1.0
    clipped = np.clip(at, nodes[0], nodes[-1])
    left = np.clip(np.searchsorted(nodes, clipped, side="right") - 1, 0, len(nodes) - 2)
    points = np.array(nodes)
    share = (clipped - points[left]) / (points[left + 1] - points[left])
    rows = np.arange(len(at))
    result[rows, left] = 1 - share
    result[rows, left + 1] += share
    return result


def terms_of(views: Sequence[View]) -> list[Term]:
    """Curves, levels and steps over the variables of these recordings."""
    common = [name for name in views[0].values if all(name in view.values for view in views)]
    seen = {name: np.concatenate([view.values[name][view.rows] for view in views]) for name in common}
    if "table_velocity" not in seen:
        return [*_curves(seen, "time", "", _trend(seen)), *_plain(seen)]
    terms = [Term(Form.LEVEL, "direction")] if np.ptp(seen["direction"]) > 1 else []
    for count in NODES:
        for times in ("", "direction"):
            terms += _curves(seen, "table_position", times, _even(seen["table_position"], count))
    terms += _curves(seen, "table_position", "table_velocity", _even(seen["table_position"], NODES[0]))
    fastest = float(np.abs(seen["table_velocity"]).max())
    terms += [Term(Form.POWERS, "table_velocity", "", (fastest,))] if fastest > 0 else []
    for shares in SPEEDS:
        half = fastest * np.array(shares)
        terms += _curves(seen, "table_velocity", "", np.concatenate([-half[::-1], [0.0], half]))
    for name in sorted(seen.keys() & {"table_acceleration", "predicted_torque"}):
        for times in ("", "direction"):
            terms += _curves(seen, name, times, np.unique(np.quantile(seen[name], np.linspace(0.005, 0.995, 7))))
    farthest = float(seen["travel_since_reversal"].max())
    terms += _curves(
        seen, "travel_since_reversal", "direction", np.concatenate([[0.0], np.geomspace(1e-5, 1.0, 10) * farthest])
    )
    for times in ("", "direction", "table_velocity"):
        terms += _curves(seen, "time", times, _trend(seen))
    return [*terms, *_steps(seen)]


def _plain(seen: Values) -> list[Term]:
    """Curves over whatever variables a slow recording has."""
    names = [name for name in seen if name != "time"]
    return [t for n in names for t in _curves(seen, n, "", np.unique(np.quantile(seen[n], np.linspace(0, 1, 6))))]


def _trend(seen: Values) -> FloatArray:
    span = float(np.ptp(seen["time"]))
    count = int(np.clip(span / SECONDS_A_NODE, 3, 12)) + 1
    return float(seen["time"].min()) + span * np.linspace(0, 1, count)


def _even(values: FloatArray, count: int) -> FloatArray:
    low, high = np.quantile(values, [0.001, 0.999])
    return np.linspace(low, high, count)


def _curves(seen: Values, name: str, times: str, nodes: FloatArray) -> list[Term]:
    """The curve over those breakpoints that see enough samples; none where the variable hardly changes."""
    if not np.ptp(seen[name]) > 0 or len(nodes) < 2 or not np.all(np.diff(nodes) > 0):
        return []
    edges = np.concatenate([[-np.inf], 0.5 * (nodes[1:] + nodes[:-1]), [np.inf]])
    kept = nodes[np.histogram(seen[name], edges)[0] >= min(FEW, len(seen[name]) // (3 * len(nodes)))]
    return [Term(Form.CURVE, name, times, tuple(kept.tolist()))] if len(kept) > 1 else []


def _steps(seen: Values) -> list[Term]:
    moments = seen["time"].min() + np.ptp(seen["time"]) * np.linspace(0, 1, STEPS + 2)[1:-1]
    return [Term(Form.STEP, "time", times, (float(t),)) for t in moments for times in ("", "direction")]


def sines(views: Sequence[View]) -> Callable[[FloatArray], list[Term]]:
    """Suggests sines over the motor angle from what is left of the longest recording."""
    longest = int(np.argmax([view.rows.sum() for view in views]))
    view = views[longest]
    first = sum(int(v.rows.sum()) for v in views[:longest])
    if "motor_angle" not in view.values:
        return lambda left: []
    angle, direction = view.values["motor_angle"][view.rows], view.values["direction"][view.rows]
    highest, orders = _highest(view), SineOrder(angle)

    def suggest(left: FloatArray) -> list[Term]:
        own = left[first : first + len(angle)]
        result = []
        for times, series in (("", own), ("direction", own * direction)):
            for order in strongest_orders(angle, series, highest, SINES):
                better = orders.near(order, series)
                result.append(Term(Form.SINE, "motor_angle", times, (2 * np.pi / better,)))
        return result

    return suggest


def _highest(view: View) -> float:
    """Order that meets half the sample rate at the highest speed."""
    step = view.evidence.recording.sample_time
    fastest = float(np.abs(np.diff(view.values["motor_angle"])).max()) / step
    return float(np.pi / step / fastest) if fastest > 0 else 1.0


def finer_steps(views: Sequence[View]) -> Callable[[Term], list[Term]]:
    """A term to finer ones of its form: a step to those between its neighbours, others to none."""
    seen = np.concatenate([view.values["time"][view.rows] for view in views])
    gap = float(np.ptp(seen)) / (STEPS + 1)

    def refine(term: Term) -> list[Term]:
        if term.form is not Form.STEP:
            return []
        moments = term.nodes[0] + gap * np.linspace(-1, 1, 21)
        return [Term(Form.STEP, term.variable, term.times, (float(t),)) for t in moments]

    return refine
