"""Profile-rail ball guide with four rows: its balls and grooves, and how much a row gives way.

    A0 = (f_r + f_c - 1) d_b,    f = r / d_b,    C = C_br + C_bc

| symbol | meaning | unit |
|---|---|---|
| d_b | ball diameter | m |
| r_r, r_c | groove radius of rail and carriage | m |
| f_r, f_c | conformity | 1 |
| A0 | distance of the groove centres | m |
| alpha_0 | contact angle without load, from the horizontal | rad |
| lambda | ball oversize that makes the preload | m |
| C | Hertz's constant of both contacts of a ball | m/N^(2/3) |

Only the balls yield; rail and carriage are rigid, and all balls of a row carry the same load (no moment, no crowning).
Source: paper 003, (2), (5), (6) and table 2. The approach of (3) is that of both contacts of a ball, so their constants
add.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from feeddrive.errors import InputError
from feeddrive.parts.contact import BEARING_STEEL, Material, PointContact, ball_in_groove
from feeddrive.parts.values import check_values, part_values

ROWS = 4
"""Rows of a carriage, as j = 1 to 4 in paper 003: 1 and 2 are unloaded by + vertical load, 3 and 4 loaded."""

_USUAL_ANGLE = f"(0, {math.pi / 2}) usual {math.radians(30)} to {math.radians(60)}"
GUIDE_VALUES = part_values(f"""
ball_diameter | m | (0, 0.1) usual 0.001 to 0.02 | | diameter of a ball
rail_conformity | 1 | (0.5, 1) usual 0.505 to 0.6 | | groove radius of the rail over ball diameter
carriage_conformity | 1 | (0.5, 1) usual 0.505 to 0.6 | | groove radius of the carriage over ball diameter
contact_angle | rad | {_USUAL_ANGLE} | | contact angle without load, from the horizontal
preload_oversize | m | [0, 0.001] usual 0 to 5e-5 | | oversize of the balls that makes the preload; 0 for none
balls_per_row | 1 | [1, 1000] usual 3 to 100 | | balls under load in one row
""")


@dataclass(frozen=True)
class BallGuide:
    """One carriage of a four-row ball guide on its rail.

    Attributes:
        ball_diameter: d_b [m].
        rail_conformity, carriage_conformity: f_r, f_c, groove radius over ball diameter [1].
        contact_angle: alpha_0 [rad].
        preload_oversize: lambda [m]; 0 for none. Clearance (below 0) leaves the carriage's place open and is refused.
        balls_per_row: z, balls under load in one row.
        material: of balls, rail and carriage.

    Raises:
        InputError: an impossible value.

    Warns:
        ValidityWarning: an unusual one.
    """

    ball_diameter: float
    rail_conformity: float
    carriage_conformity: float
    contact_angle: float
    preload_oversize: float
    balls_per_row: int
    material: Material = BEARING_STEEL

    def __post_init__(self) -> None:
        check_values(
            "guide", GUIDE_VALUES, {f.name: getattr(self, f.name) for f in fields(self) if f.name != "material"}
        )
        if self.balls_per_row != int(self.balls_per_row):
            raise InputError(f"{self.balls_per_row:g} balls", "guide.balls_per_row", "write a whole number")
        if self.preload_oversize >= self.centre_distance * (1.0 - math.sin(self.contact_angle)):
            shown = f"an oversize of {self.preload_oversize * 1e6:.3g} µm pushes the balls out of their grooves"
            raise InputError(shown, "guide.preload_oversize", "write a smaller one, a few micrometres are usual")

    @property
    def centre_distance(self) -> float:
        """A0 [m]."""
        return (self.rail_conformity + self.carriage_conformity - 1.0) * self.ball_diameter

    @property
    def contacts(self) -> tuple[PointContact, PointContact]:
        """Contact of a ball with the rail and with the carriage."""
        return (
            ball_in_groove(self.ball_diameter, self.rail_conformity, self.material),
            ball_in_groove(self.ball_diameter, self.carriage_conformity, self.material),
        )

    @property
    def hertz_constant(self) -> float:
        """C of both contacts of a ball [m/N^(2/3)]."""
        return sum(contact.constant for contact in self.contacts)


HSR_20R = BallGuide(3.969e-3, 0.52, 0.52, math.radians(45), 3.5e-6, 12)
"""Table 2 of paper 003, with the preload of its section 5.1."""

HSR_30R = BallGuide(5.556e-3, 0.52, 0.52, math.radians(45), 5e-6, 12)
"""Table 2 of paper 003, with the preload of its section 5.1."""
