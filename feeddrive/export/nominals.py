"""Typical sizes of the states of an exported model."""

from __future__ import annotations

import numpy as np

from feeddrive.export.nonlinear_model import Model
from feeddrive.typing import FloatArray

_TRAVEL, _VELOCITY = 1e-3, 0.1
"""Nominal travel [m] and velocity [m/s] of the table."""

_STRETCH, _STRETCH_RATE = 1e-6, 1e-3
"""Nominal stretch and bristle deflection [m], and rate of a stretch [m/s]; those of shafts are in proportion."""


def nominals(model: Model) -> FloatArray:
    """Typical size of every state of a model beside the table, from which a solver takes its absolute tolerance, (nx,).

    Args:
        model: as `feeddrive.export.beside_table.beside_table` makes it.
    """
    if model.plant is None:
        return np.array(model.nominal)
    motion = np.abs(np.array(model.plant.chain.rigid_motion(model.plant.chain_values()), dtype=float))
    turning = np.where(motion == 0, 1.0, motion)
    positions, rates = _STRETCH * turning, _STRETCH_RATE * turning
    positions[-1], rates[-1] = _TRAVEL, _VELOCITY
    return np.concatenate([positions, rates, np.full(len(model.states) - 2 * len(motion), _STRETCH)])
