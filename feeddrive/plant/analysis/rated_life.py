"""Rated life of a plant's ball screw at its declared axial load: revolutions, travel and time that 90 % survive.

    F_A, F_B  of F and the preload (rigid),     L_j = (C / F_j)^p,     L^-e = L_A^-e + L_B^-e

| symbol | meaning | unit |
|---|---|---|
| C | basic dynamic rating of a single nut, `ball_screw.dynamic_rating` | N |
| F | axial force, always to the same side | N |
| F_A, F_B | loads of the two nuts of `feeddrive.parts.screw.double_nut`; F and 0 without preload | N |
| L_j, L | rated life of one nut, of both together | rev |
| p, e | exponents of `feeddrive.parts.life.life_exponents` | 1 |

Under a duty of several forces 1/L_j is the mean of (F_j/C)^p over the travel (Palmgren and Miner).
The preload is that of [nut] or of `nut_friction`; it loads the nuts at all times, so life ends without any force too.
Validity: as `feeddrive.parts.life.life`, so no factor for film or dirt. Source: paper 001, eqs. (9), (23), (24).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

from feeddrive.effects.friction.nut_friction import NutFriction
from feeddrive.errors import InputError
from feeddrive.parts.life.life import distance, life_together, rated_revolutions, running_time
from feeddrive.parts.screw.double_nut import rigid_sharing
from feeddrive.plant.plant import Plant


@dataclass(frozen=True)
class LifeRow:
    """Life under one constant axial force.

    Attributes:
        force: F [N].
        nut_loads: F_A, F_B [N].
        revolutions: L; infinite without any load [rev].
        travel: of the table [m].
        time: at the declared greatest velocity [s]; None where none is declared.
    """

    force: float
    nut_loads: tuple[float, float]
    revolutions: float
    travel: float
    time: float | None


def rated_life(plant: Plant) -> tuple[LifeRow, ...]:
    """Life by preload alone, where there is one, and at the declared axial load.

    Returns:
        None of them where the file gives no `ball_screw.dynamic_rating`.

    Warns:
        ValidityWarning: a load above half the rating.
    """
    load = datum(plant, "table.axial_load")
    if datum(plant, "ball_screw.dynamic_rating") is None:
        return ()
    forces = ([0.0] if preload_of(plant) > 0.0 else []) + ([load] if load is not None else [])
    return tuple(_row(plant, force) for force in forces)


def life_under(plant: Plant, duty: Sequence[tuple[float, float]]) -> float:
    """Revolutions that 90 % survive under a duty of shares of the travel, 1 together, each with its axial force [N].

    Infinite without load; InputError without `ball_screw.dynamic_rating`, and a warning of a load above half of it.
    """
    rating = datum(plant, "ball_screw.dynamic_rating")
    if rating is None:
        raise InputError("no dynamic rating", plant.name, "declare ball_screw.dynamic_rating")
    worn = [0.0, 0.0]
    for share, force in duty:
        for nut, load in enumerate(rigid_sharing(force, preload_of(plant))):
            worn[nut] += share / rated_revolutions(rating, float(load))
    return life_together([1.0 / one if one > 0.0 else math.inf for one in worn])


def preload_of(plant: Plant) -> float:
    """Preload of the nut, from [nut] or from its friction [N]; 0 where none is declared."""
    declared = datum(plant, "nut.preload")
    if declared is not None:
        return declared
    return next((cast(float, e.values["preload"]) for e in plant.effects if isinstance(e, NutFriction)), 0.0)


def _row(plant: Plant, force: float) -> LifeRow:
    loads = tuple(float(nut) for nut in rigid_sharing(force, preload_of(plant)))
    together = life_under(plant, [(1.0, force)])
    velocity = datum(plant, "table.max_velocity")
    time = running_time(together, velocity / plant.chain.radius) if velocity is not None else None
    travel = distance(together, 2 * math.pi * plant.chain.radius)
    return LifeRow(force, (loads[0], loads[1]), together, travel, time)


def datum(plant: Plant, key: str) -> float | None:
    """A declared value of a part or a rating, `section.key` [SI]; None where the file gives none."""
    return plant.data[key].value if key in plant.data else None
