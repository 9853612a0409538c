"""The thermal error of the table along the stroke, and what a compensation leaves of it.

    e(x) = u(x),  the displacement of the screw where the nut stands (`thermal.expansion`)

Sign: actual minus commanded position, as ISO 230-3 measures it; a screw that grows away from its front bearing gives
e > 0. It is the error of an axis that reads its position from the motor; a linear scale does not see this part. It
counts from the cold start, when the whole machine has the temperature of its surroundings; the bed is taken as still.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse

from feeddrive.errors import InputError
from feeddrive.thermal.laws.expansion import growths
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.parametric_model import HeatModel
from feeddrive.thermal.rig import refuse_unless
from feeddrive.typing import FloatArray

POSITIONS = 9
"""Places along the stroke, ends and middle among them: the error is smooth, more change its mean square by < 1 %."""


@dataclass(frozen=True, eq=False)
class TableError:
    """The error at places along the stroke as a linear output of a heat model.

    Attributes:
        positions: x of the nut's centre from the front end, (p,) [m].
        rows: from states to errors, (p, n) [m per state].
    """

    positions: FloatArray
    rows: FloatArray

    def of(self, states: FloatArray) -> FloatArray:
        """Errors (k, p) [m] of states (k, n)."""
        return np.asarray(states @ self.rows.T)


def table_error(heat: Heat, model: HeatModel, count: int = POSITIONS) -> TableError:
    """The error along the plant's travel.

    Args:
        heat: the machine.
        model: its full or a reduced model.
        count: of places, evenly from end to end of the travel.

    Raises:
        InputError: fewer than two places.
    """
    refuse_unless(count >= 2, f"{count} places make no line", "count", "write at least 2")
    positions = np.linspace(heat.rig.travel.low, heat.rig.travel.high, count)
    profile = model.profile.toarray() if sparse.issparse(model.profile) else model.profile
    return TableError(positions, growths(heat.rig, profile.T, model.edges, positions).T)


@dataclass(frozen=True)
class LeftOver:
    """Error before and after a compensation, over all times and places.

    Attributes:
        rms_before, rms_after: root of the mean square [m].
        largest_before, largest_after: largest magnitude [m].
    """

    rms_before: float
    rms_after: float
    largest_before: float
    largest_after: float

    @property
    def rms_factor(self) -> float:
        """How many times smaller the rms is than without compensation."""
        return self.rms_before / self.rms_after if self.rms_after > 0 else float("inf")

    @property
    def largest_factor(self) -> float:
        """How many times smaller the largest error is than without compensation."""
        return self.largest_before / self.largest_after if self.largest_after > 0 else float("inf")


def left_over(error: FloatArray, compensation: FloatArray) -> LeftOver:
    """What is left of an error, (k, p), after a compensation that estimates it, (k, p) [m].

    Raises:
        InputError: arrays of unequal shape, or without values.
    """
    if np.shape(error) != np.shape(compensation) or np.size(error) == 0:
        what = f"errors of shape {np.shape(error)} and a compensation of shape {np.shape(compensation)}"
        raise InputError(what, "compensation", "give one value for each error")
    after = error - compensation
    return LeftOver(_rms(error), _rms(after), float(np.abs(error).max()), float(np.abs(after).max()))


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
