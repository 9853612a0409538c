"""How a preloaded double nut shares an axial load, and the torque that it takes in every quadrant.

    w > 0:  T = r (F_A / eta_a - F_B eta_b)          w < 0:  T = r (F_A eta_b - F_B / eta_a)
    T = F r + sign(w) T_f,     T_f = r (F_A l_a + F_B l_b)  for w > 0,  r (F_A l_b + F_B l_a)  for w < 0

| symbol | meaning | unit |
|---|---|---|
| F | axial force that the screw gives to the table, F = F_A - F_B | N |
| F_A, F_B | load of the nut that pushes in +, in - direction; neither is negative | N |
| F_0 | preload: F_A = F_B = F_0 without load; 0 for a single nut | N |
| w | speed of the screw, w > 0 moves the table in + direction | rad/s |
| r | lead / 2 pi | m |
| T_f | friction torque, never negative: it resists in all four quadrants | N m |
| l_a, l_b | losses 1/eta_a - 1 and 1 - eta_b | 1 |

Rigid preload (spacer, oversize balls), Hertz contacts of stiffness ~ F^(1/3), nut bodies stiff:

    F_A^(2/3) + F_B^(2/3) = 2 F_0^(2/3)   until F_B = 0 at F = 2 sqrt(2) F_0, then F_A = F

With d = (F_A^(1/3) - F_B^(1/3)) / F_0^(1/3) it reads d^3 - 6 d + 2 F/F_0 = 0, whose middle root is
d = 2 sqrt(2) sin(asin(F / (2 sqrt(2) F_0)) / 3).
Source: paper 000, eq. (7) and figure 3, carried on to an axial load here; Hertz for the exponent 2/3.

What is seen of a double nut's preload as it is lost: its stiffness falls with the cube root.

    k / k_new = (F_0 / F_0,new)^(1/3)

| symbol | meaning | unit |
|---|---|---|
| F_0 | preload | N |
| k | axial stiffness of the nut about zero load | N/m |

The preload torque falls with the preload itself, three times as clearly: 6 kN to 5 kN takes 17 % of the torque and 6 %
of the stiffness. Validity: elastic Hertz contacts. Source: Hertz; paper 000, eq. (7), for the torque.
"""

from __future__ import annotations

import math

from feeddrive.parts.elementary import arcsine, positive_part, sine, within
from feeddrive.parts.values import PartValue, check_values
from feeddrive.typing import Expression

OPENING = 2 * math.sqrt(2)
"""Axial force over rigid preload at which one nut comes free."""

_NEAR_OPENING = 1 - 1e-12
"""Share of the opening force where the root is held: its slope there is 0 times infinite."""

_LEAST_PRELOAD = 1e-9
"""Preload [N] below which it is none; keeps F / F_0 finite."""


def rigid_sharing(force: Expression, preload: Expression) -> tuple[Expression, Expression]:
    """F_A and F_B [N] at axial force [N] and rigid preload [N], 0 or more; numbers, arrays or expressions."""
    limit = OPENING * preload
    carried = within(force, limit)
    share = within(carried / (OPENING * (preload + _LEAST_PRELOAD)), _NEAR_OPENING)
    d = OPENING * sine(arcsine(share) / 3)
    total = (4 - d**2) ** 0.5
    beyond = force - carried
    nut_a = preload * (0.5 * (total + d)) ** 3 + positive_part(beyond)
    nut_b = preload * (0.5 * (total - d)) ** 3 + positive_part(-beyond)
    return nut_a, nut_b


def friction_torque_forward(
    nut_a: Expression, nut_b: Expression, radius: Expression, driving: Expression, back_driving: Expression
) -> Expression:
    """T_f [N m] for w > 0, from F_A, F_B [N], r [m] and the losses l_a, l_b."""
    return radius * (nut_a * driving + nut_b * back_driving)


def friction_torque_backward(
    nut_a: Expression, nut_b: Expression, radius: Expression, driving: Expression, back_driving: Expression
) -> Expression:
    """T_f [N m] for w < 0, positive; arguments as `friction_torque_forward`: the nuts change roles."""
    return friction_torque_forward(nut_b, nut_a, radius, driving, back_driving)


_SHARE = PartValue("preload_share", "1", 0.0, 10.0, usual=(0.0, 1.1), open_ends=False)


def stiffness_share(preload_share: float) -> float:
    """k over that of the new screw [1] at F_0 over that of the new screw.

    Raises:
        InputError: a negative share.
    """
    check_values("nut", (_SHARE,), {"preload_share": preload_share})
    return float(preload_share ** (1.0 / 3.0))
