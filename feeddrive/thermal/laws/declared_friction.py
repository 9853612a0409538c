"""Friction of nut and bearings for the heat of a machine, from what the same file declares about its motion.

    T_1 = level without load,    f_0 from T_v ω^(2/3) = 1e-7 f_0 (ν N)^(2/3) d_m³       [N mm, mm²/s, rev/min, mm]

| symbol | meaning | unit |
|---|---|---|
| T_1, T_v | of `nut_friction`, `nut_drag`, `bearing_drag` (both ends in one) | N m, N m/(rad/s)^(2/3) |
| f_0, ν, d_m | as in `thermal.friction`; ν of the coupling's oils, d_m the screw's pitch circle | 1, m²/s, m |

Only the product of f_0 and d_m³ is known of a drag, and only that acts. Valid above ν N = 2000, where Palmgren's law
has the power 2/3; below it the lubricant's part is that of a slow bearing, a few per cent of the load's.
"""

from __future__ import annotations

from collections.abc import Sequence

from feeddrive.effects.base import Effect, FrictionEffect, Motion, number
from feeddrive.effects.friction.nut_friction import NutFriction
from feeddrive.effects.friction.shaft_drag import BearingDrag, NutDrag
from feeddrive.parts.bearings.bearing_friction import palmgren_torque
from feeddrive.thermal.laws.friction import Friction
from feeddrive.thermal.thermal_coupling import Coupling

_FAST = 1e3
"""A speed in the range of the power 2/3 for any oil [rad/s]."""


def nut_of(
    effects: Sequence[Effect], coupling: Coupling, ambient: float, diameter: float, lead: float
) -> Friction | None:
    """Friction of the nut; None where no effect declares it.

    Args:
        effects: of the motion.
        coupling: whose oil it has.
        ambient: for which friction is declared [degC].
        diameter: d_m [m].
        lead: [m/rad].
    """
    own = [effect for effect in effects if type(effect) in (NutFriction, NutDrag)]
    return _friction(own, coupling.nut_oil.viscosity(ambient), diameter, lead, 1.0)


def bearings_of(
    effects: Sequence[Effect], coupling: Coupling, ambient: float, diameter: float
) -> tuple[Friction | None, Friction | None]:
    """Friction of the front and of the rear bearing; arguments as `nut_of`."""
    own = [effect for effect in effects if type(effect) is BearingDrag]
    ν, rear = coupling.bearing_oil.viscosity(ambient), coupling.rear_share
    front, back = (_friction(own, ν, diameter, 0.0, share) for share in (1 - rear, rear))
    return front, back


def _friction(
    effects: Sequence[Effect], viscosity: float, diameter: float, lead: float, share: float
) -> Friction | None:
    if not effects or share == 0:
        return None
    turning = Motion(0.0, 1.0, 0.0, 0.0, lead)
    load = sum(float(e.level(turning, e.values)) for e in effects if isinstance(e, FrictionEffect))
    viscous = sum(number(e.values["viscous"]) for e in effects)
    of_one = float(palmgren_torque(1.0, viscosity, _FAST, diameter)) / _FAST ** (2 / 3)
    return Friction(share * load, share * viscous / of_one, viscosity, diameter)
