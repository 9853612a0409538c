"""Whether the friction of a plant only takes power: least level and least force over all that the axis can reach.

    F = level shape + viscous,     passive where  level >= 0  and  F sign v >= 0

Level and viscous force are sums of what the effects of a port add, each of which reads one of position, speed and time
besides the direction, and is monotone between its turning points (`FrictionEffect.turning_points`). A sum of monotone
functions lies above the sum of their lesser ends in every interval; the intervals are divided until that bound and the
least value found agree. What repeats along the way, and what follows the load, enters by its own least value; several
ripples of one screw, harmonics of each other most of all, by the least that they have together within the stroke.

Reached are the declared stroke (all positions without one), every time, and speeds up to the declared maximum of table
or motor. A bristle divides by its level, which has to stay above zero where it acts.

Source: the passivity of friction, e.g. Olsson, Astrom, Canudas de Wit, Gafvert, Lischinsky, European Journal of Control
4 (1998) 176.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import casadi as ca
import numpy as np

from feeddrive.effects.base import BristleEffect, Effect, FrictionEffect, Motion, Port, listed, number
from feeddrive.effects.source.ball_pass_ripple import BallPassRipple
from feeddrive.errors import InputError
from feeddrive.plant.least_sum import least_sum
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import parameter_symbols, parameter_values, per_structure
from feeddrive.typing import Expression, FloatArray, IntegerArray
from feeddrive.units.quantity import format_quantity

USUAL_SPEED = 4.0
"""Speed of a table up to which its friction is judged where none is declared [m/s]; ball screws end below."""

LEAST_BREAK_AWAY = 1e-12
"""Deflection [m] at which a bristle has to hold; what breaks away before an atom has moved is no bristle."""

_ROUNDS = 12
"""In which an interval is divided by four at most: to 6e-8 of its length."""

_IN_A_PERIOD = 32
"""Angles in a period of the highest order at which ripples are added up: between two of them a sine of amplitude A lies
below its chord by A (2 pi / 32)^2 / 8 at most, half a per cent of it, which is taken off."""

_MOST_ANGLES = 500_000
"""Above so many angles each ripple enters by its own least."""

_POSITIONS, _SPEEDS, _TIMES = "position", "speed", "time"


@dataclass(frozen=True)
class LeastFriction:
    """The least friction of a port, in the direction in which it is less.

    Attributes:
        port: table or screw.
        level: lower bound of the Coulomb level [N, or N m at the screw].
        force: lower bound of the whole friction that resists, level and viscous force together [N or N m].
        needed: level that there has to be: 0, or more where a bristle acts [N].
        direction: of the motion, 1 or -1.
        position, speed, time: where level or force is least; None where it does not depend on it [SI].
        taken: what each effect adds there to the lesser of both, by label [N or N m].
    """

    port: Port
    level: float
    force: float
    needed: float
    direction: int
    position: float | None
    speed: float | None
    time: float | None
    taken: dict[str, float]

    @property
    def margin(self) -> float:
        """By how much friction stays passive [N or N m]; negative where the axis would accelerate by itself."""
        return min(self.level - self.needed, self.force)


def least_friction(plant: Plant) -> tuple[LeastFriction, ...]:
    """Least friction of the ports where any acts.

    Args:
        plant: whose values are taken as they are, inside their ranges or not.
    """
    ports = [port for port in Port if _acting(plant, port)]
    ways = [[_Way(plant, port, direction).least() for direction in (1, -1)] for port in ports]
    return tuple(min(both, key=lambda least: least.margin) for both in ways)


def is_passive(plant: Plant) -> bool:
    """Whether no friction of a plant can accelerate the axis; for fits, which pass through values of all kinds."""
    return _first_active(plant) is None


def refuse_active_friction(plant: Plant, where: str) -> None:
    """Refuse a plant whose friction can accelerate it, or take a bristle's level away; `where` is its file.

    The InputError names the effect, its key, where friction turns negative, and the value that it may have.
    """
    least = _first_active(plant)
    if least is not None:
        raise _refusal(plant, least, where)


def _first_active(plant: Plant) -> LeastFriction | None:
    """Least friction of the first port where it is too little; declared friction alone is positive by its ranges."""
    for port in Port:
        if all(effect.declared for effect in _acting(plant, port)):
            continue
        for direction in (1, -1):
            least = _Way(plant, port, direction).least()
            if least.margin < 0:
                return least
    return None


def _acting(plant: Plant, port: Port) -> list[FrictionEffect]:
    return [effect for effect in plant.effects if isinstance(effect, FrictionEffect) and effect.port == port]


def _refusal(plant: Plant, least: LeastFriction, where: str) -> InputError:
    """The error that tells where friction is least, which effect takes most of it, and what that may take."""
    unit = "N" if least.port == Port.TABLE else "N m"
    by_level = least.level - least.needed <= least.force
    shown = format_quantity(least.level if by_level else least.force, unit)
    at = _place(least)
    label = min(least.taken, key=lambda key: least.taken[key])
    taken = -least.taken[label]
    if taken <= 0:  # a bristle on a level that is nothing
        bristle = next(e.name for e in plant.effects if isinstance(e, BristleEffect) and e.port == least.port)
        what = f"the Coulomb level of the {least.port} is {shown}, and {bristle} acts on it"
        return InputError(what, where, f"write a greater one in {label}, or leave {bristle} out")
    kind = "Coulomb level" if by_level else "force, viscous part included,"
    what = f"friction of the {least.port} would push: its {kind} falls to {shown} {at}, where {label} takes "
    what += format_quantity(taken, unit)
    effect = next(effect for effect in plant.effects if effect.label == label)
    return InputError(what, where, _mend(effect, (taken + least.margin) / taken, by_level))


def _mend(effect: Effect, share: float, by_level: bool) -> str:
    """Which value may stay, given the share of what the effect takes that may be taken."""
    units = ("N", "N m") if by_level else ("N s/m", "N", "N m")
    keys = [parameter for parameter in effect.parameters if parameter.unit in units]
    given = [key for key in keys if any(value != 0 for value in listed(effect.values.get(key.key, 0.0)))]
    if share <= 0 or not given:
        return f"leave {effect.label} out, or declare more friction"
    key = given[0]
    value = effect.values[key.key]
    if len(given) > 1 or isinstance(value, tuple):
        named = " and ".join(key.key for key in given)
        return f"write {named} smaller, so that it takes {share:.3g} of that at most, or declare more friction"
    limit = format_quantity(value * share, key.unit)
    return f"write {key.key} between 0 and {limit} in {effect.label}, or declare more friction"


def _place(least: LeastFriction) -> str:
    """Where it is least, in words."""
    turning = least.port != Port.TABLE
    parts = [f"in {'+' if least.direction > 0 else '-'} direction"]
    if least.position is not None:
        parts.append(f"at {format_quantity(least.position, 'rad' if turning else 'm')}")
    if least.speed is not None:
        speed = format_quantity(least.speed, "rad/s" if turning else "m/s")
        parts.append(f"at {speed}" if least.speed else "near rest")
    if least.time is not None:
        parts.append(f"{format_quantity(least.time, 's')} from the start")
    return ", ".join(parts)


class _Way:
    """Friction of a port in one direction: its effects read off at arrays of position, speed and time."""

    def __init__(self, plant: Plant, port: Port, direction: int) -> None:
        self.plant, self.port, self.direction = plant, port, direction
        found = _acting(plant, port)
        self.bristle = next((effect for effect in found if isinstance(effect, BristleEffect)), None)
        self.effects = [effect for effect in found if effect is not self.bristle]
        self.declared = np.array([effect.declared for effect in self.effects], dtype=bool)
        self.turns = [effect.turning_points() for effect in self.effects]
        self.lowest = [effect.least_level(plant.chain.radius) for effect in self.effects]
        (self.slots, owners, self.elsewhere), self.values = _slots(plant, port), parameter_values(plant)
        self.owners = np.array(owners, dtype=int)
        factor = math.prod(self._read("level_factor", {})[:, 0])
        self.factors = np.where(self.declared, factor, 1.0)

    def least(self) -> LeastFriction:
        """Least level and least force of this direction."""
        needed = 0.0
        if self.bristle is not None:
            needed = LEAST_BREAK_AWAY * number(self.bristle.values["stiffness"])
        at: dict[str, float] = {}
        taken: FloatArray = np.bincount(self.owners, self._levels({})[:, 0], len(self.effects)).astype(np.float64)
        for i, lowest in enumerate(self.lowest):
            taken[i] = taken[i] if lowest is None else lowest * self.factors[i]
        ripples = [i for i, effect in enumerate(self.effects) if isinstance(effect, BallPassRipple)]
        if len(ripples) > 1 and (alone := float(taken[ripples].sum())) < 0:
            taken[ripples] *= self._least_together(ripples, alone) / alone
        reading = {variable: self._reading(variable) for variable in (_POSITIONS, _SPEEDS, _TIMES)}
        level = sum(taken[i] for i in range(len(taken)) if not any(i in effects for effects in reading.values()))
        for variable, effects in reading.items():
            if effects:
                rows = np.flatnonzero(np.isin(self.owners, effects))
                read = partial(self._some_levels, rows, variable)
                lower, at[variable], parts = least_sum(read, self._points(variable, effects), _ROUNDS)
                taken[effects] = np.bincount(self.owners[rows], parts, len(self.effects))[effects]
                level += lower
        force, speed, viscous = self._least_force(float(level))
        if force < level - needed:
            at[_SPEEDS], taken = speed, taken + viscous
        return LeastFriction(
            self.port, float(level), force, needed, self.direction, at.get(_POSITIONS), at.get(_SPEEDS),
            at.get(_TIMES), {effect.label: float(part) for effect, part in zip(self.effects, taken, strict=True)},
        )  # fmt: skip

    def _least_together(self, ripples: Sequence[int], alone: float) -> float:
        """Least sum of several ripples within the stroke [N m], of either sign of the angle."""
        if self.plant.stroke is None:
            return alone
        low, high = self.plant.stroke
        reach = max(abs(low), abs(high), high - low) / self.plant.chain.radius
        values = [self.effects[i].values for i in ripples]
        amplitude, order, phase = (np.array([one[key] for one in values]) for key in ("amplitude", "order", "phase"))
        step = 2 * math.pi / (_IN_A_PERIOD * float(order.max()))
        if 2 * reach / step > _MOST_ANGLES:
            return alone
        angle = np.arange(-reach, reach + step, step)
        together = sum(a * np.sin(n * angle + p) for a, n, p in zip(amplitude, order, phase, strict=True))
        return max(alone, float(np.min(together) - step**2 / 8 * (amplitude @ order**2)))

    def _reading(self, variable: str) -> list[int]:
        """Effects whose level follows from turning points of a variable."""
        return [i for i, turns in enumerate(self.turns) if variable in turns and self.lowest[i] is None]

    def _levels(self, places: dict[str, FloatArray]) -> FloatArray:
        """What each term adds to the level, shape (terms, places)."""
        levels: FloatArray = self._read("level", places) * self.factors[self.owners][:, None]
        return levels

    def _some_levels(self, rows: IntegerArray, variable: str, places: FloatArray) -> FloatArray:
        some: FloatArray = self._levels({variable: places})[rows]
        return some

    def _least_force(self, level: float) -> tuple[float, float, FloatArray]:
        """Least of level times shape plus viscous force over the speed, where, and the viscous parts there.

        Every level enters by its least. The first interval begins at rest: there tanh is concave, and what is negative
        is proportional to the speed, so that its far end decides.
        """

        def terms(speed: FloatArray) -> FloatArray:
            anywhere = self._read("viscous", {_SPEEDS: speed})
            viscous = np.vstack([self._least_viscous(i, speed, anywhere[i]) for i in range(len(self.effects))])
            shape: FloatArray = np.ones_like(speed) if self.declared.any() else np.zeros_like(speed)
            if self.declared.any() and self.bristle is None:
                shapes = self._read("shape", {_SPEEDS: speed})[self.declared] * self.direction
                shape = shapes.min(axis=0) if level >= 0 else shapes.max(axis=0)
            return np.vstack([viscous, level * shape])

        top = self._top_speed()
        turning = [x for turns in self.turns for x in turns.get(_SPEEDS, ())]
        smooth = [
            number(value)
            for effect in self.effects
            for key, value in effect.values.items()
            if key.startswith("smoothing")
        ]
        first = min([0.1 * top, *smooth])
        points = np.unique([first, top, *(x for x in turning if first < x < top)])
        bound, place, parts = least_sum(terms, points, _ROUNDS)
        return bound, place, parts[:-1]

    def _least_viscous(self, i: int, speed: FloatArray, anywhere: FloatArray) -> FloatArray:
        """Viscous force of an effect at some speeds, the least over position and time, shape (speeds,).

        `anywhere` is that of one which reads neither.
        """
        asked = (_POSITIONS, _TIMES) if self.elsewhere[i] else ()
        places = [
            {_SPEEDS: speed, variable: np.full_like(speed, place)}
            for variable in asked
            for place in self._within(variable, self.turns[i].get(variable, ()))
        ]
        read = [self._read("viscous", at)[i] for at in places] or [anywhere]
        least: FloatArray = np.min(read, axis=0) * self.direction if self.direction > 0 else -np.max(read, axis=0)
        return least * self._viscous_factor if self.declared[i] else least

    @cached_property
    def _viscous_factor(self) -> float:
        """Least factor on declared viscous force over time."""
        factors = [
            self._read("viscous_factor", {_TIMES: np.array(turns.get(_TIMES, (0.0,)))})[j].min()
            for j, turns in enumerate(self.turns)
        ]
        return float(math.prod(factors))

    def _points(self, variable: str, rows: Sequence[int]) -> FloatArray:
        """Turning points of some effects inside what the axis reaches, and its ends."""
        return np.unique(self._within(variable, [x for i in rows for x in self.turns[i][variable]]))

    def _within(self, variable: str, turning: Sequence[float]) -> list[float]:
        """Turning points that are reached, and the ends of what is; none where nothing turns."""
        if not turning:
            return []
        low, high = self._reached(variable, turning)
        return [low, high, *(x for x in turning if low < x < high)]

    def _reached(self, variable: str, turning: Sequence[float]) -> tuple[float, float]:
        if variable == _SPEEDS:
            return 0.0, self._top_speed()
        if variable == _POSITIONS and self.plant.stroke is not None and self.port == Port.TABLE:
            return self.plant.stroke
        return min(turning), max(turning)

    def _top_speed(self) -> float:
        """Greatest speed of the port [m/s or rad/s]."""
        return top_speed(self.plant, USUAL_SPEED) / (1.0 if self.port == Port.TABLE else self.plant.chain.radius)

    def _read(self, slot: str, at: dict[str, FloatArray]) -> FloatArray:
        """One slot at arrays of what it reads, shape (effects, n), or (terms, n) of the level; n is 1 at no array."""
        count = max((len(values) for values in at.values()), default=1)
        rest = {_POSITIONS: 0.0, _SPEEDS: 1.0, _TIMES: 0.0}
        x, v, t = (np.broadcast_to(at.get(name, rest[name]), (1, count)) for name in rest)
        return np.array(self.slots[slot](x, v * self.direction, t, self.values)).reshape(-1, count)


def top_speed(plant: Plant, undeclared: float) -> float:
    """Greatest velocity of the table [m/s]: the declared one, that of the motor, or `undeclared`."""
    if "table.max_velocity" in plant.data:
        return plant.data["table.max_velocity"].value
    if "motor.max_speed" in plant.data:
        return plant.data["motor.max_speed"].value * plant.chain.motor_radius
    return undeclared


@per_structure
def _slots(plant: Plant, port: Port) -> tuple[dict[str, ca.Function], tuple[int, ...], tuple[bool, ...]]:
    """The slots of every effect of a port but its bristle, the effect of each term of the level, and whether the
    viscous force of an effect is another one elsewhere, or at another time.

    Every slot is a function (position, velocity, time, values) of one row an effect, or one a term of the level.
    """
    symbols = parameter_symbols(plant)
    x, v, t = (ca.SX.sym(name) for name in ("position", "velocity", "time"))
    motion = Motion(x, v, t, 0.0, symbols.chain["lead"] / (2 * math.pi))
    effects = [effect for effect in _acting(plant, port) if not isinstance(effect, BristleEffect)]
    p = [symbols.effects[effect.label] for effect in effects]
    terms = [effect.level_terms(motion, values) for effect, values in zip(effects, p, strict=True)]
    rows: dict[str, list[Expression]] = {"level": [term for several in terms for term in several]}
    rows["level_factor"] = [effect.level_factor(motion, values) for effect, values in zip(effects, p, strict=True)]
    rows["viscous"] = [effect.viscous(motion, values) for effect, values in zip(effects, p, strict=True)]
    rows["viscous_factor"] = [effect.viscous_factor(motion, values) for effect, values in zip(effects, p, strict=True)]
    rows["shape"] = [
        effect.shape(motion, values) if effect.declared else 0.0 for effect, values in zip(effects, p, strict=True)
    ]
    made = {
        slot: ca.Function(f"feeddrive_{slot}", [x, v, t, symbols.vector], [ca.vertcat(*map(ca.SX, row))])
        for slot, row in rows.items()
    }
    elsewhere = tuple(bool(ca.depends_on(ca.SX(row), ca.vertcat(x, t))) for row in rows["viscous"])
    return made, tuple(i for i, several in enumerate(terms) for _ in several), elsewhere
