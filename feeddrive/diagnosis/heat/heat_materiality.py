"""The physical minimum of thermal effects: what is too small for anyone to act on is no finding."""

from __future__ import annotations

import numpy as np

from feeddrive.effects.base import Effect, listed, number
from feeddrive.effects.heat.bearing_heat import reference_torque
from feeddrive.thermal.laws.friction import torque_law
from feeddrive.thermal.machine_heat import Heat

LEAST_HEAT_SHARE = 2e-4
"""A heat over that of the nut at the highest declared speed: a sensor on a flange shows milliwatts, and what shows is
named, lest another name be given to it."""

LEAST_FACTOR, LEAST_CONTACT_FACTOR = 0.01, 0.03
"""Deviation of a film coefficient and of the contact conductance from 1; a film of 1 % is a few hundredths of a kelvin,
what thermometers just show."""

LEAST_DRIFT = 0.03
"""Least drift of the surroundings [K]."""

LEAST_COEFFICIENT = 3e-4
"""Least slope of load or viscous torque [1/K]; over ten kelvin 0.3 % of the heat, which thermometers just show."""

LEAST_CAPACITY_SHARE, LEAST_FILM_SHARE = 1e-2, 1e-3
"""A mass over the nut's capacity, a conductance over the film's of the nut."""

LEAST_GROWTH = 0.1e-6
"""Least growth of the frame [m]."""

LONGEST_SINK = 3e5
"""Capacity over conductance [s]: a mass that stays cold for days is a coolant."""

LEAST_LAG = 3.0
"""Least lag of a sensor [s]."""


def is_material_heat(effect: Effect, heat: Heat) -> bool:
    """Whether a thermal effect is of a size that matters on this plant."""
    v = {key: value for key, value in effect.values.items() if isinstance(value, float)}
    fastest = np.array([heat.highest_speed])
    nut_heat = float(heat.nut.heats(fastest)[0])
    match effect.name:
        case "motor_heat":
            return v["power"] >= LEAST_HEAT_SHARE * nut_heat
        case "bearing_heat":
            return v["factor"] * heat.highest_speed * _bearing_torque(heat) >= LEAST_HEAT_SHARE * nut_heat
        case "ambient_drift":
            return abs(v["amplitude"]) * _largest_shape(effect) >= LEAST_DRIFT
        case "preload_growth" | "viscosity_temperature":
            return abs(v["coefficient"]) >= LEAST_COEFFICIENT
        case "convection_deviation":
            return abs(v["factor"] - 1) >= LEAST_FACTOR
        case "contact_conductance_deviation":
            return abs(v["factor"] - 1) >= LEAST_CONTACT_FACTOR
        case "cooling":
            return v["conductance"] >= LEAST_FILM_SHARE * _film_of_nut(heat)
        case "heat_sink":
            enough = v["capacity"] >= LEAST_CAPACITY_SHARE * _capacity_of_nut(heat)
            return enough and v["conductance"] >= LEAST_FILM_SHARE * _film_of_nut(heat)
        case "structure_growth":
            return abs(v["growth"]) + abs(v.get("slope", 0.0)) * heat.rig.length >= LEAST_GROWTH
        case _:
            return v.get("time_constant", LEAST_LAG) >= LEAST_LAG


def is_another(effect: Effect) -> bool:
    """Whether a thermal effect has run to where it is another one: a mass that stays cold is a coolant."""
    values = effect.values
    return effect.name == "heat_sink" and number(values["capacity"]) > LONGEST_SINK * number(values["conductance"])


def _largest_shape(effect: Effect) -> float:
    nodes = listed(effect.values["shape"])
    return max(abs(s) for s in nodes) if len(listed(effect.values["time"])) > 1 else 1.0


def _bearing_torque(heat: Heat) -> float:
    """Torque of the bearing that `bearing_heat` counts by, at the highest speed [N m]."""
    speed = heat.highest_speed
    return float(reference_torque(speed) if heat.front is None else torque_law(speed, vars(heat.front)))


def _film_of_nut(heat: Heat) -> float:
    """Conductance to the air at rest [W/K]."""
    outside = 2 * np.pi * heat.rig.nut.outer_radius * heat.rig.nut.length
    return float(heat.films.on_nut(np.zeros(1))[0] * outside)


def _capacity_of_nut(heat: Heat) -> float:
    """[J/K]."""
    section = np.pi * (heat.rig.nut.outer_radius**2 - heat.rig.radius**2)
    return float(heat.rig.steel.heat_capacity * section * heat.rig.nut.length)
