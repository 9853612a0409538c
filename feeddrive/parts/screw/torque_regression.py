"""Preload torque split into a part that grows with the preload and one that does not, by regression.

    T(F_0) = k F_0 + T_v

| symbol | meaning | unit |
|---|---|---|
| T, F_0 | measured preload torque, preload | N m, N |
| k | slope: the Coulomb part, from which f follows | N m/N |
| T_v | lubricant, seals and whatever does not depend on the preload | N m |

Least squares: errors of equal size, independent, none in the preload. Where the lubricant's share itself grows with the
load (as paper 000 reports for oil), k holds it too and f is too high.
Source: split of paper 000, sections 4.1 and 4.2; the regression is standard.
"""

from __future__ import annotations

import numpy as np

from feeddrive.errors import InputError
from feeddrive.typing import FloatArray


def split_torque(preload: FloatArray, torque: FloatArray) -> tuple[float, float]:
    """k [N m/N] and T_v [N m] of torques T, (n,) [N m], at two preloads F_0 or more, (n,) [N].

    Raises:
        InputError: preloads that are all one, or another number of torques.
    """
    if np.shape(preload) != np.shape(torque) or np.ptp(np.asarray(preload, dtype=float)) == 0:
        raise InputError("a line needs torques at two preloads or more", "drag torque", "measure at another preload")
    slope, rest = np.polyfit(preload, torque, 1)
    return float(slope), float(rest)
