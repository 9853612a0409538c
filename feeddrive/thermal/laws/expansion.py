"""Growth of the table position by the expansion of a shaft that is held at its front (motor-side) bearing alone.

    u(x) = α ∫₀ˣ θ dx

| symbol | meaning | unit |
|---|---|---|
| θ | rise of the cross-section | K |
| α | expansion | 1/K |
| u | displacement of the shaft at x, away from the front bearing | m |

Valid for fixed-free supports, and for fixed-supported ones whose far bearing slides.
"""

from __future__ import annotations

import numpy as np

from feeddrive.thermal.rig import Rig, refuse_unless
from feeddrive.typing import FloatArray


def growths(rig: Rig, profile: FloatArray, edges: FloatArray, positions: FloatArray) -> FloatArray:
    """u where the nut stands: the table position is wrong by it.

    Args:
        rig: geometry and material.
        profile: mean rises of the cross-sections, (axial,) or (k, axial) [K], such as `states @ model.profile.T`.
        edges: of the cross-sections, (axial + 1,) [m].
        positions: of the nut, (m,) [m].

    Returns:
        Growths, (k, m) [m].

    Raises:
        InputError: a position that is not on the shaft, or a profile of other sections.
    """
    rows = np.atleast_2d(profile)
    refuse_unless(rows.shape[1] == len(edges) - 1, "profile and edges do not fit", "profile", "give one rise a section")
    for position in positions:
        good = 0 <= position <= edges[-1]
        refuse_unless(bool(good), f"{position:g} m is not on the shaft", "position", "count from the front end")
    grown = rig.steel.expansion * np.cumsum(rows * np.diff(edges), axis=1)
    free = np.hstack([np.zeros((len(rows), 1)), grown])
    after = np.clip(np.searchsorted(edges, positions), 1, len(edges) - 1)
    share = (positions - edges[after - 1]) / (edges[after] - edges[after - 1])
    return np.asarray(free[:, after - 1] * (1 - share) + free[:, after] * share)
