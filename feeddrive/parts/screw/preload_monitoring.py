"""What is seen of a double nut's preload as it is lost: its stiffness falls with the cube root.

    k / k_new = (F_0 / F_0,new)^(1/3)

| symbol | meaning | unit |
|---|---|---|
| F_0 | preload | N |
| k | axial stiffness of the nut about zero load | N/m |

The preload torque falls with the preload itself, three times as clearly: 6 kN to 5 kN takes 17 % of the torque and 6 %
of the stiffness. Validity: elastic Hertz contacts. Source: Hertz; paper 000, eq. (7), for the torque.
"""

from __future__ import annotations

from feeddrive.parts.values import PartValue, check_values

_SHARE = PartValue("preload_share", "1", 0.0, 10.0, usual=(0.0, 1.1), open_ends=False)


def stiffness_share(preload_share: float) -> float:
    """k over that of the new screw [1] at F_0 over that of the new screw.

    Raises:
        InputError: a negative share.
    """
    check_values("nut", (_SHARE,), {"preload_share": preload_share})
    return float(preload_share ** (1.0 / 3.0))
