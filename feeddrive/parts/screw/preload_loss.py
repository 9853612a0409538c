"""What is seen of a double nut's preload as it is lost: torque falls with it, stiffness with its cube root.

    T_a / T_a,new = F_0 / F_0,new,      k / k_new = (F_0 / F_0,new)^(1/3),      F_open = 2 sqrt(2) F_0

| symbol | meaning | unit |
|---|---|---|
| F_0 | preload | N |
| T_a | preload torque without its load-independent part (viscous drag, wipers) | N m |
| k | axial stiffness of the nut about zero load | N/m |
| F_open | axial load at which one nut comes free, rigid preload | N |

The torque shows a loss three times as clearly as the stiffness: 6 kN to 5 kN takes 17 % of the torque
and 6 % of the stiffness. Neither paper has a law of wear.
Validity: the same friction coefficient before and after, so the same lubricant at the same temperature and speed;
elastic Hertz contacts. Source: paper 000, eq. (7), for the torque; Hertz for the stiffness; paper 001, section 2.1,
found its failures by the preload torque.
"""

from __future__ import annotations

import math

from feeddrive.errors import InputError
from feeddrive.parts.elementary import power
from feeddrive.parts.screw.double_nut import OPENING
from feeddrive.parts.values import PartValue, check_values

_PRELOAD = PartValue("preload", "N", 0.0, 1e9, open_ends=False)
_SHARE = PartValue("preload_share", "1", 0.0, 10.0, usual=(0.0, 1.1), open_ends=False)


def torque_share(preload_share: float) -> float:
    """T_a over that of the new screw [1] at F_0 over that of the new screw.

    Raises:
        InputError: a negative share.
    """
    check_values("nut", (_SHARE,), {"preload_share": preload_share})
    return preload_share


def stiffness_share(preload_share: float) -> float:
    """k over that of the new screw [1] at F_0 over that of the new screw.

    Raises:
        InputError: a negative share.
    """
    check_values("nut", (_SHARE,), {"preload_share": preload_share})
    return float(preload_share ** (1.0 / 3.0))


def preload_share_from_torque(torque: float, new_torque: float, drag: float = 0.0) -> float:
    """F_0 over that of the new screw from preload torques.

    Args:
        torque, new_torque: as measured now and when new, at the same speed and temperature [N m].
        drag: load-independent part of both, from the regression of torque on preload [N m].

    Raises:
        InputError: a torque below the drag, or not finite.
    """
    if not (math.inf > new_torque > drag >= 0.0 and math.inf > torque >= drag):
        what = f"preload torques of {torque:g} and {new_torque:g} N m at a drag of {drag:g} N m"
        raise InputError(what, "preload loss", "both torques must exceed the load-independent drag, itself 0 or more")
    return (torque - drag) / (new_torque - drag)


def preload_share_from_stiffness(stiffness: float, new_stiffness: float) -> float:
    """F_0 over that of the new screw from the nut's stiffness about zero load now and when new [N/m].

    An error of the stiffness comes back threefold.

    Raises:
        InputError: a stiffness that is not possible.
    """
    for key, value in (("stiffness", stiffness), ("new_stiffness", new_stiffness)):
        check_values("nut", (PartValue(key, "N/m", 0.0),), {key: value})
    return power(stiffness / new_stiffness, 3.0)


def opening_force(preload: float) -> float:
    """F_open [N] of a rigidly preloaded double nut at a preload [N]; refuses a negative one."""
    check_values("nut", (_PRELOAD,), {"preload": preload})
    return OPENING * preload
