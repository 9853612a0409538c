"""The lead map: travel error of a screw over position, slower than anything that a recording shows to be periodic.

Every screw has one beside the line: ISO 3408-3 allows 23 µm of it within 300 mm in class 5, 52 µm in class 7. No name
of a law says it, and what is left of it makes others look needed: an asymmetry, a stiffness along the stroke. So where
it is likelier than every name (`forms.open_map`), comparisons are without

    P_k(s) - a - b s,   k = 2, 3;   s = (2 x - x_max - x_min) / (x_max - x_min)

| symbol | meaning | unit |
|---|---|---|
| x | measured table position | m |
| P_k | Legendre polynomial, k half waves over the stroke | 1 |
| a, b | line through it over all samples; a line is `lead_error_cumulative` | 1 |

Once the names are found the map counts again: it is told and carried as a table of the travel over position.
"""

from __future__ import annotations

import math

import numpy as np

from feeddrive.typing import FloatArray

HALF_WAVES = (2, 3)
"""Less than two periods in the travel: from two on, an error is looked for as a periodic one."""

SIZE = 50e-6
"""Deviation of each [m], class 7 of ISO 3408-3. Any that is far above a scale's noise does the same."""


def lead_map(position: FloatArray, radius: float) -> FloatArray:
    """What a lead map may be of a recording, (n, k) [m].

    No columns where a stroke has fewer revolutions than half waves: an error of two revolutions is no slower then.

    Args:
        position: of the table [m], (n,).
        radius: travel per screw angle [m/rad].
    """
    low, stroke = float(np.min(position)), float(np.ptp(position))
    seen = [k for k in HALF_WAVES if stroke >= k * 2 * math.pi * radius]
    if not seen:
        return np.zeros((len(position), 0))
    place = 2 * (position - low) / stroke - 1
    line = np.column_stack([np.ones(len(place)), place])
    curves = np.column_stack([np.polynomial.Legendre.basis(k)(place) for k in seen])
    beside: FloatArray = curves - line @ np.linalg.lstsq(line, curves, rcond=None)[0]
    return SIZE * beside
