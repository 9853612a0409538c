"""The bearing (set) that holds the screw axially: its stiffness, F = k_BG x with F in N, x in m.

Valid while the preload keeps all rows loaded, up to about 2.8 times it: a catalogue gives the stiffness at the preload.
Housing and clamping nut yield too and belong into `housing_stiffness` of the drive.
Source: catalogues; k_BG of paper 004, eq. (6).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from feeddrive.parts.values import PartValue, check_values


@dataclass(frozen=True)
class SupportBearing:
    """A support bearing that takes axial force.

    Attributes:
        axial_stiffness: of the preloaded set, without its housing [N/m].

    Raises:
        InputError: a value that is not possible.

    Warns:
        ValidityWarning: unusual value.
    """

    axial_stiffness: float

    values: ClassVar[tuple[PartValue, ...]] = (
        PartValue(
            "axial_stiffness",
            "N/m",
            1e5,
            1e11,
            usual=(1e7, 1e10),
            meaning="axial stiffness of the preloaded set, without its housing",
        ),
    )

    def __post_init__(self) -> None:
        check_values("bearing", self.values, vars(self))
