"""A feed drive at other temperatures than those it was declared for: the same equations with other values."""

from __future__ import annotations

from dataclasses import replace

from feeddrive.effects.base import Effect, number
from feeddrive.effects.friction.nut_friction import NutFriction
from feeddrive.effects.friction.shaft_drag import BearingDrag, NutDrag
from feeddrive.effects.travel.lead_error_cumulative import LeadErrorCumulative
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import parameter_names
from feeddrive.thermal.thermal_coupling import Changes

LOAD, NUT_OIL, BEARING_OIL = 0, 1, 2
"""Rows of `feeddrive.thermal.laws.laws.Laws.factors`."""

_FOLLOWING: dict[type[Effect], dict[str, int]] = {
    NutFriction: {"preload": LOAD, "viscous": NUT_OIL},
    NutDrag: {"coulomb": LOAD, "viscous": NUT_OIL},
    BearingDrag: {"viscous": BEARING_OIL},
}
"""Values of declared friction that follow a temperature, each in proportion to a factor."""


def followed(plant: Plant) -> dict[int, int]:
    """Row of the motion's parameters to the row of `Laws.factors` that it follows."""
    names = parameter_names(plant)
    return {
        names.index(f"{effect.label}.{key}"): factor
        for effect in plant.effects
        for key, factor in _FOLLOWING.get(type(effect), {}).items()
        if f"{effect.label}.{key}" in names
    }


def warmed(plant: Plant, changes: Changes, slope: float, nut_stiffness: float) -> Plant:
    """The plant with what its temperatures change: factors on what is declared, and the growth of its screw.

    The slope of the growth along the stroke [m/m] adds to a declared travel deviation; the declared stiffness of the
    whole nut [N/m] is one of the springs in `axial_stiffness`.
    """
    factors = (changes.preload, changes.nut_viscous, changes.bearing_viscous)
    effects = [
        effect.with_values(**{key: number(effect.values[key]) * factors[row] for key, row in keys.items()})
        if (keys := _FOLLOWING.get(type(effect)))
        else effect
        for effect in plant.effects
    ]
    if not any(isinstance(effect, LeadErrorCumulative) for effect in effects):
        effects.append(LeadErrorCumulative.of(slope=0.0))
    grown = tuple(
        effect.with_values(slope=number(effect.values["slope"]) + slope)
        if isinstance(effect, LeadErrorCumulative)
        else effect
        for effect in effects
    )
    softened = plant.chain.nut_softened(changes.nut_stiffness, nut_stiffness)
    return replace(plant.with_chain_values(softened), effects=grown)
