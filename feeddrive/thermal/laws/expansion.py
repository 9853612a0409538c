"""Growth of the table position by the expansion of a shaft that its front (motor-side) bearing holds, or both bearings.

    front alone   u(x) = α ∫₀ˣ θ dx
    both ends     u(x) = α ∫₀ˣ θ dx - s(x) α ∫₀ˡ θ dx,       s(x) = (1/k_1 + x/EA) / (1/k_1 + l/EA + 1/k_2)

| symbol | meaning | unit |
|---|---|---|
| θ | rise of the cross-section | K |
| α | expansion | 1/K |
| u | displacement of the shaft at x, away from the front bearing | m |
| s | share of the whole expansion that the thrust between the bearings pushes back at x | 1 |
| k_1, k_2 | axial stiffness of front and rear bearing | N/m |
| EA, l | axial rigidity and length of the shaft | N, m |

The thrust P = α ∫₀ˡ θ dx / (1/k_1 + l/EA + 1/k_2) is the same in the whole shaft: it pushes the front bearing back by
P/k_1 and shortens the shaft by P x/EA up to x. Rigid bearings leave the ends where they are, and an evenly warm shaft
as a whole; a soft far one gives back the growth from the front alone.

Valid for fixed-free supports, fixed-supported ones whose far bearing slides, and fixed-fixed ones while both bearings
stay preloaded; machine and housings are taken as cold.
"""

from __future__ import annotations

import numpy as np

from feeddrive.thermal.full.grid import covered_share
from feeddrive.thermal.rig import Rig, refuse_unless
from feeddrive.typing import FloatArray


def growth_row(rig: Rig, edges: FloatArray, position: float) -> FloatArray:
    """What each cross-section's rise adds to u where the nut stands at `position` [m], (axial,) [m/K].

    `edges` are those of the cross-sections, (axial + 1,) [m]. A position off the shaft raises InputError.
    """
    good = 0 <= position <= edges[-1]
    refuse_unless(bool(good), f"{position:g} m is not on the shaft", "position", "count from the front end")
    held = rig.both_ends
    pushed_back = 0.0
    if held is not None:
        shaft = rig.length / held.axial_rigidity
        pushed_back = (1 / held.near + shaft * position / rig.length) / (1 / held.near + shaft + 1 / held.far)
    return np.asarray(rig.steel.expansion * np.diff(edges) * (covered_share(0.0, position, edges) - pushed_back))


def growths(rig: Rig, profile: FloatArray, edges: FloatArray, positions: FloatArray) -> FloatArray:
    """u where the nut stands, by which the table position is wrong, (k, m) [m].

    Takes mean rises of the cross-sections, (axial,) or (k, axial) [K], such as `states @ model.profile.T`, their edges,
    (axial + 1,) [m], and positions of the nut, (m,) [m]. Raises InputError: a position off the shaft, or a profile of
    other sections.
    """
    rows = np.atleast_2d(profile)
    refuse_unless(rows.shape[1] == len(edges) - 1, "profile and edges do not fit", "profile", "give one rise a section")
    return np.asarray(rows @ np.array([growth_row(rig, edges, float(position)) for position in positions]).T)
