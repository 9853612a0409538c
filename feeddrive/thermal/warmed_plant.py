"""A feed drive at other temperatures than those it was declared for: the same equations with other values."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from feeddrive.effects.base import Effect
from feeddrive.effects.friction.nut_friction import NutFriction
from feeddrive.effects.friction.shaft_drag import BearingDrag, NutDrag
from feeddrive.effects.travel.lead_error_cumulative import LeadErrorCumulative
from feeddrive.plant.chain.linear_chain import Chain
from feeddrive.plant.plant import Plant
from feeddrive.thermal.coupling import Changes


def warmed(plant: Plant, changes: Changes, slope: float, nut_stiffness: float) -> Plant:
    """The plant with what its temperatures change.

    Args:
        plant: as declared.
        changes: factors on what is declared.
        slope: of the screw's growth along the stroke [m/m]; it adds to a declared travel deviation.
        nut_stiffness: declared, of the whole nut [N/m]; it is one of the springs in `axial_stiffness`.
    """
    effects = tuple(_warmed_effect(effect, changes) for effect in plant.effects)
    if not any(isinstance(effect, LeadErrorCumulative) for effect in effects):
        effects = (*effects, LeadErrorCumulative.of(slope=0.0))
    grown = tuple(
        effect.with_values(slope=_number(effect, "slope") + slope)
        if isinstance(effect, LeadErrorCumulative)
        else effect
        for effect in effects
    )
    return replace(plant, effects=grown, chain=_stiffened(plant.chain, changes.nut_stiffness, nut_stiffness))


def _warmed_effect(effect: Effect, changes: Changes) -> Effect:
    """Friction of nut and bearings; anything else as it is."""
    laws: dict[type[Effect], Callable[[], Effect]] = {
        NutFriction: lambda: effect.with_values(
            preload=_number(effect, "preload") * changes.preload,
            viscous=_number(effect, "viscous") * changes.nut_viscous,
        ),
        NutDrag: lambda: effect.with_values(
            coulomb=_number(effect, "coulomb") * changes.preload_torque,
            viscous=_number(effect, "viscous") * changes.nut_viscous,
        ),
        BearingDrag: lambda: effect.with_values(viscous=_number(effect, "viscous") * changes.bearing_viscous),
    }
    law = laws.get(type(effect))
    return effect if law is None else law()


def _stiffened(chain: Chain, share: float, nut_stiffness: float) -> Chain:
    """The chain with the nut's stiffness times a share, in series with the rest where only the sum is known."""
    values = dict(chain.values)
    if "nut_stiffness" in values:
        values["nut_stiffness"] *= share
    elif "axial_stiffness" in values:
        added = (1 / share - 1) / nut_stiffness
        values["axial_stiffness"] = 1 / (1 / values["axial_stiffness"] + added)
    return replace(chain, values=values)


def _number(effect: Effect, key: str) -> float:
    value = effect.values[key]
    assert isinstance(value, float | int)
    return float(value)
