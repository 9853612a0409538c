"""The deviations of a plant, from the very effects that act in its simulation.

    d+- = delta(p / r, p) -+ w / 2

| symbol | meaning | unit |
|---|---|---|
| delta | sum of the travel deviations at screw angle and table position (`plant.transmission_law`) | m |
| p, r | target, travel per screw angle | m, m/rad |
| w | play, `compensation.lost_motion` | m |

Valid for an axis whose position loop reads the motor encoder. Deviations over time are heat, and in no table of
positions; wind-up is none either.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from feeddrive.compensation.lost_motion import declared_play
from feeddrive.compensation.table import PER_INTERVAL, Deviations
from feeddrive.effects.base import TravelEffect, number
from feeddrive.effects.tabulated import TabulatedTravel
from feeddrive.effects.travel.lead_error_periodic import LeadErrorPeriodic
from feeddrive.effects.travel.thermal_growth import ThermalGrowth
from feeddrive.plant.equations import parameter_symbols, parameter_values
from feeddrive.plant.plant import Plant
from feeddrive.plant.transmission_law import travel_deviation
from feeddrive.symbolic_turn import SYMBOLS
from feeddrive.typing import FloatArray

_LEAST, _MOST = 2001, 40_001


@dataclass(frozen=True, eq=False)
class PlantDeviations:
    """What a table may be made of.

    Attributes:
        known: deviations along the stroke.
        shortest: shortest period of a lead error along the stroke [m]; infinite where none is periodic.
        of_time: names of travel errors that change with time, which no table of positions holds.
    """

    known: Deviations
    shortest: float
    of_time: tuple[str, ...]


def changes_with_time(effect: TravelEffect) -> bool:
    """Whether a travel error is one of heat."""
    return isinstance(effect, ThermalGrowth) or (isinstance(effect, TabulatedTravel) and effect.place == "time")


def plant_deviations(plant: Plant, ends: tuple[float, float]) -> PlantDeviations:
    """Deviations of a plant between two positions [m]."""
    travel = [one for one in plant.effects if isinstance(one, TravelEffect)]
    shortest = min((_period(one, plant.chain.radius) for one in travel), default=math.inf)
    count = int(np.clip(2 * PER_INTERVAL * (ends[1] - ends[0]) / shortest, _LEAST, _MOST))
    positions = np.linspace(ends[0], ends[1], count)
    lead = lead_deviation(plant, positions)
    play = declared_play(plant)
    timed = tuple(one.name for one in travel if changes_with_time(one))
    return PlantDeviations(Deviations(positions, lead - play / 2, lead + play / 2), shortest, timed)


@SYMBOLS.taken()
def lead_deviation(plant: Plant, positions: FloatArray) -> FloatArray:
    """Travel deviation delta at positions of the table [m], those over time left out, shape (n,) [m]."""
    kept = tuple(one for one in plant.effects if not (isinstance(one, TravelEffect) and changes_with_time(one)))
    still = replace(plant, effects=kept)
    symbols, x = parameter_symbols(still), ca.SX.sym("x")
    delta = travel_deviation(still, symbols, x / still.chain.radius, x, ca.SX(0))
    function = ca.Function("delta", [x, symbols.vector], [delta])
    values = function(positions.reshape(1, -1), ca.DM(parameter_values(still)))
    return np.asarray(values.full()).ravel()


def _period(effect: TravelEffect, radius: float) -> float:
    """Period of a travel error along the stroke, or twice the distance of a table's points [m]."""
    if isinstance(effect, LeadErrorPeriodic):
        return 2 * math.pi * radius / number(effect.values["order"])
    if isinstance(effect, TabulatedTravel) and not changes_with_time(effect) and len(effect.breakpoints) > 1:
        return 2 * float(np.min(np.diff(effect.breakpoints)))
    return math.inf
