"""The elastic parts of a ball-screw drive together, from the motor's brake to the table.

    c_screw side = c_motor side / i^2,      J_screw side = i^2 J_motor side

with compliances c [rad/(N m)], inertias J [kg m^2] and the ratio i (motor over screw turns) of belt or gear. Valid for
small motion without play. Source: paper 004, eqs. (6), (7), with brake and gear added.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from feeddrive.parts.bearings.supports import ScrewSupports, check_position
from feeddrive.parts.coupling import Coupling, Transmission
from feeddrive.parts.motor import Motor
from feeddrive.parts.screw.ball_screw import ScrewShaft
from feeddrive.parts.screw.nut import Nut
from feeddrive.parts.values import PartValue, check_values


@dataclass(frozen=True)
class TorsionSpring:
    """A torsion spring of the chain from motor to screw, as the screw feels it.

    Attributes:
        part: name.
        compliance: [rad/(N m)].
        inertia: of what turns with its end towards the screw [kg m^2].
    """

    part: str
    compliance: float
    inertia: float


@dataclass(frozen=True)
class BallScrewDrive:
    """Motor, transmission or none, coupling or none, screw in its supports, nut and table.

    Attributes:
        screw: shaft.
        nut: nut.
        supports: bearings of the screw.
        table_mass: all that moves with the table [kg].
        motor: motor, stopped and held by its brake or servo.
        coupling: between motor (or transmission) and screw; None where the screw is driven without one.
        transmission: belt or gear; None for a direct drive.
        housing_stiffness: nut bracket and bearing housing in series [N/m]; None where taken as rigid.

    Raises:
        InputError: a value that is not possible.

    Warns:
        ValidityWarning: unusual value.
    """

    screw: ScrewShaft
    nut: Nut
    supports: ScrewSupports
    table_mass: float
    motor: Motor
    coupling: Coupling | None = None
    transmission: Transmission | None = None
    housing_stiffness: float | None = None

    values: ClassVar[tuple[PartValue, ...]] = (
        PartValue("table_mass", "kg", 1e-4, 1e6),
        PartValue("housing_stiffness", "N/m", 1e5, 1e14, usual=(1e7, 1e12)),
    )

    def __post_init__(self) -> None:
        given = {"table_mass": self.table_mass}
        if self.housing_stiffness is not None:
            given["housing_stiffness"] = self.housing_stiffness
        check_values("drive", tuple(value for value in self.values if value.key in given), given)

    def torsion_springs(self, position: float) -> tuple[TorsionSpring, ...]:
        """The springs between held rotor and nut, from the motor on, the screw's span to the nut last.

        The nut is at `position` [m] from the near bearing; InputError outside the screw.
        """
        check_position(self.screw, position)
        ratio = self.transmission.ratio if self.transmission is not None else 1.0
        brake, shaft = self.motor.brake, self.motor.shaft_stiffness
        # A wheel or hub turns with the end of the spring before it; the rotor with the brake's.
        after_shaft = self.transmission.motor_wheel_inertia * ratio**2 if self.transmission is not None else 0.0
        hub = self.coupling.motor_hub_inertia if self.coupling is not None else 0.0
        springs = [
            TorsionSpring(
                "brake", 1.0 / (brake.stiffness * ratio**2) if brake else 0.0, self.motor.rotor_inertia * ratio**2
            ),
            TorsionSpring(
                "motor shaft",
                1.0 / (shaft * ratio**2) if shaft else 0.0,
                after_shaft + (hub if self.transmission is None else 0.0),
            ),
        ]
        if self.transmission is not None:
            belt = 1.0 / self.transmission.torsional_stiffness
            springs.append(TorsionSpring("transmission", belt, self.transmission.screw_wheel_inertia + hub))
        if self.coupling is not None:
            compliance = 1.0 / self.coupling.torsional_stiffness
            springs.append(TorsionSpring("coupling", compliance, self.coupling.screw_hub_inertia))
        span = (position + self.screw.stub) / self.screw.torsional_rigidity
        return (*springs, TorsionSpring("screw", span, 0.0))
