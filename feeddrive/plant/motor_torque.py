"""What the motor makes of the torque that it is asked for, and the other way round.

    T = T_asked / g
    T_acts = T (1 - c T^2)  for |T| <= T_top = 1 / sqrt(3 c), and its value at T_top beyond
    T = 2 / sqrt(3 c) sin(asin(3/2 sqrt(3 c) T_acts) / 3)

| symbol | meaning | unit |
|---|---|---|
| T_asked | torque asked for: the drive's torque constant times current; this is what drives record | N m |
| g | product of the gains of all drive effects: torque constant of the drive over that of the motor | 1 |
| T | torque before droop | N m |
| T_acts | torque that acts | N m |
| c | sum of the droops of all drive effects | 1/(N m)^2 |

The inverse is that of 3 sin a - 4 sin^3 a = sin 3 a. Torque that no current reaches, |T_acts| > 2/3 T_top, is answered
with T_top.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping

import casadi as ca
import numpy as np

from feeddrive.effects.base import DriveEffect, Parameter, Signature
from feeddrive.errors import ValidityWarning
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import Symbols
from feeddrive.typing import Expression, FloatArray
from feeddrive.units.quantity import format_quantity

_NONE = 1e-30
"""A droop [1/(N m)^2] that no torque shows; keeps T_top finite."""


class TorqueGain(DriveEffect):
    """A torque constant other than the drive's: the torque that is recorded over the one that acts.

    No finding: `[motor] torque_factor` of a plant file declares it, and recordings calibrate it.
    """

    name = "torque_gain"
    parameters = (Parameter("gain", "1", 0.0, 100.0, size=1.0),)
    signature = Signature(("motor_torque",), "motor torque")
    additive = True

    def gain(self, p: Mapping[str, Expression]) -> Expression:
        """The value itself."""
        return p["gain"]


def acting_torque(plant: Plant, symbols: Symbols, asked: Expression) -> Expression:
    """Torque that acts [N m] where `asked` [N m] is asked for; the same expression where nothing droops."""
    effects = [(one, symbols.effects[one.label]) for one in plant.effects if isinstance(one, DriveEffect)]
    if not effects:
        return asked
    gain = math.prod([effect.gain(p) for effect, p in effects], start=1.0)
    return _acting(asked / gain, sum(effect.droop(p) for effect, p in effects))


def acting_torques(plant: Plant, asked: FloatArray) -> FloatArray:
    """Torque that acts [N m] where `asked` [N m] is asked for, shape (n,)."""
    droop, torque = _droop(plant), asked / declared_gain(plant)
    return np.array(ca.DM(_acting(ca.DM(torque), droop)))[:, 0] if droop else torque


def asked_torques(plant: Plant, acting: FloatArray) -> FloatArray:
    """Torque that must be asked for, so that `acting` [N m] acts, shape (n,)."""
    droop, gain = _droop(plant), declared_gain(plant)
    if not droop:
        return gain * acting
    root = math.sqrt(3 * droop)
    torque: FloatArray = 2 / root * np.sin(np.arcsin(np.clip(1.5 * root * acting, -1.0, 1.0)) / 3)
    return gain * torque


def warn_beyond_top(plant: Plant, asked: FloatArray) -> None:
    """Warn where more torque is asked for than the motor can make [N m], shape (n,)."""
    droop, most = _droop(plant), float(np.max(np.abs(asked), initial=0.0))
    top = declared_gain(plant) / math.sqrt(3 * droop + _NONE)
    if most > top:
        wanted, given = (format_quantity(value, "N m") for value in (most, top))
        text = f"{plant.name}: {wanted} is asked for, and with its droop the torque rises no further beyond {given}"
        warnings.warn(text, ValidityWarning, stacklevel=4)


def _acting(asked: Expression, droop: Expression) -> Expression:
    top = 1 / ca.sqrt(3 * droop + _NONE)
    within = ca.fmax(ca.fmin(asked, top), -top)
    return within * (1 - droop * within**2)


def _droop(plant: Plant) -> float:
    return float(sum(e.droop(e.values) for e in plant.effects if isinstance(e, DriveEffect)))


def droops(plant: Plant) -> bool:
    """Whether torque that acts is not in proportion to what is asked for."""
    return _droop(plant) > 0


def declared_gain(plant: Plant) -> float:
    """Torque that is recorded over the torque before droop."""
    return float(math.prod(e.gain(e.values) for e in plant.effects if isinstance(e, DriveEffect)))
