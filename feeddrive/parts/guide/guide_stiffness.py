"""Stiffness of a ball guide with rigid rail and carriage, and the load at which its preload is lost.

    K = z sum_j [ (dQ/ddelta) n n' + (Q/|V|) (1 - n n') ],     F_0 = 2 z Q(delta_A) sin a_A  where  delta_B = 0

| symbol | meaning | unit |
|---|---|---|
| K | change of (F_x, F_y) with (dx, dy), tangent | N/m |
| n | line of contact of a row | 1 |
| F_0 | vertical load at which rows 1 and 2 lose contact | N |

Rail, carriage and bolts of a real guide yield too, so that it is softer than this.
Source: paper 003, (1) to (7), differentiated.
"""

from __future__ import annotations

import math

from feeddrive.parts.guide.guide_equilibrium import guide_equilibrium
from feeddrive.parts.guide.guide_geometry import BallGuide


def vertical_stiffness(guide: BallGuide, vertical: float = 0.0, lateral: float = 0.0) -> float:
    """dF_x/dx of one carriage [N/m] under its load [N], free to give way sideways; 0 without load and preload."""
    return _condensed(guide, vertical, lateral, 0)


def lateral_stiffness(guide: BallGuide, vertical: float = 0.0, lateral: float = 0.0) -> float:
    """dF_y/dy of one carriage [N/m] under its load [N], free to give way vertically; 0 without load and preload."""
    return _condensed(guide, vertical, lateral, 1)


def preload_force(guide: BallGuide) -> float:
    """Vertical force of a pair of rows without load [N]: 2 z Q sin a."""
    load = float(guide_equilibrium(guide, 0.0).ball_load[0])
    return 2.0 * guide.balls_per_row * load * math.sin(guide.contact_angle)


def unloading_force(guide: BallGuide) -> float:
    """F_0 [N] of one carriage without lateral load: 2 z Q sin a of the pair that stays. 0 without preload."""
    rise, width = (guide.centre_distance * f(guide.contact_angle) for f in (math.sin, math.cos))
    touching = guide.centre_distance - guide.preload_oversize
    displacement = rise - math.sqrt(touching**2 - width**2)
    length = math.hypot(rise + displacement, width)
    load = float(((length - touching) / guide.hertz_constant) ** 1.5)
    return 2.0 * guide.balls_per_row * load * (rise + displacement) / length


def _condensed(guide: BallGuide, vertical: float, lateral: float, axis: int) -> float:
    """Stiffness along one axis, no force change along the other."""
    K = guide_equilibrium(guide, vertical, lateral).stiffness
    along, across, coupled = float(K[axis, axis]), float(K[1 - axis, 1 - axis]), float(K[0, 1])
    return along - coupled**2 / across if across > 0.0 else along
