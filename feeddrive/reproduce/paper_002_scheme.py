"""Paper 002: its difference scheme, its units, and numbers that follow from other printed ones."""

from __future__ import annotations

import math

from feeddrive.reproduce.paper_002_sets import SPEEDS
from feeddrive.reproduce.row import Paper, Row, claim, misprint, number

_HEAT = Paper.HEAT
_SAME_CLASSES = {17: 1, 15: 2, 14: 5}
"""Classes of the bearing that are those of the screw or nut under another number."""

_CONTACT_OF = {"screw": "C_bsg", "nut": "C_bng"}
"""Names of the contact conductances under table 5."""

_SURFACE = 16
"""n at the surface of the 16 mm screw, cells of 0.5 mm."""


def scheme_rows() -> tuple[Row, ...]:
    """Equations (13), (14) and the volumes, then what follows by arithmetic, then units."""
    return (*_coefficients(), *_arithmetic(), *_friction_equations(), *_units())


def _coefficients() -> tuple[Row, ...]:
    defect = max(abs(given - taken) for given, taken in _exchanges())
    outer = (_SURFACE + 0.25) / (_SURFACE - 0.25)
    kinds = 17 - len(_SAME_CLASSES)
    return (
        claim(_HEAT, "eq. (13)", "k1 to k6 take from a cell what they give to its neighbour", "conservative",
              f"to {defect:.0e} of an exchange", defect < 1e-12, law=None),
        claim(_HEAT, "eq. (13)", "volume of a bearing's cell, at its outer surface", "n + 0.25",
              f"n - 0.25; at n = {_SURFACE} the printed one is {outer - 1:.1%} larger", math.isclose(outer, 1.0),
              law=None,
              otherwise="n + 0.25 belongs to an inner surface, that of the nut"),
        misprint(_HEAT, "eq. (14)", "contact in the condition of class 8, a cell of the nut", "C_bsg",
                 _CONTACT_OF["nut"],
                 "class 8 meets the nut's contact, 2.7 % less in table 5; C_bsg is the screw's"),
        claim(_HEAT, "sec. 2.4", "kinds of difference equations", "at most 15", f"{kinds} of 17 numbers", kinds <= 15,
              law=None, assumption="classes 4 to 8 and 14 are not printed; 17 = 1, 15 = 2, 14 = 5 by their neighbours"),
    )  # fmt: skip


def _exchanges() -> list[tuple[float, float]]:
    """Size of a cell times its coefficient towards a neighbour, and the same from there (ring areas over pi dr^2)."""
    pairs = [(0.25 * 4, 2 * 1 * _k1(1))]  # axis and n = 1
    pairs += [(2 * n * _k2(n), 2 * (n + 1) * _k1(n + 1)) for n in range(1, 40)]
    for n in range(2, 41):
        outer, inner = 4 * (2 * n - 1) / (4 * n - 1), 4 * (2 * n + 1) / (4 * n + 1)  # k3, k5
        pairs.append(((n - 0.25) * outer, 2 * (n - 1) * _k2(n - 1)))
        pairs.append(((n + 0.25) * inner, 2 * (n + 1) * _k1(n + 1)))
        # k4, k6: through the surface of radius n.
        pairs.append(((n - 0.25) * 8 * n / (4 * n - 1), (n + 0.25) * 8 * n / (4 * n + 1)))
    return pairs


def _k1(n: int) -> float:
    return 1 - 0.5 / n


def _k2(n: int) -> float:
    return 1 + 0.5 / n


def _arithmetic() -> tuple[Row, ...]:
    settled = zip(SPEEDS, ("135", "99", "81"), (45, 33, 27), strict=True)
    return (
        *(number(_HEAT, "sec. 5", f"settling time at {N} rev/min, three time constants", "min", text, 3.0 * tau,
          law=None)
          for N, text, tau in settled),
        number(_HEAT, "fig. 5", "feed at 750 rev/min, lead 5 mm", "m/min", "3.75", 750 * 5e-3, law=None),
        number(_HEAT, "sec. 5", "axial cells of 2.5 mm in 500 mm", "", "200", 500 / 2.5, law=None),
        number(_HEAT, "sec. 5", "radial cells of 0.5 mm", "", "40", 20 / 0.5,
               law=None, assumption="nut of 40 mm outer diameter, which is not printed"),
    )  # fmt: skip


def _friction_equations() -> tuple[Row, ...]:
    nuts = 2  # of the double nut
    return (
        claim(_HEAT, "eq. (22)", "number of nuts in (22) from (18) to (20)", "κ once",
              f"κ in (19) and in (20): {nuts**2} in place of {nuts}", nuts**2 == nuts, law=None,
              otherwise="one of the two is lost, or hidden in 1.93e-4"),
    )  # fmt: skip


def _units() -> tuple[Row, ...]:
    return (
        misprint(_HEAT, "table 4", "unit of a friction torque", "N/m", "N m", "misprint: a torque"),
        misprint(_HEAT, "sec. 5", "viscosities of 32 and 170", "m²/s", "mm²/s",
                 "misprint: table 4 follows with mm²/s, and no oil has 32 m²/s"),
    )  # fmt: skip
