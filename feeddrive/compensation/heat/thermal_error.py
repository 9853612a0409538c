"""The thermal error of the table along the stroke, and what a compensation leaves of it; what a model alone foretells.

    e(x) = u(x),  the displacement of the screw where the nut stands (`thermal.expansion`)

Sign: actual minus commanded position, as ISO 230-3 measures it; a screw that grows away from its front bearing gives
e > 0. It is the error of an axis that reads its position from the motor; a linear scale does not see this part. It
counts from the cold start, when the whole machine has the temperature of its surroundings; the bed is taken as still.

The model alone takes the temperatures from the speed that the controller knows. It is only as good as the declared
heats and films: 10 % of heat are 10 % of the error, and air that warms unseen goes through in full. It costs no sensor,
and it is the prediction inside the observer (`thermal_observer`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse

from feeddrive.errors import InputError
from feeddrive.thermal.laws.expansion import growths
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.parametric_model import HeatModel, Path
from feeddrive.thermal.reduced.reduction import reduce_model
from feeddrive.thermal.run.warm_up import declared_rows, run
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


def table_error(heat: Heat, model: HeatModel) -> TableError:
    """The error along the plant's travel, of its full or a reduced model."""
    positions = np.linspace(heat.rig.travel.low, heat.rig.travel.high, POSITIONS)
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


ORDER = 16
"""States of the model: within 30 nm of the full one on a duty of the bench (11 nm rms), so that the filter's noise
outweighs it. 10 states are within 0.2 µm (83 nm rms), which three sensors would take for heat; 36 within 1 nm."""

_FILMS = 1.25
"""Range of the films beyond that from rest to the highest speed: the tolerance twice, and some."""


def compensation_model(heat: Heat, order: int = ORDER) -> HeatModel:
    """The reduced model that a compensation runs: its films may vary with speed, its contact is the declared one."""
    limits = dict(heat.limits(_FILMS))
    limits[Path.CONTACT] = (heat.contact, heat.contact)
    limits[Path.COOLING] = (0.0, 0.0)
    return reduce_model([heat.full_model()], limits, order)[0]


def model_alone(
    heat: Heat, model: HeatModel, error: TableError, step: float, speeds: FloatArray, ambient: FloatArray
) -> FloatArray:
    """Error of the table that the model foretells at the end of each row, (k, p) [m].

    Args:
        heat: what the file declares.
        model: on which it runs, such as `compensation_model` gives.
        error: of this model.
        step: length of a row [s].
        speeds: of the screw over each row, (k,) [rad/s].
        ambient: recorded over each row, (k,) [degC]; all the same where it is not recorded.

    Raises:
        InputError: no rows, or series of unequal length.

    Warns:
        ValidityWarning: a speed above the highest that the plant declares.
    """
    return error.of(run(model, declared_rows(heat, step, speeds, ambient)))
