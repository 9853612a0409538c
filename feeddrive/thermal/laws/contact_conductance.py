"""Thermal contact conductance of the balls against their preload.

    R = K/(2π λ_groove a) + K/(2π λ_ball a)          one contact, equation (11)
    C = Z / (R A)                                     per area, equation (12)

K is the complete elliptic integral of the ellipse's shape, λ a conductivity, Z the number of loaded balls. The long
semi-axis a of the contact grows with the third root of the load, and A, the area of the cylinder that the balls stand
for, does not: C grows with the third root of the preload. With the area of the Hertz ellipse, as the paper says, it
would fall, and its table 5 rises. Source: paper 002, section 2.3; Yovanovich 1971.
"""

from __future__ import annotations

from feeddrive.thermal.rig import refuse_unless_positive


def conductance_at_preload(reference: float, preload: float, reference_preload: float) -> float:
    """C at another preload, by the third root that (11) and (12) give [W/(m² K)].

    Args:
        reference: C at the reference preload.
        preload, reference_preload: [N].
    """
    refuse_unless_positive(preload, "N", "preload")
    refuse_unless_positive(reference_preload, "N", "reference_preload")
    return float(reference * (preload / reference_preload) ** (1 / 3))
