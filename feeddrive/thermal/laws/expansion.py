"""Expansion of the shaft between its bearings: growth of the table position, axial force, stretch that is left.

    F = α Θ(L) / (L/(E A) + 1/k_f + 1/k_r),    Θ(x) = ∫₀ˣ θ dx
    u(x) = -F/k_f + α Θ(x) - F x/(E A)

| symbol | meaning | unit |
|---|---|---|
| θ | rise of the cross-section | K |
| α, E, A, L | expansion, elasticity, cross-section and length of the shaft | 1/K, Pa, m², m |
| k_f, k_r | axial stiffness of the front (motor-side) and rear bearing | N/m |
| F | compression that the hindered expansion adds | N |
| u | displacement of the shaft at x, away from the front bearing | m |

One formula for every support: with k_r = 0 the far end is free and F = 0 (fixed-free, and fixed-supported where the far
bearing slides), with both stiff it is fixed-fixed. Linear while every bearing keeps its seat.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import numpy as np

from feeddrive.errors import ValidityWarning
from feeddrive.thermal.rig import Rig, refuse_negative, refuse_unless
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity


@dataclass(frozen=True)
class Supports:
    """How the shaft is held along its axis.

    Attributes:
        front: k_f, infinite for a rigid bearing [N/m].
        rear: k_r, 0 for an end that is free or slides [N/m].
        tension: with which it was stretched when cold [N].
    """

    front: float = math.inf
    rear: float = 0.0
    tension: float = 0.0

    def __post_init__(self) -> None:
        for key, value in (("front", self.front), ("rear", self.rear)):
            refuse_unless(value >= 0, f"{value:g} N/m is not possible", f"supports.{key}", "write zero or above")
        refuse_unless(self.front > 0, "the front bearing does not hold", "supports.front", "write a value above zero")
        refuse_negative(self.tension, "N", "supports.tension")
        free = self.tension > 0 and self.rear == 0
        refuse_unless(
            not free, "a shaft that is free at one end cannot be stretched", "supports.tension", "leave it out"
        )


FIXED_FREE = Supports()
"""Rigid front bearing, free far end."""


def fixed_supported(front: float, rear: float = 0.0) -> Supports:
    """Front bearing of finite stiffness; the far one slides, or is pressed on by a spring of stiffness `rear` [N/m]."""
    return Supports(front, rear)


def fixed_fixed(front: float, rear: float, tension: float = 0.0) -> Supports:
    """Both ends held by bearings of finite stiffness [N/m], stretched when cold [N]."""
    return Supports(front, rear, tension)


@dataclass(frozen=True, eq=False)
class Expansion:
    """Expansion of a shaft for one or k temperature profiles.

    Attributes:
        edges: of the cross-sections, (axial + 1,) [m].
        free: α Θ at the edges, (k, axial + 1) [m].
        force: F, (k,) [N].
        supports: how it is held.
        stiffness: E A of the shaft [N].
    """

    edges: FloatArray
    free: FloatArray
    force: FloatArray
    supports: Supports
    stiffness: float

    def growth(self, position: float) -> FloatArray:
        """u where the nut stands, (k,) [m]: the table position is wrong by it.

        Raises:
            InputError: a position that is not on the shaft.
        """
        return np.asarray(self.growths(np.array([position]))[:, 0])

    def growths(self, positions: FloatArray) -> FloatArray:
        """u at several places (m,) of the nut, (k, m) [m]; raises as `growth`."""
        for position in positions:
            good = 0 <= position <= self.edges[-1]
            refuse_unless(bool(good), f"{position:g} m is not on the shaft", "position", "count from the front end")
        after = np.clip(np.searchsorted(self.edges, positions), 1, len(self.edges) - 1)
        share = (positions - self.edges[after - 1]) / (self.edges[after] - self.edges[after - 1])
        grown = self.free[:, after - 1] * (1 - share) + self.free[:, after] * share
        return np.asarray(grown - np.outer(self.force, 1 / self.supports.front + positions / self.stiffness))

    @property
    def tension_left(self) -> FloatArray:
        """Tension of the shaft, negative where it is compressed, (k,) [N]."""
        return self.supports.tension - self.force

    @property
    def stretch_lost(self) -> FloatArray:
        """Share of the cold stretch that the heat has taken, above 1 where none is left, (k,)."""
        if self.supports.tension == 0:
            return np.where(self.force > 0, np.inf, 0.0)
        return self.force / self.supports.tension


def expansion(rig: Rig, profile: FloatArray, edges: FloatArray, supports: Supports = FIXED_FREE) -> Expansion:
    """Expansion from the mean rises of the cross-sections.

    Args:
        rig: geometry and material.
        profile: rises, (axial,) or (k, axial) [K], such as `states @ model.profile.T`.
        edges: (axial + 1,) [m].
        supports: how the shaft is held.

    Warns:
        ValidityWarning: the heat takes more than the whole cold stretch of a stretched shaft.
    """
    rows = np.atleast_2d(profile)
    refuse_unless(rows.shape[1] == len(edges) - 1, "profile and edges do not fit", "profile", "give one rise a section")
    grown = rig.steel.expansion * np.cumsum(rows * np.diff(edges), axis=1)
    free = np.hstack([np.zeros((len(rows), 1)), grown])
    stiffness = rig.steel.elasticity * math.pi * rig.radius**2
    force = np.zeros(len(rows))
    if supports.rear > 0:
        force = free[:, -1] / (rig.length / stiffness + 1 / supports.front + 1 / supports.rear)
    found = Expansion(edges, free, force, supports, stiffness)
    if supports.tension > 0 and np.any(found.tension_left < 0):
        what = f"heat adds {format_quantity(float(force.max()), 'N')} to a stretch of"
        warnings.warn(
            f"{what} {format_quantity(supports.tension, 'N')}: the shaft is compressed", ValidityWarning, stacklevel=2
        )
    return found
