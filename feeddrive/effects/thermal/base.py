"""What every thermal effect answers: the slots of the heat balance that it fills, all of them neutral by default.

Effects that fill the same slot compose by the slot: heats, conductances, surroundings and growths add, factors
multiply, lags follow each other. `feeddrive.thermal.acting` puts them together.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from feeddrive.effects.base import Effect, Kind, Port, Value
from feeddrive.errors import InputError
from feeddrive.typing import FloatArray

FRONT, REAR, NUT = "front", "rear", "nut"
"""Places: the seat at the motor's end, the seat at the other end, the nut."""


@dataclass(frozen=True, eq=False)
class Operation:
    """What a machine does, row by row; a row is an interval of constant speed.

    Attributes:
        speed: of the screw over each row, not negative, (k,) [rad/s].
        start: of each row, from the start of the run, (k,) [s].
        step: length of a row [s].
    """

    speed: FloatArray
    start: FloatArray
    step: float

    @property
    def middle(self) -> FloatArray:
        """Middle of each row, (k,) [s]."""
        return self.start + 0.5 * self.step


class ThermalEffect(Effect):
    """An effect on temperatures and growth; every slot is neutral unless an effect fills it."""

    kind = Kind.HEAT
    ports = (Port.THERMAL,)
    additive = True
    follows_nut: ClassVar[bool] = False

    def heats(self, run: Operation, p: Mapping[str, Value]) -> dict[str, FloatArray]:
        """Place to the heat that enters there over each row, (k,) [W]."""
        return {}

    def load_factor(self, rise: float, p: Mapping[str, Value]) -> float:
        """Factor on the load torque of the nut at its rise [K]."""
        return 1.0

    def viscous_factor(self, rise: float, p: Mapping[str, Value]) -> float:
        """Factor on the viscous torque of the nut at its rise [K]."""
        return 1.0

    def surroundings(self, run: Operation, p: Mapping[str, Value]) -> FloatArray | float:
        """Rise of the surroundings over what is recorded, over each row, (k,) [K]."""
        return 0.0

    def film_factor(self, film: str) -> float:
        """Factor on the film coefficient of "screw" or "nut"."""
        return 1.0

    def contact_factor(self) -> float:
        """Factor on the contact conductance between nut and screw."""
        return 1.0

    def coolant_conductance(self, run: Operation, p: Mapping[str, Value]) -> FloatArray | float:
        """Conductance from the nut to a coolant, mean over each row, (k,) [W/K]."""
        return 0.0

    def attached(self) -> tuple[float, float] | None:
        """Conductance [W/K] and capacity [J/K] of a body on the nut; None where there is none."""
        return None

    def growth(self, position: float, time: FloatArray, p: Mapping[str, Value]) -> FloatArray | float:
        """Growth of the table position read at `position` [m] beyond the screw's at times (k,) [s], (k,) [m]."""
        return 0.0

    def lag(self, channel: str) -> float:
        """Time constant with which a channel follows [s]."""
        return 0.0


def number(value: Value) -> float:
    """A value that is one number.

    Raises:
        InputError: it is a list.
    """
    if isinstance(value, tuple):
        raise InputError("is a list, one value is needed", mend="write one number")
    return value


def curve(value: Value) -> tuple[float, ...]:
    """A value that is a list of numbers, of one where it is a number."""
    return value if isinstance(value, tuple) else (value,)
