"""Coefficients of guide friction: rolling, slip, oil, and two sets that fit what paper 003 prints.

The paper publishes none of them, only shares of the parts. Shares fix two ratios, of viscous to rolling and of slip to
rolling; the size of the force itself stays open, and follows here from an oil like ISO VG 150. So the sets tell how
friction divides and how it changes with load and speed; for its size in newtons, measure or take a catalogue.
Source: fitted to paper 003, sections 5.1 and 5.2.
No set meets every printed share; why, stands in the comparison with the papers (`feeddrive.reproduce.paper_003`).
"""

from __future__ import annotations

from dataclasses import dataclass

from feeddrive.parts.guide.guide_film import Oil
from feeddrive.parts.values import PartValue, check_values

COEFFICIENT_VALUES = (
    PartValue("rolling", "1", 0.0, 1.0, usual=(0.0, 0.02), open_ends=False),
    PartValue("slip", "1", 0.0, 1.0, usual=(0.0, 0.2), open_ends=False),
)


@dataclass(frozen=True)
class GuideCoefficients:
    """What a guide's friction depends on besides geometry and load.

    Attributes:
        rolling: mu_t [1].
        slip: mu_s [1].
        oil: the lubricant.

    Raises:
        InputError: a value that is not possible.

    Warns:
        ValidityWarning: an unusual one.
    """

    rolling: float
    slip: float
    oil: Oil

    def __post_init__(self) -> None:
        check_values("guide", COEFFICIENT_VALUES, {"rolling": self.rolling, "slip": self.slip})


SET_A = GuideCoefficients(2.82e-4, 0.0095, Oil(0.13, 2.2e-8))
"""Fitted to the shares without load, both sizes of table 2.

Satisfies: rolling 63 to 71 % at 0.06 m/min, viscous 81 to 85 % at 100 m/min and slip 2 to 4 % without load; friction
nearly equal at 0 and 1 kN, and the jump at 6 kN.
Does not: slip at 24 kN (10 to 33 %, printed 11 to 45 %); rolling dominant below 2 m/min (below 0.45 and 0.64 m/min
without load, below 2 m/min only above about 5 and 6 kN).
"""

SET_B = GuideCoefficients(2.62e-4, 0.0134, Oil(0.13, 2.2e-8))
"""Fitted to every printed range at once, smallest largest miss.

Satisfies: each printed share within 2.5 percentage points, slip at 24 kN included (13 to 43 %).
Does not: slip of 2 to 4 % without load (6 %), rolling of 63 to 71 % at 0.06 m/min (61 % for HSR-20R); rolling dominant
below 2 m/min.
"""
