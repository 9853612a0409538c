"""A distributed screw with as many coordinates as a frequency needs, and how far the declared chain holds.

The chain of a plant file has one or two elements of the screw, which is what its simulations use. Where frequencies are
asked for, the screw gets as many standing waves as they need (`feeddrive.plant.chain.standing_waves`), so that what is
shown is the machine's. Other structures are what they are: they come back as they went in.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import singledispatch

import numpy as np

from feeddrive.plant.analysis.modes import Modes, braked_modes, free_modes
from feeddrive.plant.chain.distributed_screw import DistributedScrew
from feeddrive.plant.chain.drive_values import hubs_between
from feeddrive.plant.chain.linear_chain import Chain
from feeddrive.plant.chain.standing_waves import ScrewWithWaves, waves_needed
from feeddrive.plant.plant import Plant

ACCURACY = 0.005
"""Relative error that the standing waves left out may make of a frequency; a bound, and far from reached by most."""

GOOD = 0.01
"""Relative error up to which a mode of the declared chain counts as right: a modal test tells a frequency to that."""

FIRST = 4
"""Modes of each kind that people ask for: a cutting process and a servo loop meet no higher ones."""

_ROUNDS = 8  # waves lower frequencies, which then need no more of them: two or three do


@dataclass(frozen=True)
class ResolvedModes:
    """Modes of the machine at one table position.

    Attributes:
        coordinates: rows of the shapes.
        braked, free: the first ones; the free motion of the whole axis is counted beside them.
        chain_valid_to: frequency of the highest mode up to which all modes of the declared chain are right to `GOOD`
            [Hz]; infinite where nothing is left out of it, 0 where the first one is further off.
    """

    coordinates: tuple[str, ...]
    braked: Modes
    free: Modes
    chain_valid_to: float


def resolved(plant: Plant, frequency: float, positions: Sequence[float]) -> Plant:
    """The plant with a screw that holds up to a frequency [Hz] at positions of the table [m]."""
    chain = plant.chain.without_modes
    fine = _up_to(chain, plant, frequency, positions)
    return plant if fine is chain else replace(plant, mechanics=fine)


@singledispatch
def _up_to(chain: Chain, plant: Plant, frequency: float, positions: Sequence[float]) -> Chain:
    """A chain of the plant whose frequencies hold up to one; itself where it leaves nothing out."""
    return chain


@_up_to.register
def _(chain: DistributedScrew, plant: Plant, frequency: float, positions: Sequence[float]) -> Chain:
    bare = DistributedScrew(plant.chain_values())
    waves = max(waves_needed(bare, frequency, x, ACCURACY) for x in positions)
    return ScrewWithWaves(chain.values, 1, waves, hubs_between(plant.drive) if plant.drive is not None else ())


def resolved_modes(plant: Plant, position: float, count: int = FIRST) -> ResolvedModes:
    """The first `count` modes of each kind of the machine with the table at `position` [m], or as many as there are."""
    own = _first(braked_modes(plant, position), count), _first(free_modes(plant, position), count + 1)
    counts = [len(modes.frequencies) for modes in own]
    highest = max((float(f) for modes in own for f in modes.frequencies), default=0.0)
    for _ in range(_ROUNDS):
        fine = resolved(plant, highest, [position])
        if fine is plant:
            return ResolvedModes(plant.chain.coordinates, *own, float("inf"))
        found = [_first(modes(fine, position), n) for modes, n in zip((braked_modes, free_modes), counts, strict=True)]
        reached, highest = highest, max(float(modes.frequencies[-1]) for modes in found)
        if highest <= reached:  # it held up to there
            break
    return ResolvedModes(fine.chain.coordinates, found[0], found[1], _valid_to(own, found))


def _first(modes: Modes, count: int) -> Modes:
    return replace(
        modes, frequencies=modes.frequencies[:count], damping=modes.damping[:count], shapes=modes.shapes[:, :count]
    )


def _valid_to(own: Sequence[Modes], found: Sequence[Modes]) -> float:
    """The highest mode up to which both kinds of modes are right [Hz]."""
    pairs = [
        (a.frequencies[b.frequencies > 0], b.frequencies[b.frequencies > 0]) for a, b in zip(own, found, strict=True)
    ]
    wrong = min((float(b[i]) for a, b in pairs for i in np.flatnonzero(np.abs(a / b - 1) > GOOD)), default=np.inf)
    return max((float(f) for _, b in pairs for f in b if f < wrong), default=0.0)
