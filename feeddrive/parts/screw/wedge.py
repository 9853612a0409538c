"""Efficiency of a screw as a wedge with sliding friction: driving, back-driving, self-locking.

    eta_forward = (1 - mu tan beta) / (1 + mu / tan beta)     torque moves the table
    eta_back    = (1 - mu / tan beta) / (1 + mu tan beta)     force on the table turns the screw
    tan beta    = L / (pi d)

| symbol | meaning | unit |
|---|---|---|
| mu | coefficient of friction at the thread; for a ball screw the equivalent of all rolling losses | 1 |
| beta | lead angle at the diameter d | rad |

Valid for full sliding at one mu.
A square thread is taken; the contact angle of balls is inside their equivalent mu. Source: textbook statics; paper 004,
section 2, draws on it for "95 to 98 %".
"""

from __future__ import annotations

import math

from feeddrive.parts.values import PartValue, check_values

_VALUES = (
    PartValue("friction_coefficient", "1", 0.0, 2.0, usual=(0.0, 0.5), open_ends=False),
    PartValue("lead", "m", 1e-4, 0.5, usual=(1e-3, 0.08)),
    PartValue("diameter", "m", 1e-3, 0.5, usual=(4e-3, 0.2)),
)


def wedge_efficiency(friction_coefficient: float, lead: float, diameter: float) -> float:
    """eta_forward [1] from mu [1], lead and diameter at the contact [m]; 0 where friction stops any torque."""
    mu, slope = _checked(friction_coefficient, lead, diameter)
    return max(0.0, (1.0 - mu * slope) / (1.0 + mu / slope))


def wedge_back_driving_efficiency(friction_coefficient: float, lead: float, diameter: float) -> float:
    """eta_back: power at the screw over power at the table [1]; negative where the screw locks itself.

    Arguments and errors as `wedge_efficiency`.
    """
    mu, slope = _checked(friction_coefficient, lead, diameter)
    return (1.0 - mu / slope) / (1.0 + mu * slope)


def self_locking(friction_coefficient: float, lead: float, diameter: float) -> bool:
    """Whether no force on the table turns the screw: mu >= tan beta. Arguments and errors as `wedge_efficiency`."""
    return wedge_back_driving_efficiency(friction_coefficient, lead, diameter) <= 0.0


def self_locking_lead(friction_coefficient: float, diameter: float) -> float:
    """The largest lead that locks itself, mu pi d [m]; arguments and errors as `wedge_efficiency`."""
    given = {"friction_coefficient": friction_coefficient, "diameter": diameter}
    check_values("screw", (_VALUES[0], _VALUES[2]), given)
    return friction_coefficient * math.pi * diameter


def _checked(friction_coefficient: float, lead: float, diameter: float) -> tuple[float, float]:
    """mu and tan beta of checked values."""
    given = {"friction_coefficient": friction_coefficient, "lead": lead, "diameter": diameter}
    check_values("screw", _VALUES, given)
    return friction_coefficient, lead / (math.pi * diameter)
