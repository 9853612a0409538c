"""What temperatures do to the drive: thinner oil, another preload, a longer screw.

    T_v / T_v0 = (ν(T) / ν(T_0))^(2/3)          viscous torque, Palmgren's law; ν by Walther's
    F / F_0 = 1 + ΔF(T_nut - T_shaft) / F_0     preload of the double nut (`nut_preload`)
    T_a / T_a0 = F / F_0,  k / k_0 = (F / F_0)^(1/3)      preload torque and stiffness (`parts.preload_loss`)

| symbol | meaning | unit |
|---|---|---|
| T_0 | temperature for which the plant's friction and preload are declared: `ambient` of its thermal section | degC |
| ν | kinematic viscosity of the oil, or of the grease's base oil | m²/s |

Bearings change with their oil alone. Valid while the nut keeps preload: it is refused to run loose. The guide's
friction is left as declared: its oil has the temperature of the machine's bed.

Preload of a double nut with spacer while nut and shaft differ in temperature.

    axial:   ΔF = ± (k/2) α s D          radial:   ΔF = -k α (d_m/2) D cot β

| symbol | meaning | unit |
|---|---|---|
| D | nut (with spacer) hotter than the shaft by | K |
| k | axial stiffness of one nut at its preload, 1.5 F/δ_a | N/m |
| s | distance of the two ball groups | m |
| d_m | pitch diameter | m |
| β | contact angle, from the radial direction | rad |

The groove of the nut leaves its balls by u_r cos β - u_a sin β along the contact normal, u_r = α (d_m/2) D outward and
u_a = ± α (s/2) D along the axis. The same leaving comes from an axial way u_r cot β - u_a of the nut, so ΔF is k times
that. + with an oversize spacer, which pushes the nuts apart, - with an undersize one. The radial part unloads in either
case: the groove in the nut grows away from the balls. Equal temperatures change nothing; balls hotter than both are
left out. Valid for a nut whose body is stiff beside its contacts and D small enough that ΔF stays below F. The turn of
the contact angle under the load is left out: with c the distance of the groove centres (some tenths of a millimetre) it
adds (F/c) (u_a cos²β / sin β + u_r cos β), 2 to 4 % of the radial part as nuts are built.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from enum import Enum

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.parts.lubricant import Lubricant
from feeddrive.parts.screw.double_nut import stiffness_share
from feeddrive.thermal.rig import refuse_negative, refuse_unless, refuse_unless_positive
from feeddrive.typing import Expression
from feeddrive.units.quantity import format_quantity, percent


class Spacer(Enum):
    """How the spacer preloads: the sign of the axial part."""

    OVERSIZE = 1
    UNDERSIZE = -1


def preload_change(
    difference: float, preload: float, stiffness: float, group_distance: float, pitch_diameter: float,
    contact_angle: float, spacer: Spacer, expansion: float = 11.7e-6,
) -> float:  # fmt: skip
    """ΔF [N].

    Args:
        difference: D, nut over shaft [K].
        preload: F [N].
        stiffness: k of one nut [N/m].
        group_distance: s [m].
        pitch_diameter: d_m [m].
        contact_angle: β, from the radial direction, below π/2 [rad].
        spacer: oversize or undersize.
        expansion: α [1/K].

    Raises:
        InputError: a value that is not positive, or a contact angle of π/2 or more.

    Warns:
        ValidityWarning: the whole preload is lost; the balls are loose then.
    """
    for value, unit, where in (
        (preload, "N", "preload"),
        (stiffness, "N/m", "stiffness"),
        (group_distance, "m", "group_distance"),
        (pitch_diameter, "m", "pitch_diameter"),
        (contact_angle, "rad", "contact_angle"),
    ):
        refuse_unless_positive(value, unit, where)
    if contact_angle >= math.pi / 2:
        what = f"{format_quantity(contact_angle, 'rad')} is no angle from the radial direction"
        raise InputError(what, "contact_angle", "write it below 90 deg")
    axial = spacer.value * stiffness / 2 * group_distance
    radial = stiffness * pitch_diameter / 2 / math.tan(contact_angle)
    change = expansion * difference * (axial - radial)
    if preload + change < 0:
        loss = f"{difference:.3g} K between nut and shaft take {format_quantity(-change, 'N')}"
        warnings.warn(
            f"{loss} of {format_quantity(preload, 'N')} preload: the nut is loose", ValidityWarning, stacklevel=2
        )
    return change


_PALMGREN = 2 / 3
LEAST_PRELOAD = 0.05
"""Share of the preload below which the nut counts as loose, where none of these laws holds."""


@dataclass(frozen=True)
class Temperatures:
    """Temperatures of the parts whose laws depend on them [degC]: nut, shaft under it, front and rear bearing."""

    nut: float
    shaft: float
    front: float
    rear: float


@dataclass(frozen=True)
class Changes:
    """Factors on what the plant declares [1].

    Attributes:
        nut_viscous, bearing_viscous: on the lubricant torques.
        preload: on the preload, and so on the preload torque.
        nut_stiffness: on the nut's axial stiffness.
    """

    nut_viscous: float = 1.0
    bearing_viscous: float = 1.0
    preload: float = 1.0
    nut_stiffness: float = 1.0


@dataclass(frozen=True)
class Coupling:
    """How heat and drive are joined.

    Attributes:
        nut_at_zero: place of the nut's centre from the fixed end where the table is at 0 [m].
        nut_oil, bearing_oil: lubricants.
        nut_stiffness: axial, of the whole nut at its preload [N/m].
        group_distance: of the two ball groups [m].
        contact_angle: of the balls, from the radial direction [rad].
        spacer: how the nut is preloaded.
        rear_share: of the bearings' friction, at the rear one [1].
        motor_constant: torque per root of the winding's heat [N m/W^½]; None where that heat is not counted.
        guide_heat_to: body that takes the guide's friction heat; "" for the bed.
    """

    nut_at_zero: float
    nut_oil: Lubricant
    bearing_oil: Lubricant
    nut_stiffness: float
    group_distance: float
    contact_angle: float
    spacer: Spacer
    rear_share: float = 0.5
    motor_constant: float | None = None
    guide_heat_to: str = ""

    def __post_init__(self) -> None:
        refuse_negative(self.nut_at_zero, "m", "coupling.nut_at_zero")
        refuse_unless_positive(self.nut_stiffness, "N/m", "coupling.nut_stiffness")
        refuse_unless_positive(self.group_distance, "m", "coupling.group_distance")
        steep = 0 < self.contact_angle < math.pi / 2
        refuse_unless(
            steep, "the contact angle is not between 0 and 90 deg", "coupling.contact_angle", "check its unit"
        )
        share = 0 <= self.rear_share <= 1
        refuse_unless(share, f"{self.rear_share} is no share", "coupling.rear_share", "write a number from 0 to 1")
        if self.motor_constant is not None:
            refuse_unless_positive(self.motor_constant, "N m/W^0.5", "coupling.motor_constant")

    def changes(
        self, at: Temperatures, reference: float, preload: float, pitch_diameter: float, expansion: float
    ) -> Changes:
        """What the drive is at some temperatures, its friction and preload F_0 [N] those at the reference T_0 [degC].

        `pitch_diameter` is that of the ball centres [m], `expansion` that of the steel [1/K]. Raises InputError where
        the nut has lost its preload.
        """
        share = 1 + self._gained(at.nut - at.shaft, preload, pitch_diameter, expansion) / preload
        if share < LEAST_PRELOAD:
            what = f"a nut {at.nut - at.shaft:.3g} K warmer than its shaft keeps {percent(share)} of its preload"
            raise InputError(what, "coupling", f"cool it, or preload it with more than {format_quantity(preload, 'N')}")
        mean = (1 - self.rear_share) * at.front + self.rear_share * at.rear
        return Changes(
            _warned_share(self.nut_oil, at.nut, reference),
            _warned_share(self.bearing_oil, mean, reference),
            share,
            stiffness_share(share),
        )

    def preload_slope(self, preload: float, pitch_diameter: float, expansion: float) -> float:
        """Change of the preload's share with the difference of nut and shaft [1/K]; arguments as `changes`."""
        small = 1e-6  # the law is linear, and so small a difference cannot loosen the nut
        return self._gained(small, preload, pitch_diameter, expansion) / small / preload

    def _gained(self, difference: float, preload: float, pitch_diameter: float, expansion: float) -> float:
        """Change of the preload [N] by a difference of nut and shaft [K]."""
        # Two nuts share the load about zero, so that the whole is twice as stiff as one.
        return preload_change(
            difference, preload, self.nut_stiffness / 2, self.group_distance, pitch_diameter, self.contact_angle,
            self.spacer, expansion,
        )  # fmt: skip


def viscous_share(oil: Lubricant, temperature: Expression, reference: Expression) -> Expression:
    """T_v over that at the reference temperature [degC], at the same speed; expressions or numbers."""
    return (oil.viscosity_law(temperature) / oil.viscosity_law(reference)) ** _PALMGREN


def _warned_share(oil: Lubricant, temperature: float, reference: float) -> float:
    """`viscous_share`, with a warning outside Walther's law."""
    return float((oil.viscosity(temperature) / oil.viscosity(reference)) ** _PALMGREN)
