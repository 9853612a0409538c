"""Friction coefficient from a measured preload torque: the exact inverse of `feeddrive.parts.screw.preload_torque`.

    f = a_n t_n / (1 + sqrt(1 + t_n^2 b_n^2)),     t_n = 2 pi T_a / (F_0 L)

Symbols as in `parts.screw.preload_torque`. The paper writes a_n (sqrt(1 + t_n^2 b_n^2) - 1) / (t_n b_n^2), the
same value with a difference of near numbers; this form loses no digits and is 0 at no torque.
It assumes one f at both nuts. A torque that does not depend on the load (lubricant, seals) makes f look larger the
smaller the preload is: separate it first (`feeddrive.parts.screw.torque_regression`).
Source: paper 000, eq. (8).
"""

from __future__ import annotations

from feeddrive.parts.screw.preload_torque import ideal_torque
from feeddrive.parts.screw.slip_angle import Groove
from feeddrive.typing import Expression


def relative_torque(torque: Expression, preload: Expression, lead: Expression) -> Expression:
    """t_n from torque [N m], preload [N], not 0, and lead [m]."""
    return torque / ideal_torque(preload, lead)


def friction_from_torque(relative: Expression, groove: Groove) -> Expression:
    """f from t_n, which is 0 or more; numbers, arrays or expressions."""
    return groove.a_n * relative / (1 + (1 + (relative * groove.b_n) ** 2) ** 0.5)
