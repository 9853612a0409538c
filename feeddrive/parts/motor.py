"""The motor: rotor inertia [kg m^2], torque limit [N m], shaft and brake stiffness T = k phi [N m/rad].

Valid for a motor as a rigid rotor on an elastic shaft; a brake holds without play, a held rotor without one is fixed.
Source: catalogues; k_M,T of paper 004, eq. (7), whose motor is held by its brake.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from feeddrive.parts.values import PartValue, check_values, part_values


@dataclass(frozen=True)
class HoldingBrake:
    """A brake that holds the rotor while the motor is off.

    Attributes:
        holding_torque: above which it slips [N m].
        stiffness: of the closed brake between rotor and motor housing [N m/rad]; its backlash is not counted.

    Raises:
        InputError: a value that is not possible.

    Warns:
        ValidityWarning: unusual value.
    """

    holding_torque: float
    stiffness: float

    values: ClassVar[tuple[PartValue, ...]] = part_values("""
holding_torque | N m | (0, 1e6) usual 0.05 to 2000 | | torque above which the brake slips
stiffness | N m/rad | (0.1, 1e10) usual 10 to 1e7 | | torsional stiffness of the closed brake between rotor and \
motor housing
""")

    def __post_init__(self) -> None:
        check_values("brake", self.values, vars(self))


@dataclass(frozen=True)
class Motor:
    """A servo motor as a mechanical part.

    Attributes:
        rotor_inertia: with encoder and brake [kg m^2].
        torque_limit: peak [N m].
        shaft_stiffness: torsion from the rotor to the hub [N m/rad]; None for a rigid shaft.
        brake: None where a stopped rotor is held ideally, by the servo's integral action or a rigid brake.

    Raises:
        InputError: a value that is not possible.

    Warns:
        ValidityWarning: unusual value.
    """

    rotor_inertia: float
    torque_limit: float
    shaft_stiffness: float | None = None
    brake: HoldingBrake | None = None

    values: ClassVar[tuple[PartValue, ...]] = part_values("""
rotor_inertia | kg m^2 | (0, 100) usual 1e-7 to 1 | | inertia of the rotor, with encoder and brake
torque_limit | N m | (0, 1e6) usual 0.01 to 5000 | | peak torque of the motor
shaft_stiffness | N m/rad | (0.1, 1e10) usual 10 to 1e7 | | torsional stiffness from the rotor to the hub; rigid if \
left out
""")

    def __post_init__(self) -> None:
        given = {key: value for key, value in vars(self).items() if value is not None}
        check_values("motor", tuple(value for value in self.values if value.key in given), given)
