"""Which points a table has: at round distances, as many as the control takes and the shortest period wants."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from feeddrive.compensation.forms.all_forms import as_held
from feeddrive.compensation.forms.control import Control
from feeddrive.compensation.table import CompensationTable, Deviations, fitted, grid, stepped
from feeddrive.errors import InputError
from feeddrive.units.quantity import format_quantity

POINTS_PER_PERIOD = 16
"""Wished for per period of a lead error: straight pieces of least squares then leave 0.8 % of a sine, 8 leave 3 %."""

_NICE = (1.0, 1.2, 1.5, 1.6, 2.0, 2.5, 3.0, 3.2, 4.0, 5.0, 6.0, 8.0)


def table_for(
    wanted: Control,
    known: Deviations,
    stroke: tuple[float, float],
    reference: float,
    every: float | None,
    shortest: float,
) -> CompensationTable:
    """The table of a control along a stroke.

    Args:
        wanted: that reads it.
        known: deviations.
        stroke: least and greatest position [m].
        reference: where the axis is referenced [m].
        every: distance of the points [m]; chosen if None.
        shortest: period of the deviations along the stroke [m]; infinite where none is known.

    Raises:
        InputError: more points than the control takes, or beyond its limits.
    """
    width = max(stroke[1], reference) - min(stroke[0], reference)
    step = every if every is not None else _step(wanted, width, shortest)
    points = grid(stroke, step, reference)
    _refuse_too_many(wanted, points, width)
    return as_held(wanted, (stepped if wanted.stepwise else fitted)(known, points, reference, step))


def _refuse_too_many(wanted: Control, points: Sequence[float] | np.ndarray, width: float) -> None:
    if len(points) > wanted.most_points:
        least = format_quantity(_nice_above(width / (wanted.most_points - 2)), "m")
        what = f"{len(points)} points, and {wanted.title} takes {wanted.most_points}"
        raise InputError(what, wanted.name, f"write --every {least} or more, or a shorter stroke")


def _step(wanted: Control, width: float, shortest: float) -> float:
    """The distance of points for the shortest period, as the control's points allow; 25 pieces where none is known."""
    least = _nice_above(width / (wanted.usual_points - 2))
    wished = shortest / POINTS_PER_PERIOD if math.isfinite(shortest) else width / 25
    return min(max(least, _nice_below(wished)), _nice_below(width))


def _nice_above(length: float) -> float:
    """The next round length that is not smaller [m]."""
    power = 10.0 ** math.floor(math.log10(length))
    return next(one * power for one in (*_NICE, 10.0) if one * power >= length * (1 - 1e-9))


def _nice_below(length: float) -> float:
    """The next round length that is not larger [m]."""
    power = 10.0 ** math.floor(math.log10(length))
    return next(one * power for one in reversed((*_NICE, 10.0)) if one * power <= length * (1 + 1e-9))
