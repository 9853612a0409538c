"""Axial and torsional stiffness of a ball-screw drive in series on the table.

A ball screw back-drives almost without loss, so an axial force on the table also twists the screw, the coupling and the
motor shaft.

    k_T = k_x (L / 2 pi)^2                                (5)
    1/k_XS = 1/k_N + 1/k_BS + 1/k_BG                      (6)
    1/k_TS = 1/k_BS,T + 1/k_COUP,T + 1/k_M,T              (7)
    1/k_TOTAL,X = 1/k_XS + 1/k_TS,X                       (8)
    f = sqrt(k_TOTAL,X / m) / 2 pi

| symbol | meaning | unit |
|---|---|---|
| k_XS, k_TS | stiffness of the axial and of the torsional chain | N/m, N m/rad |
| k_TS,X | the torsional chain as an axial stiffness, by (5) | N/m |
| k_TOTAL,X | stiffness at the table, motor held | N/m |
| k_N, k_BS, k_BG | nut, screw, bearing | N/m |
| k_BS,T, k_COUP,T, k_M,T | screw, coupling, motor | N m/rad |
| L, m | lead, mass of the table | m, kg |

Valid for small motion with the preloads kept, a nut without loss, and guides that carry none of the force. Losses at
the nut and guides that stick make the drive stiffer than this, never softer. Source: paper 004, eqs. (1)-(8).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np

from feeddrive.errors import InputError
from feeddrive.parts.screw.screw_drive import BallScrewDrive
from feeddrive.typing import FloatArray


class Deformation(Enum):
    """How a part gives way."""

    AXIAL = "axial"
    TORSIONAL = "torsional"


@dataclass(frozen=True)
class Contribution:
    """What one part adds to the compliance at the table.

    Attributes:
        part: name.
        deformation: how it gives way; the screw appears with both.
        compliance: [m/N], the torsional ones by (5).
    """

    part: str
    deformation: Deformation
    compliance: float


@dataclass(frozen=True)
class CombinedStiffness:
    """Stiffness of a drive at one nut position, part by part.

    Attributes:
        lead: [m].
        contributions: of all parts that give way, from the table to the motor.
    """

    lead: float
    contributions: tuple[Contribution, ...]

    @property
    def axial(self) -> float:
        """k_XS of eq. (6) [N/m]."""
        return _stiffness(self._of(Deformation.AXIAL))

    @property
    def torsional(self) -> float:
        """k_TS of eq. (7) [N m/rad]; infinite where nothing twists."""
        return torsional_from_axial(_stiffness(self._of(Deformation.TORSIONAL)), self.lead)

    @property
    def total(self) -> float:
        """k_TOTAL,X of eq. (8) [N/m]."""
        return _stiffness(sum(one.compliance for one in self.contributions))

    @property
    def total_torsional(self) -> float:
        """k_TOTAL,T, the same stiffness felt at the screw with the table held [N m/rad]."""
        return torsional_from_axial(self.total, self.lead)

    def share(self, deformation: Deformation) -> float:
        """Share of a chain in the compliance at the table [1]."""
        return self._of(deformation) * self.total

    def shares_within(self, deformation: Deformation) -> dict[str, float]:
        """Share of each part in the compliance of its chain [1]; they add up to 1."""
        whole = self._of(deformation)
        return {one.part: one.compliance / whole for one in self.contributions if one.deformation is deformation}

    def natural_frequency(self, mass: float) -> float:
        """Natural frequency [Hz] of a mass [kg] on this spring; without the screw's own part in it."""
        return natural_frequency(self.total, mass)

    def _of(self, deformation: Deformation) -> float:
        """Compliance of a chain at the table [m/N]."""
        return sum(one.compliance for one in self.contributions if one.deformation is deformation)


def combined_stiffness(drive: BallScrewDrive, position: float) -> CombinedStiffness:
    """Stiffness of a drive, motor held, with the nut at `position` from the near bearing [m].

    Raises:
        InputError: a position outside the screw.
    """
    near, shaft, far = drive.supports.compliances(drive.screw, position)
    housing = 1.0 / drive.housing_stiffness if drive.housing_stiffness is not None else 0.0
    axial = [
        ("housing", housing),
        ("nut", 1.0 / drive.nut.axial_stiffness),
        ("screw", shaft),
        ("bearing", near),
        ("far bearing", far),
    ]
    r = drive.screw.travel_per_radian
    twist = [(spring.part, spring.compliance * r**2) for spring in reversed(drive.torsion_springs(position))]
    found = [Contribution(part, Deformation.AXIAL, compliance) for part, compliance in axial]
    found += [Contribution(part, Deformation.TORSIONAL, compliance) for part, compliance in twist]
    return CombinedStiffness(drive.screw.lead, tuple(one for one in found if one.compliance > 0.0))


def stiffness_along(drive: BallScrewDrive, positions: FloatArray) -> FloatArray:
    """k_TOTAL,X [N/m] at nut positions [m], both of shape (n,).

    Raises:
        InputError: a position outside the screw.
    """
    return np.array([combined_stiffness(drive, float(position)).total for position in positions])


def torsional_from_axial(stiffness: float, lead: float) -> float:
    """Eq. (5): the torsional stiffness [N m/rad] that an axial one [N/m] means at a screw of this lead [m]."""
    return stiffness * (lead / (2.0 * math.pi)) ** 2


def axial_from_torsional(stiffness: float, lead: float) -> float:
    """Eq. (5) the other way: the axial stiffness [N/m] that a torsional one [N m/rad] means."""
    return stiffness / (lead / (2.0 * math.pi)) ** 2


def natural_frequency(stiffness: float, mass: float) -> float:
    """sqrt(k / m) / 2 pi [Hz] of a stiffness [N/m] and a mass [kg].

    Raises:
        InputError: a stiffness that is negative or a mass that is not positive.
    """
    if not (0.0 <= stiffness < math.inf and 0.0 < mass < math.inf):
        what = f"{stiffness:g} N/m with {mass:g} kg has no natural frequency"
        raise InputError(what, "natural frequency", "write a stiffness of 0 or more and a mass above 0")
    return math.sqrt(stiffness / mass) / (2.0 * math.pi)


def _stiffness(compliance: float) -> float:
    return 1.0 / compliance if compliance > 0.0 else math.inf
