"""Friction of a carriage whose geometry is not published: from load, preload and what its catalogue prints.

    F = mu (F_A + F_B) + S,     F_A^(2/3) + F_B^(2/3) = 2 F_0^(2/3),     F_A - F_B = W

| symbol | meaning | unit |
|---|---|---|
| mu | friction coefficient of the catalogue | 1 |
| F_A, F_B | load of the two pairs of rows that press against each other | N |
| F_0 | preload: F_A = F_B = F_0 without load | N |
| W | vertical load of the carriage | N |
| S | drag of its seals | N |

Catalogues print F = mu W + S for carriages without preload; here the rows that preload presses together count as well:
2 F_0 without load, W beyond 2.8 F_0, where one pair comes free (`feeddrive.parts.screw.double_nut`, Hertz's contacts).
Independent of speed: catalogues print nothing of the grease, which at low load is most of the resistance. So the value
tells the size, within a factor of two; measure it where friction matters.
Source: HIWIN G99TE20-1808, equation 1.11 (F = mu W + S); Hertz for the sharing of the load.

The carriages under a table as a machine declares them: how many, what loads them, by geometry or by rating.
"""

from __future__ import annotations

from dataclasses import dataclass

from feeddrive.parts.guide.guide_coefficients import GuideCoefficients
from feeddrive.parts.guide.guide_geometry import BallGuide
from feeddrive.parts.screw.double_nut import rigid_sharing
from feeddrive.parts.values import PartValue, check_values

RATED_VALUES = (
    PartValue("friction_coefficient", "1", 0.0, 0.1, usual=(0.001, 0.01), open_ends=False),
    PartValue("preload", "N", 0.0, 1e6, usual=(0.0, 1e5), open_ends=False),
    PartValue("seal_drag", "N", 0.0, 1e5, usual=(0.0, 100.0), open_ends=False),
)


def rated_friction(load: float, preload: float, friction_coefficient: float, seal_drag: float) -> float:
    """F [N] of one carriage, positive, from W [N], F_0 [N], mu and S [N]; refuses what is not possible."""
    given = {"friction_coefficient": friction_coefficient, "preload": preload, "seal_drag": seal_drag}
    check_values("guide", RATED_VALUES, given)
    pressed, released = rigid_sharing(abs(load), preload)
    return float(friction_coefficient * (pressed + released) + seal_drag)


@dataclass(frozen=True)
class RollingCarriage:
    """What is known of a carriage whose geometry is published.

    Attributes:
        guide: geometry and preload.
        coefficients: of rolling and slip, and the oil.
    """

    guide: BallGuide
    coefficients: GuideCoefficients


@dataclass(frozen=True)
class RatedCarriage:
    """What is known of a carriage whose geometry is not published: `feeddrive.parts.guide.guide_rating`.

    Attributes:
        preload: F_0 [N].
        friction_coefficient: mu [1].
    """

    preload: float
    friction_coefficient: float


@dataclass(frozen=True)
class Carriages:
    """Equal carriages that share the load of a table evenly.

    Attributes:
        name: of the carriage, "as written" for a geometry.
        count: under the table.
        load: vertical, of one [N].
        seal_drag: of one [N].
        one: what is known of a carriage.
    """

    name: str
    count: int
    load: float
    seal_drag: float
    one: RollingCarriage | RatedCarriage
