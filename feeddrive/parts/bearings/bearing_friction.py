"""Friction torque of ball bearings after Palmgren: a part by the lubricant, a part by the load.

    M = M_0 + M_1
    M_0 = 1e-7 f_0 (nu n)^(2/3) d_m^3     for nu n >= 2000,        160e-7 f_0 d_m^3     below      [N mm]
    M_1 = f_1 F_b d_m,    f_1 = z (F_s / C_s)^y
    F_b = max(3 F_a - 0.1 F_r, F_r) deep groove,  max(0.9 F_a cot(a) - 0.1 F_r, F_r) angular contact,  F_a thrust

| symbol | meaning | unit |
|---|---|---|
| M_0, M_1 | torque by lubricant and speed, by load | N mm here, N m at every function |
| nu | kinematic viscosity at the bearing's temperature, of a grease its base oil's | mm^2/s; m^2/s at every function |
| n | speed | rev/min; rad/s at every function |
| d_m | mean of bore and outer diameter | mm; m at every function |
| f_0 | factor of bearing and lubrication | 1 |
| z, y | constants of the bearing type | 1 |
| F_s, C_s | static equivalent load, basic static rating | N |
| F_a, F_r, F_b | axial, radial load, load that M_1 counts | N |
| a | contact angle | rad |

Validity: no rubbing seals; moderate loads (F_s up to C_s), speeds below the catalogue's limit, lubricant well
distributed; single values scatter by a third or more. M_0 jumps by 0.8 per cent at nu n = 2000, as in the source, and
acts with the sign of the speed.
Source: Harris, Rolling Bearing Analysis (2001), chapter 14, after Palmgren; paper 002, eqs. (15) to (17), (23) and
table 2 (f_0 of angular contact). The paper lacks the factor 1e-7 and its units; its bearing has a thrust load alone.
The constants of deep groove and thrust bearings, F_b and the limit at 2000 are quoted from memory of Harris's tables,
not checked against the print: take them as typical, within a third. Of the factors of F_s, those of deep groove and of
15, 25 and 40 degrees agree with bearing makers' pages (SKF; LYC); the others are those of ISO 76 from memory.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from enum import Enum

import casadi as ca
import numpy as np

from feeddrive.errors import ValidityWarning
from feeddrive.parts.values import PartValue, check_values
from feeddrive.typing import Expression

RESTING_PRODUCT = 2000.0
"""nu n [mm^2/s rev/min] below which M_0 no longer falls with the speed."""

_VISCOUS = 1e-7
_RESTING = 160e-7
_NEWTON_MILLIMETRE = 1e-3


class Lubrication(Enum):
    """How a bearing is lubricated."""

    GREASE = "grease"
    OIL_MIST = "oil mist"
    OIL_BATH = "oil bath"


@dataclass(frozen=True)
class BallBearingType:
    """Constants of a type of ball bearing.

    Attributes:
        name: in plain words.
        load_factor: z [1].
        load_exponent: y [1].
        viscous_factors: f_0 by lubrication [1]; where a source gives a range, its middle.
        source: where they stand.
    """

    name: str
    load_factor: float
    load_exponent: float
    viscous_factors: dict[Lubrication, float]
    source: str


DEEP_GROOVE = BallBearingType(
    "deep groove ball bearing, one row",
    0.0005,
    0.55,
    {Lubrication.GREASE: 1.4, Lubrication.OIL_MIST: 1.0, Lubrication.OIL_BATH: 2.0},
    "Harris after Palmgren: z 0.0004 to 0.0006, f_0 with grease 0.7 to 2",
)
ANGULAR_CONTACT = BallBearingType(
    "angular contact ball bearing, one row",
    0.001,
    0.33,
    {Lubrication.GREASE: 2.0, Lubrication.OIL_MIST: 1.7, Lubrication.OIL_BATH: 3.3},
    "paper 002, eq. (16) and table 2, after Harris",
)
THRUST = BallBearingType(
    "thrust ball bearing",
    0.0008,
    0.33,
    {Lubrication.GREASE: 5.5, Lubrication.OIL_MIST: 0.8, Lubrication.OIL_BATH: 1.5},
    "Harris after Palmgren",
)


@dataclass(frozen=True)
class BallBearing:
    """A ball bearing as its friction needs it; a set of several adds their torques.

    Attributes:
        kind: type with its constants.
        mean_diameter: d_m, mean of bore and outer diameter [m].
        static_rating: C_s [N].
        contact_angle: a [rad]; used for angular contact alone.

    Raises:
        InputError: a value that is not possible.

    Warns:
        ValidityWarning: unusual value.
    """

    kind: BallBearingType
    mean_diameter: float
    static_rating: float
    contact_angle: float = math.radians(15)

    def __post_init__(self) -> None:
        check_values("bearing", _BEARING, {value.key: getattr(self, value.key) for value in _BEARING})


_STEEPEST_RADIAL = math.radians(45.0)
_ANGLES = (15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0)
_AXIAL_FACTORS = (0.46, 0.42, 0.38, 0.33, 0.29, 0.26, 0.22)
"""Y of ISO 76 for angular contact of one row, over the contact angle [deg]."""

_BEARING = (
    PartValue("mean_diameter", "m", 1e-3, 3.0, usual=(5e-3, 0.5)),
    PartValue("static_rating", "N", 1.0, 1e8, usual=(100.0, 1e6)),
    PartValue("contact_angle", "rad", 0.0, 0.5 * math.pi, usual=(math.radians(10), math.radians(65))),
)
_FACTORS = (PartValue("viscous_factor", "1", 0.0, 100.0, usual=(0.5, 15.0)),)
_STATE = (
    PartValue("viscosity", "m^2/s", 0.0, 1.0, usual=(1e-6, 5e-3)),
    PartValue("axial", "N", 0.0, 1e9, open_ends=False),
    PartValue("radial", "N", 0.0, 1e9, open_ends=False),
)
_TURNING = (PartValue("speed", "rad/s", -1e6, 1e6), _BEARING[0])


def viscous_torque(viscous_factor: float, viscosity: float, speed: float, mean_diameter: float) -> float:
    """M_0 [N m], the size of the torque at either sign of the speed.

    Args:
        viscous_factor: f_0 [1].
        viscosity: nu at the bearing's temperature [m^2/s].
        speed: n [rad/s].
        mean_diameter: d_m [m].

    Raises:
        InputError: a value that is not possible.

    Warns:
        ValidityWarning: unusual value; mm^2/s written for m^2/s is refused.
    """
    check_values("bearing", _FACTORS, {"viscous_factor": viscous_factor})
    check_values("lubricant", _STATE[:1], {"viscosity": viscosity})
    check_values("bearing", _TURNING, {"speed": speed, "mean_diameter": mean_diameter})
    return float(palmgren_torque(viscous_factor, viscosity, abs(speed), mean_diameter))


def palmgren_torque(
    viscous_factor: Expression, viscosity: Expression, speed: Expression, mean_diameter: Expression
) -> Expression:
    """M_0 [N m] as `viscous_torque`, unchecked, of CasADi expressions or numbers; the speed is not negative."""
    product = 1e6 * viscosity * speed * (30.0 / math.pi)
    # the power is taken where it acts alone: at rest its slope is infinite
    size = ca.if_else(
        product < RESTING_PRODUCT, _RESTING, _VISCOUS * ca.fmax(product, 0.5 * RESTING_PRODUCT) ** (2.0 / 3.0)
    )
    return size * viscous_factor * (1e3 * mean_diameter) ** 3 * _NEWTON_MILLIMETRE


def load_torque(bearing: BallBearing, axial: float, radial: float = 0.0) -> float:
    """M_1 [N m] under an axial and a radial load [N], neither negative.

    Raises:
        InputError: a negative load.

    Warns:
        ValidityWarning: a static load above the rating.
    """
    check_values("bearing", _STATE[1:], {"axial": axial, "radial": radial})
    share = static_load(bearing, axial, radial) / bearing.static_rating
    if share > 1.0:
        text = f"bearing: a load of {share:.2f} of the static rating, friction is known up to 1"
        warnings.warn(text, ValidityWarning, stacklevel=2)
    factor = bearing.kind.load_factor * share**bearing.kind.load_exponent
    return float(factor * _counted_load(bearing, axial, radial) * bearing.mean_diameter)


def static_load(bearing: BallBearing, axial: float, radial: float) -> float:
    """F_s [N] after ISO 76 from an axial and a radial load [N].

    Radial bearings: X F_r + Y F_a, F_r at least, against a radial C_s; angular contact above 45 degrees and thrust
    bearings: F_a + 2.3 F_r tan(a), against an axial C_s.
    """
    if bearing.kind == DEEP_GROOVE:
        return max(0.6 * radial + 0.5 * axial, radial)
    if bearing.kind == ANGULAR_CONTACT and bearing.contact_angle <= _STEEPEST_RADIAL:
        degrees = math.degrees(bearing.contact_angle)
        return max(0.5 * radial + float(np.interp(degrees, _ANGLES, _AXIAL_FACTORS)) * axial, radial)
    if radial == 0.0:
        return axial
    return axial + 2.3 * radial * math.tan(bearing.contact_angle)


def friction_torque(
    bearing: BallBearing, lubrication: Lubrication, viscosity: float, speed: float, axial: float, radial: float = 0.0
) -> float:
    """M [N m], its size at either sign of the speed; arguments as `viscous_torque` and `load_torque`.

    Raises:
        InputError: a value that is not possible.

    Warns:
        ValidityWarning: as its two parts.
    """
    factor = bearing.kind.viscous_factors[lubrication]
    return viscous_torque(factor, viscosity, speed, bearing.mean_diameter) + load_torque(bearing, axial, radial)


def _counted_load(bearing: BallBearing, axial: float, radial: float) -> float:
    """F_b [N]."""
    if bearing.kind == DEEP_GROOVE:
        return max(3.0 * axial - 0.1 * radial, radial)
    if bearing.kind == ANGULAR_CONTACT:
        return max(0.9 * axial / math.tan(bearing.contact_angle) - 0.1 * radial, radial)
    return axial
