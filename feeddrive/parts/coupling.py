"""The coupling between motor (or gear) and screw: T = k_COUP,T phi, with T in N m, phi in rad, and two hubs.

Valid below the rated torque and without play (bellows, disc); an elastomer is stiffer in fast motion than at rest, and
softer when warm. Source: catalogues; k_COUP,T of paper 004, eq. (7).
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
