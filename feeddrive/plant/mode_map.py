"""Natural frequencies of a plant along its stroke, motor free and held."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.plant.modes import braked_modes, free_modes
from feeddrive.plant.plant import Plant
from feeddrive.plant.stiffness_budget import stiffness_budget
from feeddrive.typing import FloatArray

STEPS = 10
"""Steps along the stroke where no positions are asked for."""


@dataclass(frozen=True)
class ModeMap:
    """Natural frequencies against the table position.

    Attributes:
        positions: of the table [m], shape (n,).
        nut: from the bearing at the motor's end [m], shape (n,); empty where the chain knows no such place.
        stiffness: static, at the table with the motor held [N/m], shape (n,); empty in a rigid structure.
        held, free: natural frequencies with the motor held and free, without the free motion [Hz], shape (n, k).
        held_damping, free_damping: their damping ratios [1].
    """

    positions: FloatArray
    nut: FloatArray
    stiffness: FloatArray
    held: FloatArray
    held_damping: FloatArray
    free: FloatArray
    free_damping: FloatArray


def mode_map(plant: Plant, positions: FloatArray | None = None) -> ModeMap:
    """Modes along the stroke.

    Args:
        plant: the machine.
        positions: of the table [m]; over the declared stroke if not given.

    Raises:
        InputError: no positions are given and no stroke is declared though the modes depend on it, or the nut would
            not be on the screw.
    """
    places = _stroke(plant) if positions is None else np.atleast_1d(np.asarray(positions, dtype=float))
    held = [braked_modes(plant, float(x)) for x in places]
    free = [free_modes(plant, float(x)) for x in places]
    elastic = plant.chain.elastic
    first = float(plant.chain.values["first_nut_position"]) if plant.chain.varies else 0.0
    return ModeMap(
        positions=places,
        nut=places + first if plant.chain.varies else np.zeros(0),
        stiffness=np.array([stiffness_budget(plant, float(x)).total for x in places] if elastic else []),
        held=np.array([modes.frequencies for modes in held]),
        held_damping=np.array([modes.damping for modes in held]),
        free=np.array([modes.frequencies[1:] for modes in free]),
        free_damping=np.array([modes.damping[1:] for modes in free]),
    )


def _stroke(plant: Plant) -> FloatArray:
    if not plant.chain.varies:
        return np.array([plant.middle])
    if plant.stroke is None:
        mend = 'declare it, e.g. stroke = ["0 mm", "500 mm"], or ask for positions'
        raise InputError("no stroke is declared", f"{plant.name}, table.stroke", mend)
    return np.linspace(*plant.stroke, STEPS + 1)
