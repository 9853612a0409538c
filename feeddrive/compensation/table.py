"""The one internal table, from which the tables of all controls are written.

    d(p) = actual minus target position, as ISO 230-2 counts deviations; its mean over both directions is 0 at the
    reference

| symbol | meaning | unit |
|---|---|---|
| p | target position, as the control indicates it | m |
| d+, d- | deviation when the target is approached along + and along - | m |

A table is the piecewise straight line of least squares through what is known along the whole stroke, not the deviation
at its points alone: an error of shorter period than the points resolve is then left as it is, and not folded into a
slow one that is not there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from feeddrive.errors import InputError
from feeddrive.metrology.finite import refuse_unknown
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity

PER_INTERVAL = 16
"""Places per interval of a table at which the deviation is looked at; a sine of that many has 0.6 % of error."""

STEEPEST = 0.1
"""Deviation per length that no screw has, 100 mm/m: a slip of a unit. No control at hand has a limit beyond it."""


@dataclass(frozen=True, eq=False)
class Deviations:
    """Deviations of an axis along its stroke, actual minus target.

    Attributes:
        positions: ascending, shape (n,) [m].
        forward, reverse: approached along + and along -, shape (n,) [m].
    """

    positions: FloatArray
    forward: FloatArray
    reverse: FloatArray

    def __post_init__(self) -> None:
        shapes = {np.shape(one) for one in (self.positions, self.forward, self.reverse)}
        if len(shapes) != 1 or np.ndim(self.positions) != 1 or len(self.positions) < 2:
            raise InputError("is not two positions or more with one value a direction", "deviations", "give arrays")
        refuse_unknown("deviations", positions=self.positions, forward=self.forward, reverse=self.reverse)
        if np.any(np.diff(self.positions) <= 0):
            raise InputError("the positions do not ascend", "deviations", "sort them, each once")

    @property
    def mean(self) -> FloatArray:
        """Mean of both directions, shape (n,) [m]."""
        return np.asarray(0.5 * (self.forward + self.reverse))

    def zeroed(self, reference: float) -> Deviations:
        """The deviations counted from the mean of both directions at a reference position [m]."""
        offset = float(np.interp(reference, self.positions, self.mean))
        return Deviations(self.positions, self.forward - offset, self.reverse - offset)


def measured(programmed: FloatArray, forward: FloatArray, reverse: FloatArray) -> Deviations:
    """Deviations from positions that were measured, all (n,) [m]: programmed, and actual in both directions."""
    return Deviations(programmed, forward - programmed, reverse - programmed)


@dataclass(frozen=True, eq=False)
class CompensationTable:
    """A table: straight between its points, constant beyond them.

    Attributes:
        positions: ascending, shape (k,) [m].
        forward, reverse: deviations, actual minus target, shape (k,) [m].
        reference: where the axis is referenced [m].
        step: distance of the points [m]; 0 where it is not even.
    """

    positions: FloatArray
    forward: FloatArray
    reverse: FloatArray
    reference: float
    step: float = 0.0

    def __post_init__(self) -> None:
        Deviations(self.positions, self.forward, self.reverse)
        if self.steepest > STEEPEST:
            what = f"the deviation changes by {1e3 * self.steepest:.3g} mm/m between two points"
            raise InputError(what, "compensation table", "check the units, or take points further apart")

    def __len__(self) -> int:
        return len(self.positions)

    @property
    def steepest(self) -> float:
        """Largest change between neighbouring points over their distance [m/m]."""
        width = np.diff(self.positions)
        return float(max(np.max(np.abs(np.diff(one)) / width) for one in (self.forward, self.reverse)))

    @property
    def directions_differ(self) -> bool:
        """Whether the two directions have other values."""
        return bool(np.any(self.forward != self.reverse))

    @property
    def mean(self) -> FloatArray:
        """Mean of both directions, shape (k,) [m]."""
        return np.asarray(0.5 * (self.forward + self.reverse))

    @property
    def play(self) -> float:
        """Mean of reverse less forward [m]: the play that the table takes away."""
        return float(np.mean(self.reverse - self.forward))

    def at(self, positions: FloatArray, reverse: bool = False, stepwise: bool = False) -> FloatArray:
        """Deviation that the table holds at positions [m], one direction; with `stepwise` that of the nearest point."""
        if stepwise:
            middles = 0.5 * (self.positions[1:] + self.positions[:-1])
            positions = self.positions[np.searchsorted(middles, positions, side="right")]
        return np.interp(positions, self.positions, self.reverse if reverse else self.forward)

    def rounded(self, resolution: float) -> CompensationTable:
        """The table in whole steps of a control [m]."""
        forward, reverse = (resolution * np.round(one / resolution) for one in (self.forward, self.reverse))
        return CompensationTable(self.positions, forward, reverse, self.reference, self.step)


def grid(stroke: tuple[float, float], step: float, reference: float) -> FloatArray:
    """Points at whole steps from the reference that cover a stroke, (k,) [m]; the reference is among them, all in m.

    From a reference beyond the stroke the points reach as far. Raises InputError: a step that is not above zero or
    longer than the stroke, or more points than memory is worth.
    """
    low, high = min(stroke[0], reference), max(stroke[1], reference)
    if not 0 < step <= stroke[1] - stroke[0]:
        what = f"points every {format_quantity(step, 'm')} on a stroke of {format_quantity(stroke[1] - stroke[0], 'm')}"
        raise InputError(what, "every", "write a distance above zero, within the stroke")
    slack = 1e-6  # of a step: rounding of positions that are whole steps apart
    first, last = math.floor((low - reference) / step + slack), math.ceil((high - reference) / step - slack)
    if last - first > 100_000:
        raise InputError(f"{last - first + 1} points", "every", "check the unit; no control takes so many")
    return np.asarray(reference + step * np.arange(first, last + 1))


def fitted(deviations: Deviations, positions: FloatArray, reference: float, step: float = 0.0) -> CompensationTable:
    """The table of least squares at ascending positions, (k,) [m], with the mean at the reference [m] set to 0.

    Deviations are straight between their positions; `step` is the distance of the points where it is even [m].
    """
    inner = [np.linspace(a, b, PER_INTERVAL, endpoint=False) for a, b in pairwise(positions.tolist())]
    places = np.unique(np.concatenate([*inner, positions[-1:], _within(deviations.positions, positions)]))
    values = [np.interp(places, deviations.positions, one) for one in (deviations.forward, deviations.reverse)]
    forward, reverse = (straight_pieces(places, one, positions, np.gradient(places)) for one in values)
    offset = 0.5 * float(np.interp(reference, positions, forward) + np.interp(reference, positions, reverse))
    return CompensationTable(positions, forward - offset, reverse - offset, reference, step)


def stepped(deviations: Deviations, positions: FloatArray, reference: float, step: float = 0.0) -> CompensationTable:
    """The table for a control that holds the value of a point up to the middle between two; otherwise as `fitted`.

    Each value lies midway between the largest and the least deviation of its stretch: nothing leaves less there.
    """
    middles = 0.5 * (positions[1:] + positions[:-1])
    inner = [np.linspace(a, b, PER_INTERVAL + 1) for a, b in pairwise(positions.tolist())]
    places = np.unique(np.concatenate([*inner, middles, _within(deviations.positions, positions)]))
    values = [np.interp(places, deviations.positions, one) for one in (deviations.forward, deviations.reverse)]
    ends = np.searchsorted(places, middles)
    first, last = np.concatenate([[0], ends]), np.concatenate([ends, [len(places) - 1]])
    forward, reverse = (
        np.array([0.5 * (np.max(one[a : b + 1]) + np.min(one[a : b + 1])) for a, b in zip(first, last, strict=True)])
        for one in values
    )
    offset = 0.5 * float(np.interp(reference, positions, forward) + np.interp(reference, positions, reverse))
    return CompensationTable(positions, forward - offset, reverse - offset, reference, step)


def _within(places: FloatArray, ends: FloatArray) -> FloatArray:
    return np.asarray(places[(places >= ends[0]) & (places <= ends[-1])])


def straight_pieces(
    places: FloatArray, values: FloatArray, nodes: FloatArray, weights: FloatArray | None = None
) -> FloatArray:
    """Values at ascending nodes, (k,), whose straight pieces meet values at places, (n,), in weighted least squares.

    Raises InputError for a node that no place tells of.
    """
    from scipy.linalg import LinAlgError, solveh_banded  # late: takes a moment to import

    cell = np.clip(np.searchsorted(nodes, places, side="right") - 1, 0, len(nodes) - 2)
    share = np.clip((places - nodes[cell]) / (nodes[cell + 1] - nodes[cell]), 0.0, 1.0)
    weight = np.ones_like(places) if weights is None else weights
    count = len(nodes)
    left, right = weight * (1 - share), weight * share
    diagonal = np.bincount(cell, left * (1 - share), count) + np.bincount(cell + 1, right * share, count)
    beside = np.bincount(cell, left * share, count)
    wanted = np.bincount(cell, left * values, count) + np.bincount(cell + 1, right * values, count)
    banded = np.vstack([np.append(0.0, beside[:-1]), diagonal])
    empty = np.flatnonzero(diagonal <= 1e-9 * diagonal.max())
    if len(empty):
        where = format_quantity(float(nodes[empty[0]]), "m")
        raise InputError(f"nothing is known about {where}", "every", "take points further apart, or a shorter stroke")
    try:
        return np.asarray(solveh_banded(banded, wanted))
    except LinAlgError:
        mend = "take points further apart, or a shorter stroke"
        raise InputError("too little is known for so many points", "every", mend) from None
