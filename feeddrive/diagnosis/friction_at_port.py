"""What friction a plant declares at a port, read off the laws themselves, whatever keys they have."""

from __future__ import annotations

import casadi as ca

from feeddrive.effects.base import FrictionEffect, Motion, Port
from feeddrive.plant.plant import Plant
from feeddrive.typing import Expression

TYPICAL_VELOCITY = 0.1
"""Velocity [m/s] at which declared friction is read; at the screw the speed that goes with it."""

TYPICAL_FORCE = 1000.0
"""Transmitted force [N] at which declared friction is read."""


def declared_level(plant: Plant, port: Port) -> float:
    """Coulomb level that is declared at a port [N, or N m at a shaft]; 0 where none is."""
    motion = _typical(plant, port)
    return sum(_number(effect.level(motion, effect.values)) for effect in _declared(plant, port))


def declared_viscous(plant: Plant, port: Port) -> float:
    """Speed-dependent force that is declared at a port [N, or N m at a shaft]; 0 where none is."""
    motion = _typical(plant, port)
    return sum(_number(effect.viscous(motion, effect.values)) for effect in _declared(plant, port))


def _declared(plant: Plant, port: Port) -> list[FrictionEffect]:
    return [e for e in plant.effects if isinstance(e, FrictionEffect) and e.declared and e.port == port]


def _typical(plant: Plant, port: Port) -> Motion:
    r = plant.chain.radius
    velocity = TYPICAL_VELOCITY if port == Port.TABLE else TYPICAL_VELOCITY / r
    return Motion(0.0, velocity, 0.0, TYPICAL_FORCE, r)


def _number(value: Expression) -> float:
    return float(ca.DM(value))  # laws are written for expressions; here every input is a number
