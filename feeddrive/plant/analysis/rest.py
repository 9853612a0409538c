"""A machine at rest whose friction is declared without presliding: what small motion about rest can be.

Friction at rest is a spring, the bristles of its contacts, of a stiffness between none and that of a clamp. Where a
bristle is declared (`effects.friction.presliding`) its own stiffness and damping at zero deflection are linearised. A
friction declared as level x tanh(v / v0) has no such stiffness: its slope level / v0 is a dashpot as strong as v0 is
narrow, and v0 was chosen for the simulation. It says nothing about small motion, and two limits stand in its place,
between which the bristles of guides lie:

    free   no friction at all at the port: nothing damps, everything moves
    held   the table clamped; shafts go on turning freely, since no drag holds one at the frequencies of its modes:
           level / way of presliding is some 100 N m/rad, J w^2 at 500 Hz ten times that and more

Guides break away over micrometres. Margins that hold in both limits hold with an undamped bristle of level / 1 um and
softer, as the tests show; a spring of several times the stiffness of the chain itself would not be covered (60 N over
0.06 um).

| symbol | meaning | unit |
|---|---|---|
| v0 | width of the sign change of tanh | m/s or rad/s |
| J, w | inertia of a shaft, angular frequency of its mode | kg m^2, rad/s |
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from feeddrive.effects.base import BristleEffect, FrictionEffect, Motion, Parameter, Port, Signature, SourceEffect
from feeddrive.plant.plant import Plant
from feeddrive.typing import Expression

_STIFFER = 1e3
"""Stiffness of the clamp over that of the chain at the table: a thousandth of the motion is left."""


class _Clamp(SourceEffect):
    """Spring and damper between the table and the ground, far stiffer than the chain."""

    name = "clamp"
    ports = (Port.TABLE,)
    parameters = (Parameter("stiffness", "N/m"), Parameter("damping", "N s/m"), Parameter("zero", "m"))
    signature = Signature((), "")

    def force(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Resisting force [N]."""
        return p["stiffness"] * (motion.position - p["zero"]) + p["damping"] * motion.velocity


def ports_without_presliding(plant: Plant) -> frozenset[Port]:
    """The ports whose friction is declared and has no bristle."""
    frictions = [one for one in plant.effects if isinstance(one, FrictionEffect)]
    with_bristle = {one.port for one in frictions if isinstance(one, BristleEffect)}
    return frozenset(one.port for one in frictions if one.declared) - with_bristle


def freed(plant: Plant) -> Plant:
    """The plant without the friction that is declared without presliding; as it is where there is none."""
    ports = ports_without_presliding(plant)
    kept = tuple(one for one in plant.effects if not (isinstance(one, FrictionEffect) and one.port in ports))
    return plant if len(kept) == len(plant.effects) else replace(plant, effects=kept)


def held(plant: Plant, position: float) -> Plant:
    """The plant freed, its table clamped at a position [m]."""
    free = freed(plant)
    values = free.chain_values()
    stiffness, mass = (
        float(np.abs(np.array(of(values, position), dtype=float)[-1, -1]))
        for of in (free.chain.stiffness, free.chain.mass)
    )
    clamp = _STIFFER * stiffness
    return free.with_effects(_Clamp.of(stiffness=clamp, damping=2 * math.sqrt(clamp * mass), zero=position))
