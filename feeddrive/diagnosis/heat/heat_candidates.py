"""Which thermal effects are tried, whether a recording can show them, and the values that their fits start from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from feeddrive.diagnosis.finding.scene import Candidate, Scene
from feeddrive.diagnosis.heat.heat_evidence import HeatEvidence
from feeddrive.effects.base import Effect, listed, number
from feeddrive.effects.heat.ambient_drift import AmbientDrift
from feeddrive.effects.heat.bearing_heat import BearingHeat, reference_torque
from feeddrive.effects.heat.contact_conductance_deviation import ContactConductanceDeviation
from feeddrive.effects.heat.convection_deviation import ConvectionDeviation
from feeddrive.effects.heat.cooling import Cooling
from feeddrive.effects.heat.heat_sink import HeatSink
from feeddrive.effects.heat.motor_heat import MotorHeat
from feeddrive.effects.heat.preload_growth import PreloadGrowth
from feeddrive.effects.heat.sensor_lag import SensorLag
from feeddrive.effects.heat.structure_growth import StructureGrowth
from feeddrive.effects.heat.viscosity_temperature import ViscosityTemperature
from feeddrive.thermal.laws.friction import torque_law
from feeddrive.thermal.machine_heat import Heat

DRIFT_NODES = 9
"""Nodes of a tabulated drift of the surroundings over the longest run."""

PERIODS = (0.25, 0.4, 0.6, 1.0, 1.6, 2.5, 4.0)
"""Periods of sines of the surroundings, over the longest run."""

CONDUCTANCES = (0.1, 0.003)
"""Conductances of coolants and masses at the nut [W/K]: the film of a small nut, and what thermometers just show."""

SINK_TIMES = (500.0, 2e3, 8e3, 3e4)
"""Time constants of masses [s]."""

GROWTH = "table_growth"


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


def _channels(scene: Scene) -> tuple[str, ...]:
    return tuple(dict.fromkeys(name for evidence in scene.problem.evidence for name in evidence.channels))


def _growths(scene: Scene) -> list[str]:
    return [name for name in _channels(scene) if name.startswith(GROWTH)]


def _runs(scene: Scene) -> list[HeatEvidence]:
    return [evidence for evidence in scene.problem.evidence if isinstance(evidence, HeatEvidence)]


def _duration(scene: Scene) -> float:
    """Length of the longest run from its start to the end of its fitted part [s]."""
    return max(float(np.flatnonzero(e.fit_rows)[-1] + 1) * e.recording.sample_time for e in _runs(scene))


def turning(scene: Scene) -> str:
    """Heat that comes from turning needs a screw that turns."""
    turned = any(bool(np.any(run.speed > 0)) for run in _runs(scene))
    return "" if turned else "the screw never turns"


def at_the_ends(scene: Scene) -> str:
    """Heat at the ends needs a sensor that feels them: one there, or the growth of the screw between."""
    seen = [name for name in _channels(scene) if name.startswith(GROWTH) or "nut" not in name]
    return turning(scene) or ("" if seen else "the nut's temperature alone does not show heat at the ends of the screw")


def scales(scene: Scene) -> str:
    """Growth of the frame needs a recorded growth."""
    return "" if _growths(scene) else "it needs a recorded growth of the table position"


def several_channels(scene: Scene) -> str:
    """A lag is distinguished from a slow machine by the other channels."""
    return "" if len(_channels(scene)) > 1 else "with one channel a slow sensor cannot be told from a slow machine"


def motor_heat(scene: Scene) -> list[list[Effect]]:
    """A watt at the fastest speed."""
    fastest = max(float(run.speed.max()) for run in _runs(scene))
    return [[MotorHeat.of(power=1.0, at_speed=fastest, share_at_rest=a) for a in (0.2, 0.8)]]


def bearing_heat(scene: Scene) -> list[list[Effect]]:
    """The reference bearing at the front, half of it at the rear."""
    return [[BearingHeat.of(factor=1.0, rear_share=0.5)]]


def ambient_drift(scene: Scene) -> list[list[Effect]]:
    """Sines from half a run to a long drift, and a table where no sine fits."""
    duration = _duration(scene)
    sines: list[Effect] = [AmbientDrift.of(amplitude=0.1, period=duration * k) for k in PERIODS]
    nodes = tuple(np.linspace(0.0, duration, DRIFT_NODES).tolist())
    table = AmbientDrift.of(amplitude=1.0, time=nodes, shape=tuple([0.0] * DRIFT_NODES))
    return [sines, [table]]


def cooling(scene: Scene) -> list[list[Effect]]:
    """Strong and weak cooling from several times on; a strong one hides where a weak one began."""
    starts = np.linspace(0.0, 0.9, 13) * _duration(scene)
    return [[Cooling.of(conductance=k, start=float(start)) for start in starts] for k in CONDUCTANCES]


def convection(scene: Scene) -> list[list[Effect]]:
    """A factor of one on each of the films."""
    return [[ConvectionDeviation.of(place=where, factor=1.0)] for where in ConvectionDeviation.places]


def contact(scene: Scene) -> list[list[Effect]]:
    """Half, as declared, and twice."""
    return [[ContactConductanceDeviation.of(factor=factor) for factor in (0.5, 1.0, 2.0)]]


def heat_sink(scene: Scene) -> list[list[Effect]]:
    """A loosely tied mass of several time constants, strongly and weakly tied."""
    return [[HeatSink.of(conductance=k, capacity=τ * k) for τ in SINK_TIMES] for k in CONDUCTANCES]


def structure_growth(scene: Scene) -> list[list[Effect]]:
    """A micrometre settling fast or slowly; along the screw only where two positions are recorded."""
    shares = np.array([0.02, 0.06, 0.2, 0.6, 1.5]) * _duration(scene)
    made = [StructureGrowth.of(growth=1e-6, slope=0.0, time_constant=float(τ)) for τ in shares]
    if len(_growths(scene)) > 1:
        return [[*made]]
    return [[replace(e, values={key: v for key, v in e.values.items() if key != "slope"}) for e in made]]


def sensor_lag(scene: Scene) -> list[list[Effect]]:
    """Ten seconds, a minute and five at every channel that has none yet."""
    taken = {effect.place for effect in scene.found if effect.name == SensorLag.name}
    free = [name for name in _channels(scene) if name not in taken]
    return [[SensorLag.of(place=name, time_constant=τ) for τ in (10.0, 60.0, 300.0)] for name in free]


HEAT_CANDIDATES: tuple[Candidate, ...] = (
    Candidate("motor_heat", motor_heat, at_the_ends),
    Candidate("bearing_heat", bearing_heat, at_the_ends),
    Candidate("ambient_drift", ambient_drift, lambda scene: ""),
    Candidate("preload_growth", lambda scene: [[PreloadGrowth.of(coefficient=0.0)]], turning),
    Candidate("viscosity_temperature", lambda scene: [[ViscosityTemperature.of(coefficient=0.005)]], turning),
    Candidate("cooling", cooling, turning),
    Candidate("convection_deviation", convection, turning),
    Candidate("contact_conductance_deviation", contact, turning),
    Candidate("heat_sink", heat_sink, turning),
    Candidate("structure_growth", structure_growth, scales),
    Candidate("sensor_lag", sensor_lag, several_channels),
)
"""Thermal effects that `diagnose` tries, and how."""


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
