"""Friction of a plant's ball screw as one coefficient: declared, or from the drag that its preload causes.

    f  of [[effect]] nut_friction, or of T = f(..) F_0 r with T the `coulomb` of nut_drag and F_0 the preload of [nut]

The drag of nut_drag holds seals and return tubes too, so f from it is an upper bound. Without nut_friction the contact
angle is taken as 45 deg, and the circle of ball centres, where none is declared, as the nominal diameter (3 to 5 % less
than it is, which changes an efficiency by less than 0.1 %).
Source: `feeddrive.parts.screw.screw_friction`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from feeddrive.effects.base import number
from feeddrive.effects.friction.nut_friction import NutFriction
from feeddrive.effects.friction.shaft_drag import BearingDrag, NutDrag
from feeddrive.parts.screw.screw_friction import ScrewFriction, ScrewGeometry
from feeddrive.plant.analysis.rated_life import datum, preload_of
from feeddrive.plant.plant import Plant

_USUAL_ANGLE = math.pi / 4


@dataclass(frozen=True)
class NutLosses:
    """Friction of the ball screw.

    Attributes:
        screw: lead, contact and friction coefficient.
        preload: of the nut [N].
        drag: level of the shaft drags beside it, at any load: bearings, and seals where they are declared [N m].
        effect: that declares it, "nut_friction" or "nut_drag".
    """

    screw: ScrewFriction
    preload: float
    drag: float
    effect: str

    def efficiency(self, force: float, driving: bool = True, lead: float | None = None) -> float:
        """Axial power over shaft power at a slow motion under an axial load, or the other way round; 0 at least.

        Args:
            force: above 0 [N].
            driving: whether the screw drives the nut; else the load drives the screw.
            lead: in place of the axis' own, all else the same [m].

        Raises:
            InputError: a lead with which the screw jams.
        """
        own = self.screw.geometry
        screw = self.screw if lead is None else replace(self.screw, geometry=replace(own, lead=lead))
        ideal = force * screw.geometry.lead / (2 * math.pi)
        if driving:
            return ideal / (screw.torque(force, 1.0, self.preload) + self.drag)
        return max((screw.torque(force, -1.0, self.preload) - self.drag) / ideal, 0.0)


def nut_losses(plant: Plant) -> NutLosses | None:
    """What the file says of the friction of the ball screw; None where it says too little.

    Raises:
        InputError: a friction at which the screw jams.
    """
    lead, preload = 2 * math.pi * plant.chain.radius, preload_of(plant)
    drags = [(one.name, number(one.values["coulomb"])) for one in plant.effects if type(one) in (NutDrag, BearingDrag)]
    for one in plant.effects:
        if isinstance(one, NutFriction):
            d_m, angle, f = (number(one.values[k]) for k in ("pitch_diameter", "contact_angle", "friction_coefficient"))
            screw = ScrewFriction(ScrewGeometry(lead, d_m, angle), f)
            return NutLosses(screw, preload, sum(level for _, level in drags), one.name)
    circle = datum(plant, "ball_screw.ball_circle") or datum(plant, "ball_screw.diameter")
    of_nut = sum(level for name, level in drags if name == NutDrag.name)
    if circle is None or not (preload > 0.0 and of_nut > 0.0):
        return None
    geometry = ScrewGeometry(lead, circle, _USUAL_ANGLE)
    screw = ScrewFriction(geometry, geometry.friction_from(preload, of_nut))
    return NutLosses(screw, preload, sum(level for _, level in drags) - of_nut, NutDrag.name)
