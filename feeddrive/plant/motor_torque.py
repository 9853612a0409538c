"""What the motor makes of the torque that it is asked for, and the other way round.

    T_acts = T (1 - c T^2)  for |T| <= T_top = 1 / sqrt(3 c), and its value at T_top beyond
    T = 2 / sqrt(3 c) sin(asin(3/2 sqrt(3 c) T_acts) / 3)

| symbol | meaning | unit |
|---|---|---|
| T | torque asked for: torque constant times current; this is what drives record | N m |
| T_acts | torque that acts | N m |
| c | sum of the droops of all drive effects | 1/(N m)^2 |

The inverse is that of 3 sin a - 4 sin^3 a = sin 3 a. Torque that no current reaches, |T_acts| > 2/3 T_top, is answered
with T_top.
"""

from __future__ import annotations

import math
import warnings

import casadi as ca
import numpy as np

from feeddrive.effects.base import DriveEffect
from feeddrive.errors import ValidityWarning
from feeddrive.plant.plant import Plant
from feeddrive.plant.symbols import Symbols
from feeddrive.typing import Expression, FloatArray
from feeddrive.units.quantity import format_quantity

_NONE = 1e-30
"""A droop [1/(N m)^2] that no torque shows; keeps T_top finite."""


def acting_torque(plant: Plant, symbols: Symbols, asked: Expression) -> Expression:
    """Torque that acts [N m] where `asked` [N m] is asked for; the same expression where nothing droops."""
    effects = [effect for effect in plant.effects if isinstance(effect, DriveEffect)]
    if not effects:
        return asked
    return _acting(asked, sum(effect.droop(symbols.effects[effect.label]) for effect in effects))


def acting_torques(plant: Plant, asked: FloatArray) -> FloatArray:
    """Torque that acts [N m] where `asked` [N m] is asked for, shape (n,)."""
    droop = _droop(plant)
    return np.array(ca.DM(_acting(ca.DM(asked), droop)))[:, 0] if droop else asked


def asked_torques(plant: Plant, acting: FloatArray) -> FloatArray:
    """Torque that must be asked for, so that `acting` [N m] acts, shape (n,)."""
    droop = _droop(plant)
    if not droop:
        return acting
    root = math.sqrt(3 * droop)
    asked: FloatArray = 2 / root * np.sin(np.arcsin(np.clip(1.5 * root * acting, -1.0, 1.0)) / 3)
    return asked


def warn_beyond_top(plant: Plant, asked: FloatArray) -> None:
    """Warn where more torque is asked for than the motor can make [N m], shape (n,)."""
    droop, most = _droop(plant), float(np.max(np.abs(asked), initial=0.0))
    top = 1 / math.sqrt(3 * droop + _NONE)
    if most > top:
        told, given = (format_quantity(value, "N m") for value in (most, top))
        text = f"{plant.name}: {told} is asked for, and with its droop the torque rises no further beyond {given}"
        warnings.warn(text, ValidityWarning, stacklevel=4)


def _acting(asked: Expression, droop: Expression) -> Expression:
    top = 1 / ca.sqrt(3 * droop + _NONE)
    within = ca.fmax(ca.fmin(asked, top), -top)
    return within * (1 - droop * within**2)


def _droop(plant: Plant) -> float:
    return float(sum(e.droop(e.values) for e in plant.effects if isinstance(e, DriveEffect)))
