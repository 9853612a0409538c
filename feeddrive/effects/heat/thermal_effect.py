"""What every thermal effect answers: the slots of the heat balance that it fills, all of them neutral by default.

Effects that fill the same slot compose by the slot: heats, conductances, surroundings and growths add, factors
multiply, lags follow each other. `feeddrive.thermal.laws.laws` puts them together.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from feeddrive.effects.base import Effect, Kind, Port
from feeddrive.typing import Expression

FRONT, REAR, NUT = "front", "rear", "nut"
"""Places: the seat at the motor's end, the seat at the other end, the nut."""


@dataclass(frozen=True)
class Operation:
    """What a machine does over a row, an interval of constant speed, as CasADi expressions or numbers.

    Attributes:
        speed: of the screw, not negative [rad/s].
        start: of the row, from the start of the run [s].
        step: length of the row, above zero [s].
        bearing: friction torque of the front bearing [N m]; of a reference bearing where the machine declares none.
    """

    speed: Expression
    start: Expression
    step: Expression
    bearing: Expression = 0.0

    @property
    def middle(self) -> Expression:
        """Middle of the row [s]."""
        return self.start + 0.5 * self.step


class ThermalEffect(Effect):
    """An effect on temperatures and growth; every slot is neutral unless an effect fills it.

    Slots take the values `p` as CasADi expressions or numbers, and give either.
    """

    kind = Kind.HEAT
    ports = (Port.THERMAL,)
    additive = True

    def heats(self, run: Operation, p: Mapping[str, Expression]) -> dict[str, Expression]:
        """Place to the heat that enters there over a row [W]."""
        return {}

    def load_factor(self, rise: Expression, p: Mapping[str, Expression]) -> Expression:
        """Factor on the load torque of the nut at its rise [K]."""
        return 1.0

    def viscous_factor(self, rise: Expression, p: Mapping[str, Expression]) -> Expression:
        """Factor on the viscous torque of the nut at its rise [K]."""
        return 1.0

    def surroundings(self, run: Operation, p: Mapping[str, Expression]) -> Expression:
        """Rise of the surroundings over what is recorded, over a row [K]."""
        return 0.0

    def film_factor(self, film: str, p: Mapping[str, Expression]) -> Expression:
        """Factor on the film coefficient of "screw", "nut", "front" or "rear"."""
        return 1.0

    def contact_factor(self, p: Mapping[str, Expression]) -> Expression:
        """Factor on the contact conductance between nut and screw."""
        return 1.0

    def coolant_conductance(self, run: Operation, p: Mapping[str, Expression]) -> Expression:
        """Conductance from the nut to a coolant, mean over a row [W/K]."""
        return 0.0

    def attached(self, p: Mapping[str, Expression]) -> tuple[Expression, Expression] | None:
        """Conductance [W/K] and capacity [J/K] of a body on the nut; None where there is none."""
        return None

    def growth(self, position: Expression, time: Expression, p: Mapping[str, Expression]) -> Expression:
        """Growth of the table position read at `position` [m] beyond the screw's, at a time from the start [m]."""
        return 0.0

    def lag(self, channel: str, p: Mapping[str, Expression]) -> Expression:
        """Time constant with which a channel follows [s]."""
        return 0.0
