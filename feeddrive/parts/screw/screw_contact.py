"""Balls and grooves of a ball nut: geometry, and the Hertz contacts on screw and nut.

    gamma = D_a cos(a_0) / d_m,      d_B, d_M = d_m (1 -/+ gamma),      tan(gamma_x) = l / (pi d_x)
    plane of rolling:  ball 2/D_a,  screw +(2/D_a) gamma/(1 - gamma),  nut -(2/D_a) gamma/(1 + gamma)
    plane across:      ball 2/D_a,  both grooves -1/(f_p D_a)
    Q = F / (z sin(a_0) cos(gamma_m)),      z = floor(pi d_m zeta / (D_a cos(gamma_m)))

| symbol | meaning | unit |
|---|---|---|
| D_a | ball diameter | m |
| d_m | diameter of the circle of ball centres | m |
| d_B, d_M | diameter at the contact on the screw, on the nut | m |
| a_0 | contact angle, from the radial direction | rad |
| gamma_B, gamma_M, gamma_m | lead angles at those diameters and at the ball centres | rad |
| f_p | conformity: groove radius over ball diameter | 1 |
| l, zeta | lead, loaded turns | m, 1 |
| z | loaded balls | 1 |
| Q, F | load normal to the contact, axial force on the nut | N |

The long semi-axis of the ellipse lies across the groove, the short one in the direction of rolling. The lead angle is
left out of the curvatures (a change below 1 % for lead angles below 5 degrees).
Source: paper 001, eqs. (2), (14), (15) and its list of symbols; Harris for the curvatures.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from feeddrive.errors import InputError
from feeddrive.parts.contact import Curvatures, Material, PointContact, point_contact
from feeddrive.parts.values import PartValue, check_values

SCREW_STEEL = Material(206e9, 0.3)
"""Hardened bearing steel of balls, screw and nut."""


@dataclass(frozen=True)
class BallTrack:
    """Balls and grooves of one nut.

    Attributes:
        ball_diameter: D_a [m].
        pitch_diameter: d_m [m].
        conformity: f_p, the same on screw and nut [1].
        contact_angle: a_0 [rad].
        lead: l [m].
        turns: zeta, turns times circuits under load [1].

    Raises:
        InputError: a value that is not possible; balls wider than the space between screw and axis.

    Warns:
        ValidityWarning: unusual value.
    """

    ball_diameter: float
    pitch_diameter: float
    conformity: float
    contact_angle: float
    lead: float
    turns: float

    values: ClassVar[tuple[PartValue, ...]] = (
        PartValue("ball_diameter", "m", 1e-4, 0.1, usual=(5e-4, 0.03)),
        PartValue("pitch_diameter", "m", 1e-3, 0.5, usual=(4e-3, 0.2)),
        PartValue("conformity", "1", 0.5, 1.0, usual=(0.505, 0.58)),
        PartValue("contact_angle", "rad", 0.0, 0.5 * math.pi, usual=(math.radians(30), math.radians(60))),
        PartValue("lead", "m", 1e-4, 0.5, usual=(1e-3, 0.08)),
        PartValue("turns", "1", 0.5, 100.0, usual=(1.0, 15.0)),
    )

    def __post_init__(self) -> None:
        if self.conformity <= 0.5:
            what = f"a groove of radius {self.conformity:g} ball diameters is narrower than the ball"
            raise InputError(what, "ball track.conformity", "write a value above 0.5, such as 0.52")
        check_values("ball track", self.values, vars(self))
        if self.ball_diameter >= 0.5 * self.pitch_diameter:
            what = "balls half as wide as the circle of their centres or wider leave no screw"
            raise InputError(what, "ball track.ball_diameter", "check both diameters and their units")

    @property
    def curvature_ratio(self) -> float:
        """gamma [1]."""
        return self.ball_diameter * math.cos(self.contact_angle) / self.pitch_diameter

    @property
    def screw_diameter(self) -> float:
        """d_B [m]."""
        return self.pitch_diameter * (1.0 - self.curvature_ratio)

    @property
    def nut_diameter(self) -> float:
        """d_M [m]."""
        return self.pitch_diameter * (1.0 + self.curvature_ratio)

    @property
    def loaded_length(self) -> float:
        """Axial length l zeta of the loaded turns of the nut [m]."""
        return self.lead * self.turns

    def lead_angle(self, diameter: float) -> float:
        """Lead angle [rad] of the helix at a diameter [m]."""
        return math.atan(self.lead / (math.pi * diameter))

    @property
    def balls(self) -> int:
        """z, as many as the loaded turns hold side by side."""
        path = math.pi * self.pitch_diameter * self.turns / math.cos(self.lead_angle(self.pitch_diameter))
        return math.floor(path / self.ball_diameter)

    @property
    def axial_part(self) -> float:
        """sin(a_0) cos(gamma_m): axial part of a ball's normal load [1]."""
        return math.sin(self.contact_angle) * math.cos(self.lead_angle(self.pitch_diameter))

    def mean_ball_load(self, force: float) -> float:
        """Q [N] normal to the contact where every ball carries its share of the axial force [N].

        Raises:
            InputError: a force that is negative or not finite.
        """
        check_values("nut", (PartValue("force", "N", 0.0, 1e9, open_ends=False),), {"force": force})
        return force / (self.balls * self.axial_part)


def screw_contact(track: BallTrack, material: Material = SCREW_STEEL) -> PointContact:
    """Contact of a ball with the groove of the screw, both of one material."""
    gamma = track.curvature_ratio
    return _groove_contact(track, gamma / (1.0 - gamma), material)


def nut_contact(track: BallTrack, material: Material = SCREW_STEEL) -> PointContact:
    """Contact of a ball with the groove of the nut, both of one material."""
    gamma = track.curvature_ratio
    return _groove_contact(track, -gamma / (1.0 + gamma), material)


def contact_constant(track: BallTrack, material: Material = SCREW_STEEL) -> float:
    """c_E of delta = c_E Q^(2/3): approach of screw and nut through one ball, along the contact [m/N^(2/3)]."""
    return screw_contact(track, material).constant + nut_contact(track, material).constant


def _groove_contact(track: BallTrack, rolling: float, material: Material) -> PointContact:
    """Contact with a groove whose curvature in the plane of rolling is `rolling` times that of the ball."""
    ball = 2.0 / track.ball_diameter
    groove = (ball * rolling, -1.0 / (track.conformity * track.ball_diameter))
    return point_contact(Curvatures((ball, ball), groove), material, material)
