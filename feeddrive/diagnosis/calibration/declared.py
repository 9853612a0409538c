"""Declared values of a plant in motion that are fitted within their tolerances, and the plant with other values.

    value = declared * exp(deviation * c),   c ~ N(0, 1) before anything is measured

| value | named beyond its tolerance |
|---|---|
| table mass; inertia of motor and of screw | payload; inertia_deviation |
| axial stiffness, or that of nut, bearings and drive where the chain knows them apart | stiffness_deviation |
| Coulomb and viscous friction of table and of screw | friction_deviation |
| torsional stiffness, damping, width of the sign change of friction, torque constant | no effect says so |

Friction is one factor a port, on all that is declared there. A rigid machine shows one mass: its inertias are not known
from it. Tolerances: `feeddrive.diagnosis.likelihood.tolerances`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from feeddrive.diagnosis.friction_at_port import declared_level, declared_viscous
from feeddrive.diagnosis.likelihood.tolerances import (
    DAMPING,
    FRICTION,
    MASS,
    STIFFNESS,
    TORQUE_CONSTANT,
    Kind,
    deviation_of,
    written_share,
)
from feeddrive.effects.base import Effect, FrictionEffect, Port, Value, number
from feeddrive.effects.chain.inertia_deviation import InertiaDeviation, declared_inertia
from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.chain.stiffness_deviation import StiffnessDeviation
from feeddrive.effects.friction.friction_deviation import FrictionDeviation
from feeddrive.plant.motor_torque import TorqueGain, declared_gain
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray

FARTHEST_FACTOR = 20.0
FARTHEST = math.log(FARTHEST_FACTOR)
"""Logarithm of a value over the declared one at most: a factor of twenty, so that every plant tried is a machine."""

_WRITTEN = re.compile(r"± ([^,(]+)")
_COULOMB, _VISCOUS, _WIDTH = ("coulomb",), ("viscous",), ("smoothing_velocity", "smoothing_speed")


@dataclass(frozen=True)
class CalibratedValue:
    """A declared value that is fitted within its tolerance.

    Attributes:
        key: value of the chain, `port.friction` of a port, or `torque_constant`.
        words: for sentences.
        unit: SI unit.
        declared: the value [SI]; 1 for a factor on several.
        deviation: standard deviation of the logarithm of value over declared.
        name: effect that says so beyond the tolerance; empty where none does.
        place: of that effect.
        written: where it stands in a plant file: dotted key, unit and declared value [SI] of each.
        widened: factor on the deviation of a value that is free of its tolerance.
    """

    key: str
    words: str
    unit: str
    declared: float
    deviation: float
    name: str = ""
    place: str = ""
    written: tuple[tuple[str, str, float], ...] = ()
    widened: float = 1.0

    @property
    def tolerance(self) -> float:
        """As declared, as a share: twice the deviation that it has then."""
        return math.expm1(2 * self.deviation / self.widened)

    @property
    def scales_with_force(self) -> float:
        """1 where the value is a force, or a force per something, 0 where it is none: a width is a velocity."""
        return 0.0 if self.key.endswith(_WIDTH) else 1.0

    @property
    def is_damping(self) -> bool:
        """Whether the value is a damping of the chain."""
        return self.key.endswith("_damping")

    @property
    def farthest(self) -> float:
        """Coordinate of the largest factor; its negative is that of the smallest."""
        return FARTHEST / self.deviation

    def factor(self, coordinate: float) -> float:
        """Value over declared at a coordinate."""
        factor = math.exp(min(max(self.deviation * coordinate, -FARTHEST), FARTHEST))
        # the exponential of an end, rounded, may be beyond it
        return min(max(factor, 1 / FARTHEST_FACTOR), FARTHEST_FACTOR)


_CHAIN = (
    ("table_mass", "table mass", "kg", MASS, "payload", ""),
    ("motor_inertia", "motor inertia", "kg m^2", MASS, "inertia_deviation", "motor"),
    ("screw_inertia", "screw inertia", "kg m^2", MASS, "inertia_deviation", "screw"),
    ("inertia_per_length", "screw inertia per length", "kg m", MASS, "inertia_deviation", "screw"),
    ("axial_stiffness", "axial stiffness", "N/m", STIFFNESS, "stiffness_deviation", "all"),
    ("nut_stiffness", "nut stiffness", "N/m", STIFFNESS, "stiffness_deviation", "nut"),
    ("bearing_stiffness", "bearing stiffness", "N/m", STIFFNESS, "stiffness_deviation", "bearing"),
    ("far_bearing_stiffness", "far bearing stiffness", "N/m", STIFFNESS, "stiffness_deviation", "far_bearing"),
    ("drive_stiffness", "torsional stiffness of the drive", "N m/rad", STIFFNESS, "stiffness_deviation", "drive"),
    ("torsional_stiffness", "torsional stiffness", "N m/rad", STIFFNESS, "", ""),
    ("axial_damping", "axial damping", "N s/m", DAMPING, "", ""),
    ("nut_damping", "axial damping", "N s/m", DAMPING, "", ""),
    ("torsional_damping", "torsional damping", "N m s/rad", DAMPING, "", ""),
    ("drive_damping", "torsional damping", "N m s/rad", DAMPING, "", ""),
)
"""Value of a chain, its words and unit, its kind, the effect that says that it is other, and where that acts."""

_NAMES = {name for *_, name, _ in _CHAIN if name} | {FrictionDeviation.name}


def calibrated_values(plant: Plant) -> tuple[CalibratedValue, ...]:
    """The declared values of a plant that are fitted; none where all are exact."""
    chain, found = plant.chain.values, []
    sections = {one.key: f"{one.section}.{one.section_key}" for one in (*plant.chain.required, *plant.chain.optional)}
    for key, words, unit, kind, name, place in _CHAIN if plant.chain.elastic else _CHAIN[:1]:
        if chain.get(key, 0.0) > 0:
            deviation = _deviation(plant, (key,), kind, chain[key], unit)
            place_in_file = ((sections[key], unit, chain[key]),)
            found.append(CalibratedValue(key, words, unit, chain[key], deviation, name, place, place_in_file))
    for port, whose in ((Port.TABLE, "guide"), (Port.SCREW, "screw")):
        level = declared_level(plant, port) > 0
        for keys, words, present in (
            (_COULOMB, "Coulomb friction", level),
            (_VISCOUS, "viscous friction", declared_viscous(plant, port) > 0),
            (_WIDTH, "width of the sign change", level),
        ):
            places = _friction_places(plant, port, keys)
            if present and places:
                deviation = _deviation(plant, places, FRICTION, 1.0, "1")
                name = "" if keys is _WIDTH else "friction_deviation"
                key = f"{port}.{keys[0]}"
                words = f"{words} of the {whose}"
                written = _written(plant, port, keys)
                found.append(CalibratedValue(key, words, "1", 1.0, deviation, name, str(port), written))
    if plant.torque_constant:
        deviation = _deviation(plant, ("motor.torque_constant",), TORQUE_CONSTANT, plant.torque_constant, "N m/A")
    else:  # a torque that the drive records is its current times a constant of the same data sheet as the masses
        sources = {plant.origins.get(key, "") for key in ("motor_inertia", "table_mass") if key in chain}
        deviation = deviation_of(max(TORQUE_CONSTANT.usual(_WRITTEN.sub("", source)) for source in sources))
    in_file = (("motor.torque_factor", "1", 1 / declared_gain(plant)),)
    found.append(CalibratedValue("torque_constant", "torque constant", "1", 1.0, deviation, written=in_file))
    return tuple(one for one in found if one.deviation > 0)


def _friction_places(plant: Plant, port: Port, keys: Sequence[str]) -> tuple[str, ...]:
    effects = [e for e in plant.effects if isinstance(e, FrictionEffect) and e.declared and e.port == port]
    return tuple(f"{e.label}.{key}" for e in effects for key in keys if e.values.get(key, 0.0))


def _written(plant: Plant, port: Port, keys: Sequence[str]) -> tuple[tuple[str, str, float], ...]:
    """Where the friction of a port stands in a plant file."""
    return tuple(
        (f"effect.{e.label}.{key}", e.parameter(key).unit, float(e.values[key]))  # type: ignore[arg-type]
        for e in plant.effects
        if isinstance(e, FrictionEffect) and e.declared and e.port == port and e.label == e.name
        for key in keys
        if e.values.get(key, 0.0)
    )


def _deviation(plant: Plant, keys: Sequence[str], kind: Kind, declared: float, unit: str) -> float:
    """The widest of several values of one kind."""
    shares = []
    for key in keys:
        origin = plant.origins.get(key, "")
        written = _WRITTEN.search(origin)
        shares.append(written_share(written.group(1), declared, unit, key) if written else kind.usual(origin))
    return deviation_of(max(shares))


def with_values(plant: Plant, values: Sequence[CalibratedValue], coordinates: FloatArray) -> Plant:
    """The plant with other declared values, (k,) coordinates."""
    chain, frictions, gain = dict(plant.chain.values), dict[tuple[str, str], float](), 1.0
    for value, coordinate in zip(values, coordinates, strict=True):
        factor = value.factor(float(coordinate))
        port, _, friction = value.key.partition(".")
        if value.key == "torque_constant":
            gain = factor
        elif friction:
            frictions[port, friction] = factor
        else:
            chain[value.key] *= factor
    effects = tuple(_with_friction(effect, frictions) for effect in plant.effects)
    more = (TorqueGain.of(gain=1 / gain),) if gain != 1.0 else ()
    return replace(plant.with_chain_values(chain), effects=(*effects, *more))


def _with_friction(effect: Effect, factors: Mapping[tuple[str, str], float]) -> Effect:
    if not (isinstance(effect, FrictionEffect) and effect.declared):
        return effect
    changed: dict[str, Value] = {}
    for keys in (_COULOMB, _VISCOUS, _WIDTH):
        factor = factors.get((str(effect.port), keys[0]), 1.0)
        present = [key for key in keys if isinstance(effect.values.get(key), float | int)]
        changed |= {key: factor * float(effect.values[key]) for key in present}  # type: ignore[arg-type]
    return effect.with_values(**changed) if changed else effect


def as_effect(plant: Plant, value: CalibratedValue, coordinate: float) -> Effect:
    """The effect that says that a value is other than declared."""
    factor = value.factor(coordinate)
    match value.name:
        case "payload":
            return Payload.of(mass=(factor - 1) * value.declared)
        case "inertia_deviation":
            declared = declared_inertia(plant.chain.values, value.place)
            return InertiaDeviation.of(None, value.place, inertia=(factor - 1) * declared)
        case "stiffness_deviation":
            return StiffnessDeviation.of(None, value.place, factor=factor)
        case "friction_deviation":
            port = Port(value.place)
            coulomb = value.key.endswith(_COULOMB[0])
            return FrictionDeviation.of(
                port, coulomb_factor=factor if coulomb else 1.0, viscous_factor=1.0 if coulomb else factor
            )
    raise ValueError(f"no effect says that {value.words} is other than declared")


def says_other(effect: Effect) -> bool:
    """Whether what an effect says is that a declared value is other; likely is what any value misses by, not a size."""
    return effect.name in _NAMES


def is_said_by(value: CalibratedValue, effect: Effect) -> bool:
    """Whether an effect says that a value is other than declared."""
    place = str(effect.port) if isinstance(effect, FrictionDeviation) else effect.place
    return (effect.name, place) == (value.name, value.place)


def said_share(plant: Plant, value: CalibratedValue, effect: Effect) -> tuple[str, float, float]:
    """What an effect says of a value: the key that says it, the value over the declared one, its slope with that."""
    if isinstance(effect, FrictionDeviation):
        key = "viscous_factor" if value.key.endswith(_VISCOUS[0]) else "coulomb_factor"
    else:
        key = next(iter(effect.values))
    if key.endswith("factor"):
        return key, number(effect.values[key]), 1.0
    declared = declared_inertia(plant.chain.values, value.place) if key == "inertia" else value.declared
    return key, 1 + number(effect.values[key]) / declared, 1 / declared
