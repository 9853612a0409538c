"""Friction heat of the nut and of the bearings: a part by the load, a part by the lubricant.

    T = T₁ (F/F₀)^1.33 + T_v,    Q = s ω T

| symbol | meaning | unit |
|---|---|---|
| T₁, F₀ | load torque at the reference preload | N m, N |
| T_v | viscous torque, Palmgren's law (`parts.bearing_friction`); of a double nut with f₀κφ for f₀ | N m |
| s | share of ω T that heats screw and nut; the paper's numbers need 0.5 to 0.67 (see `reproduce.paper_002`) | 1 |
| κ, φ | number of nuts, turns of each | 1 |

Source: paper 002, equations (15) to (26), with Harris's factor 1e-7 (N mm) that (23) and (24) lack. (25), (26) print
π N T / 60, half of ω T.

Friction of nut and bearings for the heat of a machine, from what the same file declares about its motion.

    T_1 = level without load,    f_0 from T_v ω^(2/3) = 1e-7 f_0 (ν N)^(2/3) d_m³       [N mm, mm²/s, rev/min, mm]

| symbol | meaning | unit |
|---|---|---|
| T_1, T_v | of `nut_friction`, `nut_drag`, `bearing_drag` (both ends in one) | N m, N m/(rad/s)^(2/3) |
| f_0, ν, d_m | as in `thermal.friction`; ν of the coupling's oils, d_m the screw's pitch circle | 1, m²/s, m |

Only the product of f_0 and d_m³ is known of a drag, and only that acts. Valid above ν N = 2000, where Palmgren's law
has the power 2/3; below it the lubricant's part is that of a slow bearing, a few per cent of the load's.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from feeddrive.effects.base import Effect, FrictionEffect, Motion, number
from feeddrive.effects.friction.nut_friction import NutFriction
from feeddrive.effects.friction.shaft_drag import BearingDrag, NutDrag
from feeddrive.parts.bearings.bearing_friction import palmgren_torque
from feeddrive.thermal.rig import refuse_negative, refuse_unless, refuse_unless_positive
from feeddrive.thermal.thermal_coupling import Coupling
from feeddrive.typing import Expression, FloatArray

LOAD_EXPONENT = 1.33
"""Exponent of the preload in the load torque: 1 + y, y = 0.33."""


def nut_load_torque(constant: float, preload: float, mean_diameter: float, lead_angle: float) -> float:
    """T₁ of a double nut with spacer, equation (22) [N m].

    Args:
        constant: 1.93e-4·κ·cot(contact angle) as printed; the paper's table 4 needs 4.1364e-4 [N^-0.33].
        preload: F_p [N].
        mean_diameter: d_m, pitch circle [m].
        lead_angle: γ [rad].
    """
    refuse_unless_positive(preload, "N", "preload")
    return float(constant * preload**LOAD_EXPONENT * mean_diameter / math.cos(lead_angle))


@dataclass(frozen=True)
class Friction:
    """Friction torque of a nut or a bearing.

    Attributes:
        load_torque: T₁ at the reference preload [N m].
        viscous_factor: f₀, of a nut times κφ [1].
        viscosity: ν of the lubricant [m²/s].
        mean_diameter: d_m [m].
        heat_share: s [1].
    """

    load_torque: float
    viscous_factor: float
    viscosity: float
    mean_diameter: float
    heat_share: float = 1.0

    def __post_init__(self) -> None:
        refuse_negative(self.load_torque, "N m", "load_torque")
        refuse_negative(self.viscous_factor, "1", "viscous_factor")
        refuse_unless_positive(self.viscosity, "m^2/s", "viscosity")
        refuse_unless_positive(self.mean_diameter, "m", "mean_diameter")
        good = 0 <= self.heat_share <= 1
        refuse_unless(good, f"{self.heat_share} is no share", "heat_share", "write a number from 0 to 1")

    def viscous_torques(self, speeds: FloatArray) -> FloatArray:
        """T_v at speeds [rad/s], of the same shape [N m]; zero at rest."""
        turning = np.abs(np.asarray(speeds, dtype=float))
        torques = ca.DM(oil_torque(ca.DM(turning.ravel()), vars(self))).full().reshape(turning.shape)
        return np.asarray(np.where(turning > 0, torques, 0.0))

    def heats(
        self, speeds: FloatArray, load_factor: FloatArray | float = 1.0, viscous_factor: FloatArray | float = 1.0
    ) -> FloatArray:
        """Q at speeds of the screw of either sign [rad/s], of the same shape [W]; the factors are those of T₁ and T_v.

        That of T₁ is (F/F₀)^1.33 and what an effect adds.
        """
        torques = self.load_torque * load_factor + self.viscous_torques(speeds) * viscous_factor
        return np.asarray(self.heat_share * np.abs(speeds) * torques)


def oil_torque(speed: Expression, p: Mapping[str, Expression]) -> Expression:
    """T_v [N m] at a speed, not negative [rad/s], with the values of `Friction`; that of the slowest motion at rest."""
    return palmgren_torque(p["viscous_factor"], p["viscosity"], speed, p["mean_diameter"])


def torque_law(
    speed: Expression, p: Mapping[str, Expression], load_factor: Expression = 1.0, viscous_factor: Expression = 1.0
) -> Expression:
    """T [N m], arguments as `oil_torque` and factors on T₁ and T_v."""
    return p["load_torque"] * load_factor + oil_torque(speed, p) * viscous_factor


_FAST = 1e3
"""A speed in the range of the power 2/3 for any oil [rad/s]."""


def nut_of(
    effects: Sequence[Effect], coupling: Coupling, ambient: float, diameter: float, lead: float
) -> Friction | None:
    """Friction of the nut of diameter d_m [m] and lead [m/rad]; None where no effect of the motion declares it.

    It has the oil of the coupling and is declared for the ambient temperature [degC].
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
