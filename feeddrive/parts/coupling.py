"""The coupling between motor (or gear) and screw: T = k_COUP,T phi, with T in N m, phi in rad, and two hubs.

Valid below the rated torque and without play (bellows, disc); an elastomer is stiffer in fast motion than at rest, and
softer when warm. Source: catalogues; k_COUP,T of paper 004, eq. (7).

A belt or gear between motor and screw: ratio, stiffness, inertias.

    i = omega_motor / omega_screw,   T_screw = i T_motor,   J at screw = i^2 J at motor,   k at screw = i^2 k at motor

| symbol | meaning | unit |
|---|---|---|
| i | ratio | 1 |
| omega, T | speed, torque | rad/s, N m |
| J, k | inertia, torsional stiffness | kg m^2, N m/rad |

Valid without losses, slip and play; a belt's stiffness holds while its slack side stays taut. Source: kinematics, equal
power on both sides.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from feeddrive.parts.values import PartValue, check_values, part_values


@dataclass(frozen=True)
class Coupling:
    """A torsionally elastic coupling.

    Attributes:
        torsional_stiffness: between the hubs [N m/rad].
        inertia: of both hubs [kg m^2].
        screw_side_share: share of the inertia in the hub on the screw.

    Raises:
        InputError: a value that is not possible.

    Warns:
        ValidityWarning: unusual value.
    """

    torsional_stiffness: float
    inertia: float = 0.0
    screw_side_share: float = 0.5

    values: ClassVar[tuple[PartValue, ...]] = part_values("""
torsional_stiffness | N m/rad | (0.1, 1e9) usual 10 to 5e6 | | torsional stiffness between the hubs
inertia | kg m^2 | [0, 100] usual 0 to 0.2 | = 0 | inertia of both hubs
screw_side_share | 1 | [0, 1] | = 0.5 | share of the inertia in the hub on the screw
""")

    def __post_init__(self) -> None:
        check_values("coupling", self.values, vars(self))

    @property
    def screw_hub_inertia(self) -> float:
        """Inertia of the hub that turns with the screw's end [kg m^2]."""
        return self.inertia * self.screw_side_share

    @property
    def motor_hub_inertia(self) -> float:
        """Inertia of the hub that turns with the motor shaft [kg m^2]."""
        return self.inertia * (1.0 - self.screw_side_share)


@dataclass(frozen=True)
class Transmission:
    """A reduction without losses.

    Attributes:
        ratio: i, motor revolutions per screw revolution; above 1 slows down.
        torsional_stiffness: of belt or teeth with the motor's wheel held, seen at the screw's wheel [N m/rad].
        motor_wheel_inertia: turns with the motor [kg m^2].
        screw_wheel_inertia: turns with the screw [kg m^2].

    Raises:
        InputError: a value that is not possible.

    Warns:
        ValidityWarning: unusual value.
    """

    ratio: float
    torsional_stiffness: float
    motor_wheel_inertia: float = 0.0
    screw_wheel_inertia: float = 0.0

    values: ClassVar[tuple[PartValue, ...]] = part_values("""
ratio | 1 | (0.001, 1000) usual 0.25 to 20 | | turns of the motor per turn of the screw
torsional_stiffness | N m/rad | (0.1, 1e10) usual 10 to 1e7 | | torsional stiffness of belt or teeth with the \
motor's wheel held, at the screw's wheel
motor_wheel_inertia | kg m^2 | [0, 100] usual 0 to 1 | = 0 | inertia of the wheel on the motor
screw_wheel_inertia | kg m^2 | [0, 100] usual 0 to 1 | = 0 | inertia of the wheel on the screw
""")

    def __post_init__(self) -> None:
        check_values("transmission", self.values, vars(self))
