"""A machine whose motion and heat are one: friction heats it, and its temperatures change friction and screw.

Friction is that of the motion alone: of what the file declares about heat the rig, its films, contact and bodies act,
and how friction follows the temperatures (`thermal.coupling`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from feeddrive.effects.base import Effect, Kind
from feeddrive.effects.friction.nut_friction import NutFriction
from feeddrive.effects.friction.shaft_drag import BearingDrag, NutDrag
from feeddrive.plant.equations import parameter_names
from feeddrive.plant.plant import Plant
from feeddrive.thermal.coupling import Coupling
from feeddrive.thermal.plant import ThermalPlant

LOAD, NUT_OIL, BEARING_OIL = 0, 1, 2
"""Rows of `Laws.factors`."""

_FOLLOWING: dict[type[Effect], dict[str, int]] = {
    NutFriction: {"preload": LOAD, "viscous": NUT_OIL},
    NutDrag: {"coulomb": LOAD, "viscous": NUT_OIL},
    BearingDrag: {"viscous": BEARING_OIL},
}
"""Values of declared friction that follow a temperature, each in proportion to a factor."""


@dataclass(frozen=True)
class WarmPlant:
    """Motion and heat of one machine.

    Attributes:
        motion: chain, effects and drive.
        heat: its network and thermal effects, without friction heats of its own.
        coupling: of the two.
    """

    motion: Plant
    heat: ThermalPlant
    coupling: Coupling

    @property
    def name(self) -> str:
        """What it is called."""
        return self.motion.name

    @property
    def effects(self) -> tuple[Effect, ...]:
        """Those of the motion, then those of the heat."""
        return (*self.motion.effects, *self.heat.effects)

    def with_effects(self, *effects: Effect) -> WarmPlant:
        """The machine with further effects, each where it acts.

        Raises:
            InputError: as `Plant.with_effects`.
        """
        heat = [effect for effect in effects if effect.kind is Kind.HEAT]
        motion = [effect for effect in effects if effect.kind is not Kind.HEAT]
        return replace(self, motion=self.motion.with_effects(*motion), heat=self.heat.with_effects(*heat))

    def followed(self) -> dict[int, int]:
        """Row of the motion's parameters to the row of `Laws.factors` that it follows."""
        names = parameter_names(self.motion)
        return {
            names.index(f"{effect.label}.{key}"): factor
            for effect in self.motion.effects
            for key, factor in _FOLLOWING.get(type(effect), {}).items()
            if f"{effect.label}.{key}" in names
        }


def warm_plant(motion: Plant, heat: ThermalPlant, coupling: Coupling) -> WarmPlant:
    """The machine of a plant file that declares motion, heat and their coupling."""
    silent = {
        name: None if friction is None else replace(friction, heat_share=0.0)
        for name, friction in (("nut", heat.nut), ("front", heat.front), ("rear", heat.rear))
    }
    return WarmPlant(motion, replace(heat, coupling=coupling, **silent), coupling)  # type: ignore[arg-type]
