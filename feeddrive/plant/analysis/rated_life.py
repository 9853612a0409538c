"""Rated life of a plant's ball screw at its declared axial load: revolutions, travel and time that 90 % survive.

    F_A, F_B  of F and the preload (rigid),     L_j = (C / F_j)^p,     L^-e = L_A^-e + L_B^-e

| symbol | meaning | unit |
|---|---|---|
| C | basic dynamic rating of a single nut, `ball_screw.dynamic_rating` | N |
| F | axial force, always to the same side | N |
| F_A, F_B | loads of the two nuts of `feeddrive.parts.screw.double_nut`; F and 0 without preload | N |
| L_j, L | rated life of one nut, of both together | rev |
| p, e | exponents of `feeddrive.parts.life.life_exponents` | 1 |

The preload is that of [nut] or of `nut_friction`; it loads the nuts at all times, so life ends without any force too.
Validity: as `feeddrive.parts.life.life`, so no factor for film or dirt. Source: paper 001, eqs. (9), (23), (24).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import cast

from feeddrive.effects.friction.nut_friction import NutFriction
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
    rating, load = _datum(plant, "ball_screw.dynamic_rating"), _datum(plant, "table.axial_load")
    if rating is None:
        return ()
    preload = preload_of(plant)
    forces = ([0.0] if preload > 0.0 else []) + ([load] if load is not None else [])
    return tuple(_row(plant, rating, preload, force) for force in forces)


def preload_of(plant: Plant) -> float:
    """Preload of the nut, from [nut] or from its friction [N]; 0 where none is declared."""
    declared = _datum(plant, "nut.preload")
    if declared is not None:
        return declared
    return next((cast(float, e.values["preload"]) for e in plant.effects if isinstance(e, NutFriction)), 0.0)


def _row(plant: Plant, rating: float, preload: float, force: float) -> LifeRow:
    loads = tuple(float(nut) for nut in rigid_sharing(force, preload))
    together = life_together([rated_revolutions(rating, load) for load in loads])
    velocity = _datum(plant, "table.max_velocity")
    time = running_time(together, velocity / plant.chain.radius) if velocity is not None else None
    travel = distance(together, 2 * math.pi * plant.chain.radius)
    return LifeRow(force, (loads[0], loads[1]), together, travel, time)


def _datum(plant: Plant, key: str) -> float | None:
    return plant.data[key].value if key in plant.data else None
