"""Compensation from a model alone: the temperatures follow from the speed that the controller knows.

It is only as good as the declared heats and films: 10 % of heat are 10 % of the error, and air that warms unseen goes
through in full. It costs no sensor, and it is the prediction inside the observer (`thermal_observer`).
"""

from __future__ import annotations

from feeddrive.compensation.heat.thermal_error import TableError
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.parametric_model import HeatModel, Path
from feeddrive.thermal.reduced.reduction import Sizes, reduce_model
from feeddrive.thermal.run.warm_up import declared_rows, run
from feeddrive.typing import FloatArray

ORDER = 16
"""States of the model: within 30 nm of the full one on a duty of the bench (11 nm rms), so that the filter's noise
outweighs it. 10 states are within 0.2 µm (83 nm rms), which three sensors would take for heat; 36 within 1 nm."""

_FILMS = 1.25
"""Range of the films beyond that from rest to the highest speed: the tolerance twice, and some."""


def compensation_model(heat: Heat, order: int = ORDER, sizes: Sizes | None = None) -> HeatModel:
    """The reduced model that a compensation runs: its films may vary with speed, its contact is the declared one.

    Args:
        heat: the machine.
        order: number of states.
        sizes: working sizes; None for those of a small axis.

    Raises:
        InputError: an order that is not possible.
    """
    limits = dict(heat.limits(_FILMS))
    limits[Path.CONTACT] = (heat.contact, heat.contact)
    limits[Path.COOLING] = (0.0, 0.0)
    return reduce_model([heat.full_model()], limits, order, sizes)[0]


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
