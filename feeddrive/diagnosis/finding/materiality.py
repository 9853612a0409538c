"""The physical minimum: what is too small for anyone to act on is no finding, however significant."""

from __future__ import annotations

from feeddrive.diagnosis.declared_friction import declared_level
from feeddrive.diagnosis.heat.materiality import is_material_heat
from feeddrive.effects.base import Effect, Kind, Port
from feeddrive.effects.chain.inertia_deviation import InertiaDeviation, declared_inertia
from feeddrive.plant.plant import Plant

LEAST_FACTOR = 0.005
"""Deviation of a friction factor from 1. No declared friction is known to that, but a quiet drive shows it, and what
shows and is left without its name leaves the error to the next best one."""

LEAST_SOFTENING = 0.02
"""Stiffness that is lost around zero force, over that under load."""

LEAST_STIFFNESS_SHARE = 0.003
"""Deviation of a stiffness from the declared one. No catalogue knows it to that, but a scale shows it; left without its
name it would be taken for a free play of some nanometres."""

LEAST_FORCE_SHARE = 0.003
"""A force over the declared Coulomb level of the guide."""

LEAST_MASS_SHARE = 0.001
"""A mass over the declared table mass, an inertia over the declared one of its shaft."""

LEAST_MODE_SHARE = 0.001
"""What swings on the table, over the table's mass: at its frequency it is felt as many times its mass."""

FORCE_KEYS = ("delta_force", "force", "peak")
"""Parameters that are forces at the table."""


def is_material(effect: Effect, plant: Plant) -> bool:
    """Whether an effect is of a size that matters on this plant."""
    if effect.kind is Kind.HEAT:
        return is_material_heat(effect, plant.heat)
    values = {key: value for key, value in effect.values.items() if isinstance(value, float)}
    if effect.name == "friction_deviation":
        return any(abs(values[key] - 1) >= LEAST_FACTOR for key in ("coulomb_factor", "viscous_factor"))
    if effect.name == "stiffness_vs_position":
        return abs(values["share_over_stroke"]) >= LEAST_STIFFNESS_SHARE
    if effect.name == "preload_loss" and values["ratio"] > 1 - LEAST_SOFTENING:
        return False
    if effect.name == "structural_mode":
        return abs(values["mass"]) >= LEAST_MODE_SHARE * plant.chain.values["table_mass"]
    if effect.name == "payload":
        return abs(values["mass"]) >= LEAST_MASS_SHARE * plant.chain.values["table_mass"]
    if isinstance(effect, InertiaDeviation):
        return abs(values["inertia"]) >= LEAST_MASS_SHARE * declared_inertia(plant.chain.values, effect.place)
    if effect.name == "stiffness_deviation":
        return abs(values["factor"] - 1) >= LEAST_STIFFNESS_SHARE
    forces = [abs(number) for key, value in effect.values.items() if key in FORCE_KEYS for number in _numbers(value)]
    return not forces or max(forces) >= LEAST_FORCE_SHARE * declared_level(plant, Port.TABLE)


def _numbers(value: float | tuple[float, ...]) -> tuple[float, ...]:
    return value if isinstance(value, tuple) else (value,)
