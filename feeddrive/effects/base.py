"""What every physical effect answers: its kind, port, parameters, states, law and signature.

An effect is written once, as a CasADi expression; simulation, linearisation, fitting and export all evaluate that one.
Effects of a kind meet in one law per port (see `feeddrive.plant.equations`), because they do not simply add.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import ClassVar, Self

import casadi as ca

from feeddrive.errors import InputError
from feeddrive.typing import Expression
from feeddrive.units.quantity import format_quantity


class Kind(StrEnum):
    """How an effect enters the plant; the plant evaluates the kinds in this order."""

    CHAIN = "chain"
    TRAVEL = "travel"
    TRANSMISSION = "transmission"
    FRICTION = "friction"
    SOURCE = "source"
    DRIVE = "drive"
    TIMING = "timing"
    SENSOR = "sensor"
    HEAT = "heat"


class Port(StrEnum):
    """Where an effect acts."""

    MOTOR = "motor"
    SCREW = "screw"
    TRANSMISSION = "transmission"
    TABLE = "table"
    SENSOR = "sensor"
    THERMAL = "thermal"


@dataclass(frozen=True)
class Parameter:
    """One parameter of an effect.

    Attributes:
        key: name in plant files, reports and `diagnosis.json`.
        unit: SI unit; "1" for none.
        minimum: lower end of the physical range [unit].
        maximum: upper end of the physical range [unit].
        size: a size at which the effect is typically of interest [unit]; steps of fits are taken from it.
        default: value used where a file gives none; None if it must be given.
        table: whether the value is a list of numbers.
    """

    key: str
    unit: str
    minimum: float = float("-inf")
    maximum: float = float("inf")
    size: float = 1.0
    default: float | None = None
    table: bool = False


def _span(parameter: Parameter) -> str:
    """The physical range of a parameter in words."""
    low, high = (format_quantity(end, parameter.unit) for end in (parameter.minimum, parameter.maximum))
    if math.isinf(parameter.maximum):
        return f"{low} or more"
    return f"{low} to {high}" if math.isfinite(parameter.minimum) else f"{high} or less"


Value = float | tuple[float, ...]


def number(value: Value) -> float:
    """A value that is one number."""
    return value[0] if isinstance(value, tuple) else float(value)


def listed(value: Value) -> tuple[float, ...]:
    """A value as a list, of one where it is a number."""
    return value if isinstance(value, tuple) else (value,)


@dataclass(frozen=True)
class Motion:
    """Position and velocity at a port, as CasADi expressions or arrays: [m] and [m/s], or [rad] and [rad/s] at a shaft.

    `time` counts from the start of the recording [s]. `force` is what the nut transmits to the table [N], positive when
    it pushes the table along +; it is handed to friction at the screw and at the table, and 0 where it is not defined
    (elsewhere, and in a rigid structure: an effect that reads it says so by `reads_force`). `radius` is the travel of
    the nut per angle of the screw, lead / 2 pi [m/rad], handed out with the force at the screw. `mass` is all that
    moves with the table [kg], handed out at the table.
    """

    position: Expression
    velocity: Expression
    time: Expression = 0.0
    force: Expression = 0.0
    radius: Expression = 0.0
    mass: Expression = 0.0


@dataclass(frozen=True)
class Signature:
    """Where an effect shows in a residual.

    Attributes:
        channels: residual channels, the clearest first.
        variable: the measured variable whose function it is.
        confused_with: effects that can look alike, and need not be distinguished by every recording.
    """

    channels: tuple[str, ...]
    variable: str
    confused_with: tuple[str, ...] = ()


@dataclass(frozen=True)
class Effect:
    """One physical effect with its values.

    Attributes:
        values: parameter key to SI value.
        port: where it acts.
        label: unique name inside a plant; the effect's name, numbered where it occurs more than once.
        repeatable: whether one search may find it more than once.
        additive: whether a plant may hold more than one at a port, their sum or product having a meaning.
        reads_force: whether it reads `Motion.force`, so that a rigid structure cannot hold it.
        words: what it is called in a sentence; its name where empty.
        headline: parameters that a verdict of one line names; the first where empty.
        place: the word under `place_key` that says where it acts, as "nut"; empty where the port says all.
        place_key: key of that word in plant files and reports; empty where there is none.
        places: words that it may be; any word that the machine knows where there are none.
        default_place: word that is meant where none is given; empty where one must be.
        curve_over: variable over which a law of another form may differ from this one; empty where none is known.
        curve_scale: parameter that is a scale of the law, where other forms are this one at several scales; or empty.
    """

    name: ClassVar[str] = ""
    kind: ClassVar[Kind]
    ports: ClassVar[tuple[Port, ...]]
    parameters: ClassVar[tuple[Parameter, ...]] = ()
    signature: ClassVar[Signature]
    words: ClassVar[str] = ""
    headline: ClassVar[tuple[str, ...]] = ()
    repeatable: ClassVar[bool] = False
    additive: ClassVar[bool] = False
    reads_force: ClassVar[bool] = False
    place_key: ClassVar[str] = ""
    places: ClassVar[tuple[str, ...]] = ()
    default_place: ClassVar[str] = ""
    curve_over: ClassVar[str] = ""
    curve_scale: ClassVar[str] = ""

    values: Mapping[str, Value] = field(default_factory=dict)
    port: Port = Port.TABLE
    label: str = ""
    place: str = ""

    @classmethod
    def of(cls, port: Port | None = None, place: str = "", **values: Value) -> Self:
        """The effect with its values in SI units, checked against the physical range.

        The port is the first possible one if not given; `place` is the word under `place_key`. Raises InputError:
        unknown or missing key, a value outside its range, or a port or place it cannot act at.
        """
        chosen = cls.ports[0] if port is None else port
        place = place or cls.default_place
        if chosen not in cls.ports:
            raise InputError(f"{cls.name} cannot act at port {chosen}", cls.name, f"use one of {', '.join(cls.ports)}")
        if bool(place) != bool(cls.place_key) or (cls.places and place not in cls.places):
            mend = f"use one of {', '.join(cls.places)}" if cls.places else f"give {cls.place_key or 'no place'}"
            raise InputError(f"{cls.place_key or 'place'} {place!r} is not possible", cls.name, mend)
        return cls(values=cls.complete(values), port=chosen, label=cls.name, place=place)

    @classmethod
    def complete(cls, values: Mapping[str, Value]) -> dict[str, Value]:
        """Values with defaults filled in, each inside its physical range.

        Raises:
            InputError: unknown or missing key, or a value outside its physical range.
        """
        known = {parameter.key: parameter for parameter in cls.parameters}
        for key in values:
            if key not in known:
                raise InputError(f"unknown key {key!r}", cls.name, f"known are {', '.join(known)}")
        result: dict[str, Value] = {}
        for key, parameter in known.items():
            value = values.get(key, parameter.default)
            if value is None:
                raise InputError(f"{key} is missing", cls.name, f"give it in {parameter.unit}")
            for number in value if isinstance(value, tuple) else (value,):
                if not parameter.minimum <= number <= parameter.maximum:
                    raise InputError(
                        f"{key} = {format_quantity(number, parameter.unit)} is outside its range",
                        cls.name,
                        f"use {_span(parameter)}",
                    )
            result[key] = value
        return result

    @property
    def curved(self) -> Effect:
        """The law that differs over `curve_over` where this one has another form: itself, or a part of it."""
        return self

    def with_values(self, **values: Value) -> Self:
        """A copy with some values replaced, not checked against the range (fits may touch its edge)."""
        return replace(self, values={**self.values, **values})

    @classmethod
    def parameter(cls, key: str) -> Parameter:
        """The parameter with that key."""
        return next(parameter for parameter in cls.parameters if parameter.key == key)


class ChainEffect(Effect):
    """An effect that changes a value of the linear chain, or adds a coordinate to it.

    Attributes:
        adds_coordinate: whether the chain takes a further mass on the table from its values (see
            `feeddrive.plant.chain.table_mode`).
    """

    kind = Kind.CHAIN
    adds_coordinate: ClassVar[bool] = False

    def chain(self, chain: dict[str, Expression], p: Mapping[str, Expression]) -> dict[str, Expression]:
        """The chain's parameters [SI] with this effect in."""
        raise NotImplementedError


class TravelEffect(Effect):
    """An effect that adds delta [m] to the nut stretch e = r phi + delta - x."""

    kind = Kind.TRAVEL
    ports = (Port.TRANSMISSION,)

    def travel(
        self, angle: Expression, position: Expression, time: Expression, p: Mapping[str, Expression]
    ) -> Expression:
        """Travel deviation delta [m] at screw angle [rad], table position [m] and time [s]."""
        raise NotImplementedError


class TransmissionEffect(Effect):
    """An effect that fills a slot of the one spring law of the transmission.

    Attributes:
        has_play: whether it opens a gap, in which the motion can be chaotic.
        stroke_keys: parameters that are the ends of the declared stroke where a plant file leaves them out.
    """

    kind = Kind.TRANSMISSION
    ports = (Port.TRANSMISSION,)
    has_play: ClassVar[bool] = False
    stroke_keys: ClassVar[tuple[str, ...]] = ()

    def free_play(self, p: Mapping[str, Expression]) -> Expression:
        """Total free play [m] that it adds; gaps add."""
        return 0.0

    def stiffness_factor(self, position: Expression, p: Mapping[str, Expression]) -> Expression:
        """Factor on the stiffness with the table at `position` [m]; factors multiply."""
        return 1.0

    def lost_force(self, force: Expression, p: Mapping[str, Expression]) -> Expression:
        """What the spring's force [N] loses [N]; losses add."""
        return 0.0

    def lost_energy(self, force: Expression, p: Mapping[str, Expression]) -> Expression:
        """Integral of the lost force over the force, from 0 [N^2]."""
        return 0.0


class FrictionEffect(Effect):
    """An effect that fills a slot of the one friction law of its port.

    The law: (level0 * factors + increments) * shape + viscous0 * viscous factors + viscous increments. What is declared
    carries level0, viscous0 and a shape; factors and increments of others apply to it.
    """

    kind = Kind.FRICTION
    declared: ClassVar[bool] = False

    def shape(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Direction of the Coulomb part of declared friction, smooth through zero velocity, -1 to 1 [1]."""
        raise NotImplementedError

    def level(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Coulomb level that it adds [N, or N m at a shaft]."""
        return 0.0

    def level_factor(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Factor on the declared Coulomb level."""
        return 1.0

    def viscous(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Speed-dependent force that it adds [N, or N m at a shaft]."""
        return 0.0

    def viscous_factor(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Factor on the declared speed-dependent force."""
        return 1.0

    def turning_points(self) -> dict[str, tuple[float, ...]]:
        """Where its level, coefficient or factor may turn, by what it reads; between and beyond them it is monotone.

        Keys are "position" [m, or rad at a shaft], "speed" (size of the velocity) [m/s or rad/s] and "time" [s]; what
        depends on the direction alone has none. From these points follows where the friction of a port is least
        (`feeddrive.plant.passive_friction`).
        """
        return {}

    def level_terms(self, motion: Motion, p: Mapping[str, Expression]) -> tuple[Expression, ...]:
        """The level as terms, of which each is monotone between the turning points [N, or N m at a shaft]."""
        return (self.level(motion, p),)

    def least_level(self, radius: float) -> float | None:
        """What it adds to the level at least [N or N m], for any motion; None where turning points decide.

        `radius` is the travel of the nut per angle of the screw [m/rad].
        """
        return None


class BristleEffect(FrictionEffect):
    """A friction effect with a bristle deflection as its state, in place of the tanh shape of its port."""

    def deflection_rate(
        self, z: Expression, motion: Motion, level: Expression, p: Mapping[str, Expression]
    ) -> Expression:
        """Rate of the bristle deflection [m/s]."""
        raise NotImplementedError

    def force(
        self, z: Expression, rate: Expression, motion: Motion, level: Expression, p: Mapping[str, Expression]
    ) -> Expression:
        """Friction force of the bristle [N]."""
        raise NotImplementedError

    def energy(self, z: Expression, p: Mapping[str, Expression]) -> Expression:
        """Energy in the bristle [J]."""
        raise NotImplementedError


class SourceEffect(Effect):
    """An effect that adds a force or torque, positive when it resists + motion."""

    kind = Kind.SOURCE

    def force(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Force [N] at the table or torque [N m] at a shaft; positive resists + motion."""
        raise NotImplementedError


class DriveEffect(Effect):
    """An effect on what the motor makes of the torque that it is asked for.

    It is neither a source, as it depends on the torque, nor timing: see `feeddrive.plant.motor_torque`.
    """

    kind = Kind.DRIVE
    ports = (Port.MOTOR,)

    def droop(self, p: Mapping[str, Expression]) -> Expression:
        """Share of the torque that is lost, per square of the torque [1/(N m)^2]; those of several effects add."""
        return 0.0

    def gain(self, p: Mapping[str, Expression]) -> Expression:
        """Torque that is recorded over the torque before droop; those of several effects multiply."""
        return 1.0


class TimingEffect(Effect):
    """A delay between what is recorded and what acts."""

    kind = Kind.TIMING

    def delay(self, p: Mapping[str, Expression]) -> Expression:
        """Delay of the acting motor torque [s]."""
        raise NotImplementedError


def forward(velocity: Expression) -> Expression:
    """Share of forward motion, (1 + sign v)/2 with 0 at rest; velocity in m/s.

    It multiplies what vanishes at rest (the shape of the friction law, or the velocity), so the force stays continuous.
    """
    return ca.if_else(velocity > 0, 1, 0)
