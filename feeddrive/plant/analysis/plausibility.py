"""Rules by which an engineer sees at a glance whether a machine's numbers can be right, and whether it will serve.

A rule that breaks is a warning and no error: machines run that break some of them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import cast

import numpy as np

from feeddrive.effects.base import Motion
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.effects.source.weight import Weight
from feeddrive.plant.analysis.mode_map import mode_map
from feeddrive.plant.analysis.screw_limits import buckling_force, critical_speed
from feeddrive.plant.analysis.steady import steady_motions
from feeddrive.plant.analysis.summary import Summary, summarise
from feeddrive.plant.plant import Plant, PositionVelocityController
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.run.heat_figures import HeatRow, heat_rows
from feeddrive.units.quantity import percent

USUAL_DN = 70_000 * 1e-3 * math.pi / 30
"""Ball circle times speed of a ground screw with return tubes [m rad/s]; 70 000 mm rev/min."""

STATIC_SAFETY = 2.0
INERTIA_RATIO = 10.0
DAMPING = (0.002, 0.10)


class Sense(Enum):
    """On which side of its limit a value has to lie."""

    AT_MOST = "≤"
    AT_LEAST = "≥"
    EQUAL = "="


class Verdict(Enum):
    """What a rule says."""

    KEPT = "ok"
    BROKEN = "warning"
    NOTE = "note"
    UNKNOWN = "not checked"


@dataclass(frozen=True)
class Finding:
    """What one rule says of a machine.

    Attributes:
        rule: in plain words.
        value, limit: in `unit`; None where they are not known.
        unit: SI unit of both.
        sense: on which side of the limit the value has to lie.
        verdict: what it says.
        source: of the rule, or what has to be declared so that it can be checked.
    """

    rule: str
    value: float | None
    limit: float | None
    unit: str
    sense: Sense
    verdict: Verdict
    source: str


HOTTEST_RISE = 60.0
"""Settled rise at the highest speed beyond which grease and preload of a ball screw do not last [K]."""

LONGEST_WARM_UP = 6 * 3600.0
"""Slowest time constant of a screw alone [s]; a machine frame is slower, a screw is not."""

STEELS = {"conductivity": (10.0, 70.0, "W/(m K)"), "heat_capacity": (3e6, 4.5e6, "J/(m^3 K)")}
FILM = (2.0, 200.0)
"""Film coefficients of air [W/(m² K)]."""

CONTACT = (50.0, 20000.0)
"""Balls between nut and screw, per area [W/(m² K)]."""


def check_plant(plant: Plant, position_gain: float | None = None) -> tuple[Finding, ...]:
    """Every rule's finding, motion first, then heat; `position_gain` [1/s] takes the place of the declared one."""
    on_motion = _of_motion(plant, position_gain) if plant.has_motion else ()
    return (*on_motion, *(_of_heat(plant.heat) if plant.has_heat else ()))


def _of_motion(plant: Plant, position_gain: float | None) -> tuple[Finding, ...]:
    controller = plant.controller
    declared = controller.position_gain if isinstance(controller, PositionVelocityController) else None
    gain = declared if position_gain is None else position_gain
    summary = summarise(plant)
    force = largest_force(plant, summary)
    return (
        *_frequencies(plant, gain),
        _inertia_ratio(summary),
        _damping(plant, summary),
        _torque(plant, summary),
        _motor_speed(plant),
        *_brake(plant),
        _dn(plant),
        _whirling(plant),
        _buckling(plant, force),
        _screw_safety(plant, force),
        _bearing_safety(plant, force),
    )


def largest_force(plant: Plant, summary: Summary) -> float | None:
    """Largest axial force of the nut [N]: the process or the acceleration, each with weight and friction.

    None where neither `table.axial_load` nor `table.max_acceleration` is declared.
    """
    process, acceleration = _data(plant, "table.axial_load"), _data(plant, "table.max_acceleration")
    if process is None and acceleration is None:
        return None
    rows = summary.friction
    steady = max(abs(force) for row in rows for force in (row.force_forward, row.force_backward))
    return steady + max(process or 0.0, plant.chain_values()["table_mass"] * (acceleration or 0.0))


def _frequencies(plant: Plant, gain: float | None) -> list[Finding]:
    if not plant.chain.elastic:
        return []
    ideal = replace(plant, drive=None)  # an anti-resonance is that of a motor held ideally, not by its brake
    found = mode_map(ideal) if plant.stroke is not None or not plant.chain.varies else mode_map(ideal, np.zeros(1))
    first, anti = float(found.free[:, 0].min()), float(found.held[:, 0].min())
    rule = "first natural frequency in Hz, position gain in 1/s"
    usual = Finding(
        "velocity loop: half the first anti-resonance",
        0.5 * anti,
        None,
        "Hz",
        Sense.AT_LEAST,
        Verdict.NOTE,
        "bandwidth to expect (Kollmorgen)",
    )
    if gain is None:
        return [Finding(rule, first, None, "Hz", Sense.AT_LEAST, Verdict.UNKNOWN, "needs --position-gain"), usual]
    return [_at_least(rule, first, gain, "Hz", "Fanuc αi manual"), usual]


def _inertia_ratio(summary: Summary) -> Finding:
    rule = "load inertia over motor inertia"
    inertias = summary.inertias
    motor = next((row.at_motor for row in inertias if row.coordinate == "motor"), 0.0)
    if motor == 0.0:
        return _unknown(rule, "needs the motor's inertia in an elastic structure")
    ratio = sum(row.at_motor for row in inertias) / motor - 1
    return _at_most(rule, ratio, INERTIA_RATIO, "1", "rule of thumb of servo catalogues")


def _damping(plant: Plant, summary: Summary) -> Finding:
    rule = f"damping ratio of the first mode, above {percent(DAMPING[0], 1)}"
    if not plant.chain.elastic:
        return _unknown(rule, "needs an elastic structure")
    ratio = float(summary.modes.free.damping[1])
    verdict = Verdict.KEPT if DAMPING[0] <= ratio <= DAMPING[1] else Verdict.BROKEN
    return Finding(rule, ratio, DAMPING[1], "1", Sense.AT_MOST, verdict, "usual, friction of the guides not counted")


def _torque(plant: Plant, summary: Summary) -> Finding:
    rule, acceleration = "motor torque to accelerate", _data(plant, "table.max_acceleration")
    if acceleration is None or math.isinf(plant.torque_limit):
        given = {
            "table.max_acceleration": acceleration is not None,
            "motor.torque_limit": plant.torque_limit < math.inf,
        }
        return _needs(rule, given)
    speed = _data(plant, "table.max_velocity") or 0.1
    steady = max(abs(motion.torque) for motion in steady_motions(plant, (speed, -speed), plant.middle))
    torque = steady + summary.inertia_at_motor * acceleration / plant.chain.motor_radius
    return _at_most(rule, torque, plant.torque_limit, "N m", "motor.torque_limit")


def _motor_speed(plant: Plant) -> Finding:
    rule, velocity, limit = "motor speed", _data(plant, "table.max_velocity"), _data(plant, "motor.max_speed")
    if velocity is None or limit is None:
        return _needs(rule, {"table.max_velocity": velocity is not None, "motor.max_speed": limit is not None})
    return _at_most(rule, velocity / plant.chain.motor_radius, limit, "rad/s", "motor.max_speed")


def _brake(plant: Plant) -> list[Finding]:
    """Nothing where no weight pulls."""
    rule = "torque of the weight at the motor"
    mass = float(plant.chain.moving_mass(plant.chain_values()))
    pulling = [effect for effect in plant.effects if isinstance(effect, ConstantForce | Weight)]
    pulls = [effect.force(Motion(0.0, 0.0, mass=mass), cast(Mapping[str, float], effect.values)) for effect in pulling]
    limit = _data(plant, "brake.holding_torque")
    if not pulls:
        return []
    if limit is None:
        return [_unknown(rule, "needs brake.holding_torque")]
    torque = abs(math.fsum(pulls)) * plant.chain.motor_radius
    return [_at_most(rule, torque, limit, "N m", "brake.holding_torque; losses not counted")]


def _dn(plant: Plant) -> Finding:
    rule, velocity = "DN: ball circle times speed", _data(plant, "table.max_velocity")
    circle = _data(plant, "ball_screw.ball_circle") or _data(plant, "ball_screw.diameter")
    if velocity is None or circle is None:
        return _needs(rule, {"table.max_velocity": velocity is not None, "ball_screw.ball_circle": circle is not None})
    declared = _data(plant, "ball_screw.dn_limit")
    limit, source = (USUAL_DN, "usual of ground screws") if declared is None else (declared, "ball_screw.dn_limit")
    return _at_most(rule, circle * velocity / plant.chain.radius, limit, "m rad/s", source)


def _whirling(plant: Plant) -> Finding:
    rule, velocity = "screw speed, 0.8 of whirling", _data(plant, "table.max_velocity")
    if plant.drive is None or velocity is None:
        return _needs(rule, {_PARTS: plant.drive is not None, "table.max_velocity": velocity is not None})
    screw, kind = plant.drive.screw, plant.drive.supports.kind
    limit = critical_speed(screw, kind, screw.length)
    return _at_most(rule, velocity / plant.chain.radius, limit, "rad/s", f"{kind.value} beam between the bearings")


def _buckling(plant: Plant, force: float | None) -> Finding:
    rule = "axial force, half of buckling"
    if plant.drive is None or force is None:
        return _needs(rule, {_PARTS: plant.drive is not None, _FORCE: force is not None})
    screw, kind = plant.drive.screw, plant.drive.supports.kind
    first, last = _nut_places(plant)
    length = max(last, screw.length - first) if kind.far_end_takes_force else last
    return _at_most(rule, force, buckling_force(screw, kind, length), "N", f"Euler, {kind.value}")


def _screw_safety(plant: Plant, force: float | None) -> Finding:
    rating = _data(plant, "ball_screw.static_rating")
    return _safety(force, "static safety of the ball screw", rating, "ball_screw.static_rating")


def _bearing_safety(plant: Plant, force: float | None) -> Finding:
    ratings = [_data(plant, f"bearing.{end}.static_rating") for end in ("near", "far")]
    given = [rating for rating in ratings if rating is not None]
    rule = "static safety of the bearings"
    return _safety(force, rule, min(given) if given else None, "bearing.near.static_rating")


def _safety(force: float | None, rule: str, rating: float | None, needed: str) -> Finding:
    if rating is None or not force:
        return _needs(rule, {needed: rating is not None, _FORCE: bool(force)})
    return _at_least(rule, rating / force, STATIC_SAFETY, "1", "catalogues: 2 to 3 with vibration")


_PARTS = "the parts of the screw ([support], [bearing.near], [nut])"
_FORCE = "table.axial_load or table.max_acceleration"


def _needs(rule: str, given: Mapping[str, bool]) -> Finding:
    """What is not checked, and which of the keys it takes are not declared."""
    return _unknown(rule, "needs " + " and ".join(key for key, declared in given.items() if not declared))


def _nut_places(plant: Plant) -> tuple[float, float]:
    """Nut from the near bearing at either end of the stroke [m]; the whole screw where no stroke is declared."""
    if plant.stroke is None or not plant.chain.varies:
        return 0.0, plant.drive.screw.length if plant.drive is not None else 0.0
    first = plant.chain.nut_at_zero
    return first + plant.stroke[0], first + plant.stroke[1]


def _data(plant: Plant, key: str) -> float | None:
    return plant.data[key].value if key in plant.data else None


def _at_most(rule: str, value: float, limit: float, unit: str, source: str) -> Finding:
    verdict = Verdict.KEPT if value <= limit else Verdict.BROKEN
    return Finding(rule, value, limit, unit, Sense.AT_MOST, verdict, source)


def _at_least(rule: str, value: float, limit: float, unit: str, source: str) -> Finding:
    verdict = Verdict.KEPT if value >= limit else Verdict.BROKEN
    return Finding(rule, value, limit, unit, Sense.AT_LEAST, verdict, source)


def _unknown(rule: str, needs: str) -> Finding:
    return Finding(rule, None, None, "1", Sense.AT_MOST, Verdict.UNKNOWN, needs)


def _of_heat(heat: Heat) -> tuple[Finding, ...]:
    rows = heat_rows(heat)
    return (
        *(
            _between(key.replace("_", " "), getattr(heat.rig.steel, key), low, high, unit, "steels")
            for key, (low, high, unit) in STEELS.items()
        ),
        _between("expansion", heat.rig.steel.expansion, 8e-6, 20e-6, "1/K", "steels"),
        _between("smallest film coefficient", _films(rows)[0], *FILM, "W/(m^2 K)", "air, free to forced"),
        _between("largest film coefficient", _films(rows)[1], *FILM, "W/(m^2 K)", "air, free to forced"),
        _between("contact conductance", heat.contact, *CONTACT, "W/(m^2 K)", "paper 002, table 5, and ten times it"),
        _at_most(
            "settled rise of the nut at the highest speed", rows[-1].nut_rise, HOTTEST_RISE, "K", "grease, preload"
        ),
        _at_most("slowest time constant", rows[0].time_constants[0], LONGEST_WARM_UP, "s", "a screw without its frame"),
    )


def _films(rows: tuple[HeatRow, ...]) -> tuple[float, float]:
    values = np.array([(row.screw_film, row.nut_film) for row in rows])
    return float(values.min()), float(values.max())


def _between(rule: str, value: float, low: float, high: float, unit: str, source: str) -> Finding:
    """The side that is broken, or the nearer one."""
    nearer_low = value < np.sqrt(low * high)
    return (_at_least if nearer_low else _at_most)(rule, value, low if nearer_low else high, unit, source)
