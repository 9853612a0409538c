"""The screw's material: elastic moduli E, G = E / 2 (1 + nu) [Pa], density [kg/m^3], thermal expansion [1/K].

Valid linearly elastic, near room temperature: E of steel falls by about 0.03 per cent per kelvin.
Source: textbook values of bearing steel; paper 004 needs 210 and 83 GPa for its printed stiffness.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import ClassVar

from feeddrive.errors import ValidityWarning
from feeddrive.parts.values import PartValue, check_values, part_values


@dataclass(frozen=True)
class ShaftMaterial:
    """An isotropic material.

    Attributes:
        young: E, modulus of elasticity [Pa].
        shear: G, shear modulus [Pa].
        density: [kg/m^3].
        expansion: coefficient of thermal expansion [1/K].

    Raises:
        InputError: a value that is not possible.

    Warns:
        ValidityWarning: unusual value, or a G that no isotropic solid has with this E.
    """

    young: float
    shear: float
    density: float
    expansion: float

    values: ClassVar[tuple[PartValue, ...]] = part_values("""
young | Pa | (1e8, 2e12) usual 5e10 to 4.5e11 | | Young's modulus of the screw
shear | Pa | (1e7, 1e12) usual 2e10 to 2e11 | | shear modulus of the screw
density | kg/m^3 | (500, 25000) usual 2000 to 16000 | | density of the screw
expansion | 1/K | (-1e-5, 0.0002) usual 0 to 3e-5 | | thermal expansion of the screw
""")

    def __post_init__(self) -> None:
        check_values("material", self.values, vars(self))
        # G = E / 2 (1 + nu), and every common solid has a Poisson's ratio nu between 0 and 0.5.
        if not self.young / 3.0 < self.shear < self.young / 2.0:
            ratio = self.young / (2.0 * self.shear) - 1.0
            text = f"material: E and G give a Poisson's ratio of {ratio:.2f}, 0 to 0.5 is possible for a common solid"
            warnings.warn(text, ValidityWarning, stacklevel=3)


STEEL = ShaftMaterial(young=206e9, shear=79.3e9, density=7850.0, expansion=11.7e-6)
"""Bearing steel as ball-screw catalogues take it (E of 206 GPa, Poisson's ratio 0.3)."""
