"""Natural frequencies of a plant along its stroke, motor free and held."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.plant.analysis.stiffness_budget import stiffness_budget
from feeddrive.plant.chain.resolution import FIRST, resolved_modes
from feeddrive.plant.plant import Plant
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
        chain_valid_to: up to where the modes of the chain that simulations use are right [Hz], shape (n,); infinite
            where it is the machine itself (`feeddrive.plant.chain.resolution`).
    """

    positions: FloatArray
    nut: FloatArray
    stiffness: FloatArray
    held: FloatArray
    held_damping: FloatArray
    free: FloatArray
    free_damping: FloatArray
    chain_valid_to: FloatArray


def mode_map(plant: Plant, positions: FloatArray | None = None, count: int = FIRST) -> ModeMap:
    """The first `count` modes along the stroke, or at positions [m], of a screw with as many coordinates as they need.

    Raises InputError: no positions and no stroke though the modes depend on it, or the nut off the screw.
    """
    places = _stroke(plant) if positions is None else np.atleast_1d(np.asarray(positions, dtype=float))
    found = [resolved_modes(plant, float(x), count) for x in places]
    held, free = [modes.braked for modes in found], [modes.free for modes in found]
    elastic = plant.chain.elastic
    return ModeMap(
        positions=places,
        nut=places + plant.chain.nut_at_zero if plant.chain.varies else np.zeros(0),
        stiffness=np.array([stiffness_budget(plant, float(x)).total for x in places] if elastic else []),
        held=np.array([modes.frequencies for modes in held]),
        held_damping=np.array([modes.damping for modes in held]),
        free=np.array([modes.frequencies[1:] for modes in free]),
        free_damping=np.array([modes.damping[1:] for modes in free]),
        chain_valid_to=np.array([modes.chain_valid_to for modes in found]),
    )


def _stroke(plant: Plant) -> FloatArray:
    if not plant.chain.varies:
        return np.array([plant.middle])
    if plant.stroke is None:
        mend = 'declare it, e.g. stroke = ["0 mm", "500 mm"], or ask for positions'
        raise InputError("no stroke is declared", f"{plant.name}, table.stroke", mend)
    return np.linspace(*plant.stroke, STEPS + 1)
