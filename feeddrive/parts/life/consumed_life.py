"""Life that a recorded motion takes from every nut of a ball screw: Palmgren and Miner's sum over revolutions.

    D_j = sum_i (|phi_(i+1) - phi_i| / (2 pi 10^6)) (F_j,i / C)^p,       S = 0.9^(sum_j D_j^e)

| symbol | meaning | unit |
|---|---|---|
| D_j | share of its rated life that nut j has used | 1 |
| phi | angle of the screw | rad |
| F_j | axial load of nut j, its preload included, never negative | N |
| C | basic dynamic axial rating of a single nut | N |
| S | probability that all nuts are whole | 1 |
| p, e | exponents of `feeddrive.parts.life.life_exponents` | 1 |

Two equally loaded nuts reach S = 0.9 at D_j = 2^(-1/e). Every wiggle of the angle counts as rolling, so an angle whose
noise is larger than its motion overstates the life used.
Valid as `feeddrive.parts.life.life`.
Source: paper 001, eqs. (9), (23), (24), carried on to a varying load; Miner for the sum.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.parts.life.life import MILLION, life_together
from feeddrive.parts.life.life_exponents import BALL_SCREW
from feeddrive.parts.screw.double_nut import rigid_sharing
from feeddrive.parts.values import PartValue, check_values
from feeddrive.typing import FloatArray


@dataclass(frozen=True, eq=False)
class ConsumedLife:
    """Life used along a recording.

    Attributes:
        revolutions: turned up to each sample, either way, (n,) [rev].
        used: D_j up to each sample, (nuts, n) [1].
        forces: loads of the nuts at each sample, (nuts, n) [N].
        rating: C of a single nut [N].
    """

    revolutions: FloatArray
    used: FloatArray
    forces: FloatArray
    rating: float

    @property
    def total(self) -> FloatArray:
        """D_j of the whole recording, (nuts,) [1]."""
        return np.asarray(self.used[:, -1], dtype=float)

    @property
    def equivalent(self) -> FloatArray:
        """Constant load of each nut that takes as much life over the same revolutions, (nuts,) [N]; 0 without any."""
        turned = float(self.revolutions[-1])
        if turned == 0.0:
            return np.zeros(len(self.used))
        return np.asarray(self.rating * (self.total * MILLION / turned) ** (1.0 / BALL_SCREW.load), dtype=float)

    @property
    def repetitions(self) -> float:
        """How often 90 % survive the recording, one after another; infinite where it takes no life."""
        return life_together([1.0 / used if used > 0.0 else math.inf for used in self.total])


def consumed_life(screw_angle: FloatArray, nut_forces: FloatArray, rating: float) -> ConsumedLife:
    """Life that a motion takes from every nut.

    Args:
        screw_angle: unwrapped, (n,) with n of 2 or more [rev x 2 pi = rad].
        nut_forces: size of the axial load of every nut at every sample, acting to the next one, (nuts, n) [N].
        rating: C of a single nut [N].

    Raises:
        InputError: shapes that do not match, values that are not finite, negative loads, a rating that is not positive.
    """
    check_values("nut", (PartValue("rating", "N", 0.0, usual=(10.0, 5e6)),), {"rating": rating})
    forces = np.atleast_2d(np.asarray(nut_forces, dtype=float))
    if screw_angle.ndim != 1 or screw_angle.size < 2 or forces.shape[1] != screw_angle.size:
        what = f"angles of shape {screw_angle.shape} and loads of shape {forces.shape}"
        raise InputError(what, "consumed life", "give two samples or more, and a load of every nut at each")
    if not (np.all(np.isfinite(screw_angle)) and np.all(np.isfinite(forces)) and np.all(forces >= 0.0)):
        raise InputError("an angle or a load is not finite, or a load is negative", "consumed life", "mend the samples")
    steps = np.abs(np.diff(screw_angle)) / (2.0 * math.pi)
    shares = steps / MILLION * (forces[:, :-1] / rating) ** BALL_SCREW.load
    revolutions = np.concatenate(([0.0], np.cumsum(steps)))
    used = np.concatenate((np.zeros((forces.shape[0], 1)), np.cumsum(shares, axis=1)), axis=1)
    return ConsumedLife(revolutions, used, forces, rating)


def rigid_nut_forces(axial_force: FloatArray, preload: float) -> FloatArray:
    """Loads of a rigidly preloaded double nut under the force on the table, (2, n) [N]; F_0 = 0 is a nut with play."""
    check_values("nut", (PartValue("preload", "N", 0.0, open_ends=False),), {"preload": preload})
    return np.vstack(rigid_sharing(np.asarray(axial_force, dtype=float), preload))
