"""The plant: a linear chain, a heat network, or both, and a list of effects at their ports.

Where the two are joined, friction of the motion heats the network, and its temperatures change friction and screw.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from feeddrive.effects.base import ChainEffect, Effect, TravelEffect, Value
from feeddrive.effects.heat.thermal_effect import ThermalEffect
from feeddrive.errors import InputError
from feeddrive.parts.screw.screw_drive import BallScrewDrive
from feeddrive.plant.chain.chain import Chain
from feeddrive.plant.chain.table_mode import with_modes
from feeddrive.plant.composition import refuse_what_cannot_compose, refuse_what_misses_values
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.thermal_coupling import Coupling
from feeddrive.units.quantity import format_quantity


@dataclass(frozen=True)
class Sensor:
    """A declared sensor.

    Attributes:
        channel: that it writes.
        kind, at: what it is, and where it sits.
        resolution: [channel unit]; 0 where it is not declared.
        absolute: whether its zero is the same in every recording.
        model_error: rms of what the plant itself may miss of the channel, noise aside [channel unit]; 0 where it is
            exact.
    """

    channel: str
    kind: str
    at: str
    resolution: float = 0.0
    absolute: bool = False
    model_error: float = 0.0


@dataclass(frozen=True)
class Datum:
    """A number of a plant file and its SI unit."""

    value: float
    unit: str


@dataclass(frozen=True)
class PositionVelocityController:
    """Cascade of a position and a velocity gain, its output held over the sample.

        u = K_vel (K_pos (x_set - x) - v),  |u| <= limit,  T = gain u

    Attributes:
        position_gain: K_pos [1/s].
        velocity_gain: K_vel [V s/m], or in whatever unit the output has.
        output_limit: limit of u [V].
        torque_per_output: motor torque per output [N m/V].
        velocity_samples: v is the difference of the position over so many samples, which reads it half of them late;
            0 for the velocity itself.
    """

    position_gain: float
    velocity_gain: float
    output_limit: float
    torque_per_output: float
    velocity_samples: int = 0


@dataclass(frozen=True)
class DeclaredCascade:
    """The table of a drive's cascade, with the keys of a controller file; what runs it reads it.

    Attributes:
        entries: keys to what is written.
        where: file and table, for messages.
    """

    entries: Mapping[str, Any]
    where: str


@dataclass(frozen=True)
class Plant:
    """A feed drive: everything a simulation, a linearisation or a fit needs.

    Its parts are optional. What is asked of a part that was not declared is answered by an `InputError`.

    Attributes:
        name: of the machine.
        mechanics: linear chain with its values, SI, further masses on the table taken from the effects; None where heat
            alone is declared. `chain` gives it.
        effects: declared friction and whatever was found, on motion and on heat, each with its values.
        torque_limit: of the motor [N m]; infinite if not declared.
        torque_constant: of the motor [N m/A], where declared; peak current is meant where the recording holds it so.
        sensors: declared sensors of motion.
        controller: the controller that drives the axis, where declared.
        stroke: least and greatest table position [m], where declared.
        drive: the parts, where the machine is described by them.
        data: values of parts and ratings as declared, by `section.key`.
        origins: value key to the source written in the plant file.
        network: what is declared about heat, its effects taken from `effects`; None where nothing is. `heat` gives it.
        joint: how motion and heat are joined, where declared. `coupling` gives it.
    """

    name: str
    mechanics: Chain | None
    effects: tuple[Effect, ...] = ()
    torque_limit: float = float("inf")
    sensors: tuple[Sensor, ...] = ()
    controller: PositionVelocityController | DeclaredCascade | None = None
    stroke: tuple[float, float] | None = None
    drive: BallScrewDrive | None = None
    data: Mapping[str, Datum] = field(default_factory=dict)
    origins: Mapping[str, str] = field(default_factory=dict)
    torque_constant: float | None = None
    network: Heat | None = None
    joint: Coupling | None = None

    def __post_init__(self) -> None:
        effects = _labelled(self.effects)
        object.__setattr__(self, "effects", effects)
        on_heat = tuple(effect for effect in effects if isinstance(effect, ThermalEffect))
        if self.mechanics is not None:
            refuse_what_cannot_compose(effects, self.chain.elastic, self.name)
            refuse_what_misses_values(effects, self.chain.values, self.chain.structure)
            modes = [effect.label for effect in effects if isinstance(effect, ChainEffect) and effect.adds_coordinate]
            object.__setattr__(self, "mechanics", with_modes(self.chain, modes))
        elif len(on_heat) < len(effects):
            moving = next(effect.name for effect in effects if not isinstance(effect, ThermalEffect))
            raise InputError(f"{moving} acts on motion, and heat alone is declared", self.name, "leave it out")
        if self.network is not None:
            object.__setattr__(self, "network", replace(self.network, effects=on_heat))
        elif on_heat:
            raise InputError(f"{on_heat[0].name} acts on heat, and none is declared", self.name, "declare [thermal]")

    @property
    def has_motion(self) -> bool:
        """Whether masses and drives are declared."""
        return self.mechanics is not None

    @property
    def has_heat(self) -> bool:
        """Whether heat is declared."""
        return self.network is not None

    @property
    def chain(self) -> Chain:
        """The linear chain.

        Raises:
            InputError: heat alone is declared.
        """
        if self.mechanics is None:
            what = "declares heat alone, and this needs a machine with masses and drives"
            raise InputError(what, self.name, 'name another plant, or add structure = "..." with its sections')
        return self.mechanics

    @property
    def heat(self) -> Heat:
        """The heat network with its friction, films and effects, driven by the speed of the screw.

        Raises:
            InputError: none is declared.
        """
        if self.network is None:
            raise InputError("declares no heat", self.name, "add [thermal] with the heat of the machine")
        return self.network

    @property
    def coupling(self) -> Coupling:
        """How motion and heat are joined.

        Raises:
            InputError: it is not declared.
        """
        if self.joint is None:
            mend = "declare in [thermal.coupling] how its heat and its drive are joined"
            raise InputError("has no [thermal.coupling] section", self.name, mend)
        return self.joint

    @cached_property
    def joined_heat(self) -> Heat:
        """The heat network without friction heats of its own: the friction that heats it is that of the motion.

        Raises:
            InputError: heat, or how it is joined to the motion, is not declared.
        """
        return self.heat.joined(self.coupling)

    @property
    def motion_effects(self) -> tuple[Effect, ...]:
        """The effects that act on the chain."""
        return tuple(effect for effect in self.effects if not isinstance(effect, ThermalEffect))

    def with_effects(self, *effects: Effect) -> Plant:
        """The plant with further effects.

        Raises:
            InputError: an effect that cannot act in this structure, or on what is not declared, or two that cannot act
                together.
        """
        return replace(self, effects=(*self.effects, *effects))

    def with_chain_values(self, values: Mapping[str, float]) -> Plant:
        """The plant with other values of its chain, SI."""
        return replace(self, mechanics=replace(self.chain, values=values))

    def effect_values(self) -> dict[str, Value]:
        """Parameters of the effects on the chain, named `label.key`, SI."""
        return {f"{one.label}.{key}": value for one in self.motion_effects for key, value in one.values.items()}

    def chain_values(self) -> dict[str, float]:
        """Values of the chain with the chain effects in, SI."""
        values = dict(self.chain.values)
        for effect in self.effects:
            if isinstance(effect, ChainEffect):
                values = effect.chain(values, effect.values)
        return values

    @property
    def middle(self) -> float:
        """Table position in the middle of the stroke [m]; 0 where no stroke is declared."""
        return 0.5 * sum(self.stroke) if self.stroke else 0.0

    def refuse_off_stroke(self, position: float, where: str) -> None:
        """Refuse a table position [m] outside the declared stroke, or with the nut off the screw.

        Raises:
            InputError: names what is allowed.
        """
        if self.stroke is not None and not self.stroke[0] <= position <= self.stroke[1]:
            ends = " to ".join(format_quantity(end, "m") for end in self.stroke)
            what = f"the table at {format_quantity(position, 'm')} is outside the stroke of {self.name}"
            raise InputError(what, where, f"choose from {ends}")
        self.chain.refuse_off_screw(position, where)

    def effects_of(self, kind: type[Effect]) -> tuple[Effect, ...]:
        """The effects of one class."""
        return tuple(effect for effect in self.effects if isinstance(effect, kind))

    @property
    def has_travel(self) -> bool:
        """Whether travel errors act."""
        return any(isinstance(effect, TravelEffect) for effect in self.effects)


def _labelled(effects: tuple[Effect, ...]) -> tuple[Effect, ...]:
    """The effects with unique labels: name, name_2, name_3."""
    seen: Counter[str] = Counter()
    result = []
    for effect in effects:
        seen[effect.name] += 1
        label = effect.name if seen[effect.name] == 1 else f"{effect.name}_{seen[effect.name]}"
        result.append(replace(effect, label=label))
    return tuple(result)
