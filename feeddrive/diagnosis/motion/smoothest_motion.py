"""The motion of least acceleration among those that an encoder would have written down as the recorded one.

    θ = argmin |D θ|²  where  |θ - θ_m| <= step / 2 at every row,   D the second difference

| symbol | meaning | unit |
|---|---|---|
| θ_m | angle as recorded, a whole number of steps | rad |
| x, u, l | (θ - θ_m) over half a step, and the multipliers of its upper and its lower end | 1 |

A rounding error has an end: no motion that was rounded is more than half a step from what was written down. Its second
moment alone (white, of variance step²/12) takes that away, and is wrong where an axis rests or is slow: a drive that
hunts about the edge of a step writes jumps of a whole step, and steps that are passed evenly make lines, which a
spectrum does not tell from motion. Both ends leave a rest a rest, and an even motion even; a motion of many steps a row
loses of the steps' noise what lies above its own frequencies. Valid where no other noise is in the angle.
Source: Mehrotra, SIAM J. Optim. 2 (1992) 575 (primal-dual steps within ends); Milanese and Vicino, Automatica 27 (1991)
997 (errors of which only the ends are known).
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import solveh_banded

from feeddrive.typing import FloatArray

CENTRED = 0.1
"""Share of the present gap that a step aims at: the ends are neither run into nor kept away from."""

INSIDE = 0.99
"""Share of the way to the next end that a step goes at most."""

SETTLED = 1e-8
"""Mean product of a multiplier and the room left to its end, in squared half steps: a beam of
m rows under a multiplier u bends by u m⁴ / 384 half steps, a hundredth of one over 140 rows."""

MOST_STEPS = 50
"""Steps at most: some fifteen to twenty settle any length."""


def smoothest_motion(angle: FloatArray, step: float) -> FloatArray:
    """θ [rad], (n,).

    Args:
        angle: as recorded, finite [rad], (n,), n > 4.
        step: of the encoder [rad].
    """
    count, half = len(angle), 0.5 * step
    x: FloatArray = np.zeros(count)
    above, below, upper, lower = np.ones((4, count))
    at_start = _twice_differenced((angle - angle[0]) / half)
    normal = np.zeros((3, count))  # D'D, the diagonal last
    normal[2], normal[2, [0, -1]], normal[2, [1, -2]] = 6.0, 1.0, 5.0
    normal[1, 1:], normal[1, [1, -1]] = -4.0, -2.0
    normal[0, 2:] = 1.0
    for _ in range(MOST_STEPS):
        gap = float(upper @ above + lower @ below) / (2 * count)
        if gap < SETTLED:
            break
        aim, slope = CENTRED * gap, at_start + _twice_differenced(x)
        held = normal.copy()
        held[2] += upper / above + lower / below
        move = solveh_banded(held, aim / below - aim / above - slope, overwrite_ab=True, check_finite=False)
        more = aim / above - upper + upper / above * move, aim / below - lower - lower / below * move
        length = 1.0
        for room, change in ((above, -move), (below, move), (upper, more[0]), (lower, more[1])):
            length = min(length, INSIDE / max(float(np.max(-change / room)), INSIDE))
        x, above, below = x + length * move, above - length * move, below + length * move
        upper, lower = upper + length * more[0], lower + length * more[1]
    return np.asarray(angle + half * x)


def _twice_differenced(series: FloatArray) -> FloatArray:
    """D'D of a series, (n,)."""
    second = np.diff(series, 2)
    result = np.zeros(len(series))
    result[:-2] += second
    result[1:-1] -= 2 * second
    result[2:] += second
    return result
