"""Coordinates of a set of effects: which values are fitted, in which kind of coordinate, and between which ends.

Fits run in coordinates of size about one, so that one step length and one damping serve all of them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from feeddrive.diagnosis.friction_at_port import declared_level, declared_viscous
from feeddrive.diagnosis.likelihood.coordinate_kinds import (
    Coordinate,
    Linear,
    Logarithmic,
    MiddleForce,
    Order,
    Sine,
    TwoHeats,
)
from feeddrive.effects.base import Effect, Port
from feeddrive.effects.chain.inertia_deviation import InertiaDeviation, declared_inertia
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.effects.source.position_spring import PositionSpring
from feeddrive.effects.tabulated import Tabulated
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray, IntegerArray

ORDER_SIZE = 0.01
"""Change of an order that shows over a stroke of some revolutions."""

LOGARITHMIC = {
    ("stribeck", "velocity"),
    ("presliding", "stiffness"),
    ("friction_vs_position", "half_width"),
    ("preload_loss", "ratio"),
    ("preload_loss", "force"),
    ("structural_mode", "frequency"),
    ("thermal_growth", "time_constant"),
    ("viscous_warmup", "time_constant"),
    ("ambient_drift", "period"),
    ("convection_deviation", "factor"),
    ("contact_conductance_deviation", "factor"),
    ("heat_sink", "conductance"),
    ("heat_sink", "capacity"),
    ("structure_growth", "time_constant"),
    ("sensor_lag", "time_constant"),
}
"""Parameters known to a factor before they are known at all."""

TWO_HEATS = {
    "motor_heat": TwoHeats("power", "share_at_rest", 1.0, rest=True),
    "bearing_heat": TwoHeats("factor", "rear_share", 1.0, rest=False),
}
"""Heats that are linear, though their parameters are not."""

FIXED = {
    ("friction_vs_position", "position"),
    ("stiffness_vs_position", "low"),
    ("stiffness_vs_position", "high"),
    ("ambient_drift", "time"),
    ("torque_constant_droop", "at_torque"),
    ("load_dependent_friction", "at_force"),
}
"""Parameters that choose the form of a law; they are tried, not fitted."""

FORM = {"centre", "damping", "start", "break_away", "bend"}
"""Linear parameters that choose the form of a law, not its size."""

LAWS_AT_ENDS = {
    ("presliding", "break_away"),
    ("friction_deviation", "viscous_factor"),
    ("friction_deviation", "coulomb_factor"),
}
"""Shares at whose ends a law is a law as any other: a bristle that gives way little by little, or at once; Coulomb
friction alone, or viscous friction alone."""

FACTORS = {"factor", "coulomb_factor", "viscous_factor", "ratio"}
"""Parameters that are 1 where the effect is absent; other sizes are 0."""

GROWS_WITH = {("sensor_lag", "time_constant"): 1, ("heat_sink", "conductance"): 1, ("presliding", "stiffness"): -1}
"""Sizes known to a factor, and the power of them that the effect grows with: its slope over their logarithm is then the
effect itself, and a step of one takes it away."""

LEAST = {("drive_delay", "delay"): 0.0, ("preload_loss", "ratio"): 0.1, ("presliding", "break_away"): 1e-3}
"""Ends of a search inside the physical range: a torque that acts before it is recorded is one recorded late, and that
is `channel_delay`. Balls that touch without preload are as stiff as F^(1/3) (Hertz), up to the force F over two thirds
of (F / F_p)^(1/3) of what they are under a preload F_p: a tenth at a three-hundredth of it, below the friction that a
motion has to overcome. What is softer over a force that is seen does not touch, and that is `backlash`. A bristle that
sticks does so up to some deflection: one of no such share slips from the start, and is another law."""

NEAR_END = 0.02
"""Share of an end of a parameter's range within which it counts as standing there."""

LEFT = 0.05
"""Least share of a declared mass or inertia that an effect may leave, as of a stiffness (`stiffness_deviation`)."""


def coordinates_of(effect: Effect, plant: Plant) -> list[Coordinate]:
    """The coordinates in which the effect is fitted, for the form that its values choose."""
    if {"amplitude", "phase"} <= set(effect.values):
        travel = plant.chain.motor_radius if effect.port is Port.MOTOR else plant.chain.radius
        middle = plant.middle / travel
        return [Sine(effect.parameter("amplitude").size, middle), Order(ORDER_SIZE, middle)]
    if effect.name in TWO_HEATS:
        return [TWO_HEATS[effect.name]]
    if isinstance(effect, PositionSpring):
        force = ConstantForce.parameter("force").size
        return [Linear("stiffness", effect.parameter("stiffness").size), MiddleForce(force, plant.middle)]
    if isinstance(effect, Tabulated):
        return [Linear(key, effect.parameter(key).size) for key in effect.tables]
    result: list[Coordinate] = []
    for parameter in effect.parameters:
        pair = (effect.name, parameter.key)
        if parameter.key not in effect.values or pair in FIXED or parameter.key in _unused(effect, plant):
            continue
        if pair in LOGARITHMIC:
            result.append(Logarithmic(parameter.key))
        else:
            result.append(Linear(parameter.key, parameter.size))
    return result


def _unused(effect: Effect, plant: Plant) -> set[str]:
    """Parameters without effect in the form that the values choose."""
    if effect.name == "friction_vs_position":
        as_table = isinstance(effect.values["position"], tuple)
        return {"peak", "centre", "half_width"} if as_table else {"delta_force"}
    if effect.name == "stiffness_vs_position":
        return set() if effect.values["middle_compliance"] else {"middle_compliance"}
    if effect.name == "presliding":
        return set() if effect.values["break_away"] else {"break_away"}
    if effect.name == "load_dependent_friction":
        return set() if effect.values["bend"] else {"bend"}
    if effect.name == "ambient_drift":
        return {"period", "amplitude"} if isinstance(effect.values["time"], tuple) else {"shape"}
    if effect.name == "friction_deviation":
        unused = {"coulomb_factor"} if declared_level(plant, effect.port) == 0 else set()
        return unused | ({"viscous_factor"} if declared_viscous(plant, effect.port) == 0 else set())
    return set()


def read_coordinates(effects: Sequence[Effect], plant: Plant) -> FloatArray:
    """All coordinates of the effects in one vector."""
    values = [c for effect in effects for coordinate in coordinates_of(effect, plant) for c in coordinate.read(effect)]
    return np.array(values, dtype=float)


def longest_steps(effects: Sequence[Effect], plant: Plant) -> FloatArray:
    """The longest difference over which the prediction bends by no more than a tenth, of every coordinate; (k,).

    Half of the smallest size of interest, a tenth of a value that is known to a factor.
    """
    lengths = [
        0.1 if isinstance(coordinate, Logarithmic) else 0.5
        for effect in effects
        for coordinate in coordinates_of(effect, plant)
        for _ in coordinate.read(effect)
    ]
    return np.array(lengths, dtype=float)


def absent_coordinates(effects: Sequence[Effect], plant: Plant) -> tuple[FloatArray, IntegerArray]:
    """Coordinates at which the effects are absent, and which belong together.

    Returns:
        The coordinates, NaN for those that choose the form of a law, and the number of the group of each; (k,) each.
    """
    absent: list[float] = []
    groups: list[int] = []
    for effect in effects:
        for coordinate in coordinates_of(effect, plant):
            count = len(coordinate.read(effect))
            groups += [groups[-1] + 1 if groups else 0] * count
            power = GROWS_WITH.get((effect.name, coordinate.key)) if isinstance(coordinate, Logarithmic) else None
            absent += [_absent(coordinate)] * count if power is None else [coordinate.read(effect)[0] - power]
    return np.array(absent, dtype=float), np.array(groups, dtype=np.int64)


def is_absent(effect: Effect, plant: Plant) -> bool:
    """Whether an effect does nothing with the values that it has."""
    absent, _ = absent_coordinates([effect], plant)
    known = ~np.isnan(absent)
    return bool(known.any()) and bool(np.all(read_coordinates([effect], plant)[known] == absent[known]))


def coordinate_ends(effects: Sequence[Effect], plant: Plant) -> tuple[FloatArray, FloatArray]:
    """Ends of what is physical on this plant, lower and upper, of every coordinate; (k,) each."""
    low: list[float] = []
    high: list[float] = []
    for effect in effects:
        for coordinate in coordinates_of(effect, plant):
            ends = _ends(effect, coordinate, plant)
            count = len(coordinate.read(effect))
            low += [ends[0]] * count
            high += [ends[1]] * count
    return np.array(low, dtype=float), np.array(high, dtype=float)


def _ends(effect: Effect, coordinate: Coordinate, plant: Plant) -> tuple[float, float]:
    if isinstance(coordinate, Sine | MiddleForce):
        return -math.inf, math.inf
    if isinstance(coordinate, TwoHeats):
        return 0.0, math.inf
    parameter = effect.parameter(coordinate.key)
    least = max(LEAST.get((effect.name, coordinate.key), parameter.minimum), _least_left(effect, plant))
    if isinstance(coordinate, Logarithmic):
        return math.log(least) if least > 0 else -math.inf, math.log(parameter.maximum)
    return least / coordinate.size, parameter.maximum / coordinate.size


def _least_left(effect: Effect, plant: Plant) -> float:
    """Least value of an effect that takes from a declared mass or inertia."""
    if effect.name == "payload":
        return -(1 - LEFT) * plant.chain_values()["table_mass"]
    if isinstance(effect, InertiaDeviation):
        return -(1 - LEFT) * declared_inertia(plant.chain_values(), effect.place)
    return -math.inf


def _absent(coordinate: Coordinate) -> float:
    """Where the effect is absent in one coordinate; NaN where the coordinate chooses a form."""
    if isinstance(coordinate, Order):
        return math.nan
    if isinstance(coordinate, Logarithmic):
        return 0.0 if coordinate.key in FACTORS else math.nan
    if isinstance(coordinate, Linear):
        return math.nan if coordinate.key in FORM else float(coordinate.key in FACTORS) / coordinate.size
    return 0.0


def at_its_limit(effect: Effect) -> bool:
    """Whether a parameter that is known to a factor has run to an end of its range, where the law is another one.

    A Stribeck velocity beyond all speeds is a level, growth within no time another lead, a mode above all frequencies
    a mass. Such a rival says nothing that the simpler law does not.
    """
    for key, value in effect.values.items():
        if (effect.name, key) in LOGARITHMIC and isinstance(value, float | int):
            parameter = effect.parameter(key)
            least = LEAST.get((effect.name, key), parameter.minimum)
            if value <= least * (1 + NEAR_END) or value >= parameter.maximum * (1 - NEAR_END):
                return True
    return False


def write_coordinates(effects: Sequence[Effect], plant: Plant, vector: FloatArray) -> list[Effect]:
    """The effects with the values of the vector, each inside what is physical on the plant."""
    result, at = [], 0
    for effect in effects:
        changed: Effect = effect
        for coordinate in coordinates_of(effect, plant):
            count = len(coordinate.read(effect))
            low, high = _ends(effect, coordinate, plant)
            inside = [min(max(float(c), low), high) for c in vector[at : at + count]]
            changed = changed.with_values(**coordinate.write(changed, inside))
            at += count
        result.append(changed)
    return result


def numbers(effect: Effect) -> list[str]:
    """Names of the numbers of an effect's values, tables `key[i]`, in the order of `value_slopes`."""
    return [
        name
        for key, value in effect.values.items()
        for name in ([f"{key}[{i}]" for i in range(len(value))] if isinstance(value, tuple) else [key])
    ]


def value_slopes(effects: Sequence[Effect], plant: Plant, vector: FloatArray) -> FloatArray:
    """Exact slope of every number of the effects' values with the coordinates, shape (numbers, k)."""
    step = 1e-6
    base = _flat(write_coordinates(effects, plant, vector))
    up, down = (
        [(_flat(write_coordinates(effects, plant, vector + way * unit)) - base) / way for unit in np.eye(len(vector))]
        for way in (step, -step)
    )
    # at an end of a parameter's range it moves one way only
    return np.column_stack([np.where(np.abs(a) >= np.abs(b), a, b) for a, b in zip(up, down, strict=True)])


def spread_to_values(
    effects: Sequence[Effect], plant: Plant, vector: FloatArray, covariance: FloatArray
) -> list[dict[str, FloatArray]]:
    """Standard deviation of every fitted value, by the exact slope of the coordinates; a list entry per effect."""
    jacobian = value_slopes(effects, plant, vector)
    deviation = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", jacobian, covariance, jacobian), 0.0))
    result, at = [], 0
    for effect in effects:
        found: dict[str, FloatArray] = {}
        for key, value in effect.values.items():
            count = len(value) if isinstance(value, tuple) else 1
            found[key] = deviation[at : at + count]
            at += count
        result.append(found)
    return result


def _flat(effects: Sequence[Effect]) -> FloatArray:
    numbers: list[float] = []
    for effect in effects:
        for value in effect.values.values():
            numbers += list(value) if isinstance(value, tuple) else [float(value)]
    return np.array(numbers)


def at_an_end(effect: Effect, plant: Plant) -> bool:
    """Whether a coordinate of an effect is at an end of its physical range, as far as slopes resolve it.

    Where the end is the absent effect, or a default, it is a value as any other: a damper of nothing, a share of none.
    So it is where laws stand at both ends (`LAWS_AT_ENDS`).
    """
    vector = read_coordinates([effect], plant)
    low, high = coordinate_ends([effect], plant)
    absent, _ = absent_coordinates([effect], plant)
    known = {p.key: p.default for p in effect.parameters if p.default is not None and p.minimum <= p.default}
    known = {key: one for key, one in known.items() if (effect.name, key) not in LAWS_AT_ENDS}
    plain = effect.with_values(**{key: one for key, one in known.items() if isinstance(effect.values.get(key), float)})
    near = np.minimum(np.abs(vector - low), np.abs(high - vector)) < 1e-4 * np.maximum(1.0, np.abs(vector))
    allowed = np.isclose(vector, absent) | (np.isclose(vector, read_coordinates([plain], plant)) & np.isnan(absent))
    either = [
        isinstance(coordinate, Linear) and (effect.name, coordinate.key) in LAWS_AT_ENDS
        for coordinate in coordinates_of(effect, plant)
        for _ in coordinate.read(effect)
    ]
    return bool(np.any(near & ~allowed & ~np.array(either, dtype=bool)))
