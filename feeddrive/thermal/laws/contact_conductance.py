"""Thermal contact conductance of the balls against their preload.

    R = K/(2π λ_groove a) + K/(2π λ_ball a)          one contact, equation (11)
    C = Z / (R A)                                     per area, equation (12)

| symbol | meaning | unit |
|---|---|---|
| a | long semi-axis of the contact ellipse, grows with the load to the power 1/3 | m |
| K | complete elliptic integral of the first kind, of 1 - (b/a)² | 1 |
| Z | number of loaded balls | 1 |
| A | nominal area, of the cylinder that the balls stand for | m² |
| C | conductance per area | W/(m² K) |

A does not depend on the load: with the area of the Hertz ellipse, as the paper says, C would fall with the preload, and
table 5 rises with its third root. Source: paper 002, section 2.3; Yovanovich 1971.
"""

from __future__ import annotations

import math

from scipy.special import ellipkm1

from feeddrive.thermal.rig import refuse_unless, refuse_unless_positive


def constriction_resistance(long_axis: float, short_axis: float, groove: float, ball: float) -> float:
    """R of one contact [K/W].

    Args:
        long_axis, short_axis: a ≥ b, semi-axes of the ellipse [m].
        groove, ball: conductivities [W/(m K)].
    """
    refuse_unless(0 < short_axis <= long_axis, "no ellipse", "contact", "write 0 < short axis <= long axis")
    refuse_unless_positive(groove, "W/(m K)", "groove")
    refuse_unless_positive(ball, "W/(m K)", "ball")
    integral = float(ellipkm1((short_axis / long_axis) ** 2))
    return integral / (2 * math.pi * long_axis) * (1 / groove + 1 / ball)


def conductance_per_area(resistance: float, balls: float, area: float) -> float:
    """C [W/(m² K)] of `balls` contacts of `resistance` [K/W] on `area` [m²]."""
    refuse_unless_positive(resistance, "K/W", "resistance")
    refuse_unless_positive(area, "m^2", "area")
    return balls / (resistance * area)


def conductance_at_preload(reference: float, preload: float, reference_preload: float) -> float:
    """C at another preload, by the third root that (11) and (12) give [W/(m² K)].

    Args:
        reference: C at the reference preload.
        preload, reference_preload: [N].
    """
    refuse_unless_positive(preload, "N", "preload")
    refuse_unless_positive(reference_preload, "N", "reference_preload")
    return float(reference * (preload / reference_preload) ** (1 / 3))
