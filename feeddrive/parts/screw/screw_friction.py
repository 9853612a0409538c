"""The friction of one ball screw: catalogue geometry and a friction coefficient in, efficiencies and torques out.

    r = L / 2 pi,     tan(alpha) = L / (pi d_m)

| symbol | meaning | unit |
|---|---|---|
| L | lead | m |
| d_m | diameter of the circle of ball centres (a little more than the nominal diameter) | m |
| alpha, beta | lead angle, contact angle | rad |
| f | Coulomb friction coefficient: an effective one, from a preload torque of this screw | 1 |

Valid for slow, dry or thinly lubricated screws, f below 0.1 and lead angles well below 44 deg; no viscous torque, seals
or return tubes. An f deduced at one lead does not hold at another: f sin(psi0) varies less.
Source: paper 000.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass

from feeddrive.errors import InputError
from feeddrive.parts.screw.double_nut import friction_torque_backward, friction_torque_forward, rigid_sharing
from feeddrive.parts.screw.screw_efficiency import (
    back_driving_efficiency,
    back_driving_loss,
    driving_efficiency,
    driving_loss,
    friction_from_torque,
    ideal_torque,
    jamming_friction,
    preload_torque,
    relative_torque,
)
from feeddrive.parts.screw.slip_angle import Groove, groove_of_screw
from feeddrive.parts.values import PartValue, check_values

GEOMETRY = (
    PartValue("lead", "m", 0.0, 1.0, usual=(5e-4, 0.1)),
    PartValue("pitch_diameter", "m", 0.0, 1.0, usual=(3e-3, 0.2)),
    PartValue("contact_angle", "rad", 0.0, math.pi / 2, usual=(math.radians(30), math.radians(60))),
)
"""What a catalogue gives."""

PRELOAD = PartValue("preload", "N", 0.0, 1e9, open_ends=False)
"""What is set when it is mounted."""

FRICTION = PartValue("friction_coefficient", "1", 0.0, 1.0, usual=(0.0, 0.1), open_ends=False)
"""What a measurement gives."""


@dataclass(frozen=True)
class ScrewGeometry:
    """Lead and contact of a ball screw, without its friction.

    Attributes:
        lead: L [m].
        pitch_diameter: d_m [m].
        contact_angle: beta [rad].

    Raises:
        InputError: a value that is not possible; gives the range.

    Warns:
        ValidityWarning: an unusual value.
    """

    lead: float
    pitch_diameter: float
    contact_angle: float

    def __post_init__(self) -> None:
        check_values("ball screw", GEOMETRY, asdict(self))

    @property
    def lead_angle(self) -> float:
        """alpha [rad]."""
        return math.atan(self.lead / (math.pi * self.pitch_diameter))

    @property
    def groove(self) -> Groove:
        """Geometry that the efficiencies need."""
        return groove_of_screw(self.lead, self.pitch_diameter, self.contact_angle)

    def friction_from(self, preload: float, torque: float) -> float:
        """f from one preload [N] and the torque [N m] that it causes, none of it viscous.

        Raises:
            InputError: a preload that is not positive, or a negative torque.
        """
        if not (math.isfinite(preload) and math.isfinite(torque) and preload > 0 and torque >= 0):
            what = f"preload {preload:g} N with torque {torque:g} N m is not possible"
            raise InputError(what, "preload torque", "write a preload above 0 N and a torque of 0 N m or more")
        return float(friction_from_torque(relative_torque(torque, preload, self.lead), self.groove))


@dataclass(frozen=True)
class ScrewFriction:
    """A ball screw with its friction.

    Attributes:
        geometry: lead and contact.
        friction_coefficient: f.

    Raises:
        InputError: a friction coefficient that is not possible, or one at which the screw jams.

    Warns:
        ValidityWarning: above 0.1, outside what the model is good for.
    """

    geometry: ScrewGeometry
    friction_coefficient: float

    def __post_init__(self) -> None:
        check_values("ball screw", (FRICTION,), {"friction_coefficient": self.friction_coefficient})
        jam = float(jamming_friction(self.geometry.groove))
        if self.friction_coefficient >= jam:
            what = f"a friction coefficient of {self.friction_coefficient:g} jams this screw"
            raise InputError(what, "ball screw.friction_coefficient", f"write a value below {jam:.3g}")

    @property
    def driving_efficiency(self) -> float:
        """eta_a."""
        return float(driving_efficiency(self.geometry.groove, self.friction_coefficient))

    @property
    def back_driving_efficiency(self) -> float:
        """eta_b; 0 or less where the screw is self-locking."""
        return float(back_driving_efficiency(self.geometry.groove, self.friction_coefficient))

    def preload_torque(self, preload: float) -> float:
        """Torque [N m] of a double nut at a preload [N], without axial load.

        Raises:
            InputError: a preload that is negative or not finite.
        """
        check_values("ball screw", (PRELOAD,), {"preload": preload})
        return float(preload_torque(self.geometry.groove, self.friction_coefficient, preload, self.geometry.lead))

    def torque(self, force: float, speed: float, preload: float = 0.0) -> float:
        """Torque [N m] to give an axial force [N] at a screw speed [rad/s], not 0: of a double nut or, without
        preload [N], of a single one. Only the sign of the speed counts.

        Raises:
            InputError: at rest, where any torque between those of the two directions is possible; a negative preload.
        """
        if speed == 0 or preload < 0 or not all(map(math.isfinite, (speed, force, preload))):
            what = f"no torque follows from {force:g} N at {speed:g} rad/s and a preload of {preload:g} N"
            raise InputError(what, "ball screw", "give a speed other than 0 and a preload of 0 N or more")
        loads = rigid_sharing(force, preload)
        groove, f = self.geometry.groove, self.friction_coefficient
        law = friction_torque_forward if speed > 0 else friction_torque_backward
        radius = float(ideal_torque(1.0, self.geometry.lead))
        drag = law(*loads, radius, driving_loss(groove, f), back_driving_loss(groove, f))
        return force * radius + math.copysign(float(drag), speed)
