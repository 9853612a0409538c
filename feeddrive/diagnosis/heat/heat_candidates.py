"""Which thermal effects are tried, whether a recording can show them, and the values that their fits start from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from feeddrive.diagnosis.finding.scene import Candidate, Scene
from feeddrive.diagnosis.heat.heat_evidence import HeatEvidence
from feeddrive.effects.base import Effect
from feeddrive.effects.heat.ambient_drift import AmbientDrift
from feeddrive.effects.heat.bearing_heat import BearingHeat
from feeddrive.effects.heat.contact_conductance_deviation import ContactConductanceDeviation
from feeddrive.effects.heat.convection_deviation import ConvectionDeviation
from feeddrive.effects.heat.cooling import Cooling
from feeddrive.effects.heat.heat_sink import HeatSink
from feeddrive.effects.heat.motor_heat import MotorHeat
from feeddrive.effects.heat.preload_growth import PreloadGrowth
from feeddrive.effects.heat.sensor_lag import SensorLag
from feeddrive.effects.heat.structure_growth import StructureGrowth
from feeddrive.effects.heat.viscosity_temperature import ViscosityTemperature

DRIFT_NODES = 9
"""Nodes of a tabulated drift of the surroundings over the longest run."""

PERIODS = (0.25, 0.4, 0.6, 1.0, 1.6, 2.5, 4.0)
"""Periods of sines of the surroundings, over the longest run."""

CONDUCTANCES = (0.1, 0.003)
"""Conductances of coolants and masses at the nut [W/K]: the film of a small nut, and what thermometers just show."""

SINK_TIMES = (500.0, 2e3, 8e3, 3e4)
"""Time constants of masses [s]."""

GROWTH = "table_growth"


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
