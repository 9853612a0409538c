"""Frequency response of the mechanics about a moving point, with a declared delay exactly as phase.

    G(j w) = (C (j w - A)^-1 B + D) exp(-j w d)

| symbol | meaning | unit |
|---|---|---|
| A, B, C, D | plant linearised about a steady motion (`plant.linear.state_space`) | SI |
| w = 2 pi f | angular frequency | rad/s |
| d | declared drive delay; acts on the motor torque alone | s |

Loops with a controller are sampled, see `servo.linear_loop`; their responses are taken by `servo.margins`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.effects.base import TimingEffect
from feeddrive.effects.chain.payload import Payload
from feeddrive.errors import InputError
from feeddrive.plant.analysis.linear import state_space
from feeddrive.plant.analysis.ode import INPUTS, OUTPUTS
from feeddrive.plant.analysis.rest import freed, held
from feeddrive.plant.analysis.steady import MOVING
from feeddrive.plant.plant import Plant
from feeddrive.schema.toml_text import nearest
from feeddrive.servo.margins import frequency_response
from feeddrive.servo.resonances import Resonance, resonances
from feeddrive.typing import ComplexArray, FloatArray
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    import control

UNITS: dict[str, str] = {
    "motor_torque": "N m", "cutting_force": "N", "motor_angle": "rad", "motor_speed": "rad/s", "table_position": "m",
    "table_velocity": "m/s",
}  # fmt: skip
"""Inputs and outputs of the mechanics and their SI units."""

_PER_DECADE = 300
_ABOUT_RESONANCE = np.concatenate([-np.geomspace(6.0, 0.05, 20), np.geomspace(0.05, 6.0, 20)])
"""Grid about a lightly damped root, in units of its damping: the peak is not missed, however sharp."""


class Friction(StrEnum):
    """What stands for friction in a response: the declared law, or a limit of it at rest (`plant.analysis.rest`)."""

    DECLARED = "declared"
    FREE = "free"
    HELD = "held"


_AT_REST = {
    Friction.DECLARED: "at rest under its declared friction",
    Friction.FREE: "at rest without friction",
    Friction.HELD: "at rest with the table held",
}


@dataclass(frozen=True)
class Case:
    """What a response holds for.

    Attributes:
        position: of the table [m].
        velocity: of the table, about which is linearised [m/s].
        payload: mass on the table beyond the declared one [kg].
        friction: the declared law, or a limit of it at rest.
    """

    position: float = 0.0
    velocity: float = MOVING
    payload: float = 0.0
    friction: Friction = Friction.DECLARED

    @property
    def motion(self) -> str:
        """How the table moves, or what holds it, in words."""
        return f"at {format_quantity(self.velocity, 'm/s')}" if self.velocity else _AT_REST[self.friction]

    def on(self, plant: Plant) -> Plant:
        """The plant with the payload on its table, its friction as the case has it.

        Raises:
            InputError: a payload that leaves no mass.
        """
        if self.friction is not Friction.DECLARED:
            plain = replace(self, friction=Friction.DECLARED).on(plant)
            return freed(plain) if self.friction is Friction.FREE else held(plain, self.position)
        if not self.payload:
            return plant
        loaded = plant.with_effects(Payload.of(mass=self.payload))
        if not loaded.chain_values()["table_mass"] > 0:
            mend = f"take away less than the {plant.chain_values()['table_mass']:g} kg that move"
            raise InputError(f"a payload of {self.payload:g} kg leaves no mass", plant.name, mend)
        return loaded


@dataclass(frozen=True)
class Response:
    """A frequency response.

    Attributes:
        given, output: names of input and output.
        unit: of its magnitude, SI.
        frequency: ascending [Hz], shape (n,).
        values: complex, shape (n,).
        marks: resonances and anti-resonances.
    """

    given: str
    output: str
    unit: str
    frequency: FloatArray
    values: ComplexArray
    marks: tuple[Resonance, ...] = ()

    @property
    def decibel(self) -> FloatArray:
        """Magnitude [dB] relative to 1 of `unit`."""
        return decibel(self.values)

    @property
    def degrees(self) -> FloatArray:
        """Phase from -180 to 180 [deg]."""
        return degrees(self.values)

    def frd(self) -> control.FrequencyResponseData:
        """The response as a `control` object, its frequencies in rad/s."""
        import control  # takes half a second, with the plotting that it brings

        return control.frd(self.values, 2 * math.pi * self.frequency)


def decibel(values: ComplexArray) -> FloatArray:
    """Magnitude of complex values [dB], same shape."""
    found: FloatArray = 20 * np.log10(np.maximum(np.abs(values), np.finfo(float).tiny))
    return found


def degrees(values: ComplexArray) -> FloatArray:
    """Phase of complex values from -180 to 180 [deg], same shape."""
    found: FloatArray = np.degrees(np.angle(values))
    return found


def transfer(plant: Plant, given: str, output: str, case: Case) -> control.StateSpace:
    """The mechanics in a case from one of `INPUTS` to one of `OUTPUTS`, without the delay, as a `control` object.

    Raises InputError: an unknown channel, or as `plant.linear.state_space`.
    """
    refuse_unknown(given, INPUTS, "--from")
    refuse_unknown(output, OUTPUTS, "--to")
    return state_space(case.on(plant), case.velocity, case.position)[output, given]


def refuse_unknown(name: str, known: tuple[str, ...], where: str) -> None:
    """Refuse a channel that is not among `known`; names the nearest.

    Raises:
        InputError: it is not.
    """
    if name not in known:
        raise InputError(f'unknown channel "{name}"', where, nearest(name, known))


def delay_of(plant: Plant) -> float:
    """Declared delay between recorded and acting motor torque [s]."""
    return float(sum(effect.delay(effect.values) for effect in plant.effects if isinstance(effect, TimingEffect)))


def mechanics(plant: Plant, given: str, output: str, case: Case, low: float, high: float) -> Response:
    """Response of the mechanics in a case, from 0 < `low` < `high` [Hz], dense about every resonance.

    Input, output and errors as `transfer`; also refuses frequencies that are no range.
    """
    refuse_no_range(low, high)
    system = transfer(plant, given, output, case)
    roots = resonances(system, low, high)
    frequency = grid(low, high, roots)
    values = frequency_response(system, frequency)
    late = delay_of(plant) if given == "motor_torque" else 0.0
    delayed = values * np.exp(-2j * math.pi * frequency * late)
    return Response(given, output, f"{_bracketed(UNITS[output])}/{_bracketed(UNITS[given])}", frequency, delayed, roots)


def refuse_no_range(low: float, high: float) -> None:
    """Refuse frequencies [Hz] that are no range.

    Raises:
        InputError: they are not.
    """
    if not 0 < low < high < math.inf:
        what = f"{low:g} Hz to {high:g} Hz is no range of frequencies"
        raise InputError(what, "frequencies", 'write e.g. "1 Hz,2 kHz"')


def grid(low: float, high: float, roots: tuple[Resonance, ...] = ()) -> FloatArray:
    """Frequencies [Hz], even on a logarithmic axis and denser about resonances; both ends are in it."""
    count = 2 + math.ceil(_PER_DECADE * math.log10(high / low))
    fine = [root.frequency * (1 + root.damping * _ABOUT_RESONANCE) for root in roots]
    exact = [root.frequency for root in roots]
    found: FloatArray = np.unique(np.concatenate([np.geomspace(low, high, count), *fine, exact]))
    return found[(found >= low) & (found <= high)]


def _bracketed(unit: str) -> str:
    return f"({unit})" if "/" in unit or " " in unit else unit
