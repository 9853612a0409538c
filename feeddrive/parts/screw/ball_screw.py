"""The screw shaft of a ball screw: axial and torsional stiffness, mass, inertia.

    k_BS = E A / l,   k_BS,T = G I_p / l,   A = pi d_s^2 / 4,   I_p = pi d_s^4 / 32

| symbol | meaning | unit |
|---|---|---|
| d_s | diameter that is counted for stiffness: the root diameter where declared, otherwise the nominal one | m |
| l | length under load | m |
| A, I_p | section, second polar moment of area | m^2, m^4 |

Valid for a straight round bar: the grooves are in d_s alone.
Source: paper 004, section 3 (formulas behind its k_BS and k_BS,T).

The screw's material: elastic moduli E, G = E / 2 (1 + nu) [Pa], density [kg/m^3], thermal expansion [1/K].

Valid linearly elastic, near room temperature: E of steel falls by about 0.03 per cent per kelvin.
Source: textbook values of bearing steel; paper 004 needs 210 and 83 GPa for its printed stiffness.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from typing import ClassVar

from feeddrive.errors import InputError, ValidityWarning
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


@dataclass(frozen=True)
class ScrewShaft:
    """A screw shaft; places are counted from the fixed bearing at the motor's end.

    Attributes:
        lead: table travel per revolution [m].
        diameter: nominal [m]; counted for mass and inertia, since the grooves are narrow (a bound from above).
        length: fixed bearing to the far end [m].
        stub: from the fixed bearing back to the coupling, under torque only [m].
        root_diameter: counted for stiffness [m]; None for a solid shaft of the nominal diameter, which is too stiff by
            the square (axial) and the fourth power (torsion) of nominal to root diameter.
        material: of the shaft.

    Raises:
        InputError: a value that is not possible, or a root diameter above the nominal one.

    Warns:
        ValidityWarning: unusual value; the likeliest cause is a slip of its unit.
    """

    lead: float
    diameter: float
    length: float
    stub: float = 0.0
    root_diameter: float | None = None
    material: ShaftMaterial = STEEL

    values: ClassVar[tuple[PartValue, ...]] = part_values("""
lead | m | (0.0001, 0.5) usual 0.001 to 0.08 | | table travel per turn of the screw
diameter | m | (0.001, 0.5) usual 0.004 to 0.2 | | nominal diameter, counted for mass and inertia
length | m | (0.005, 30) usual 0.05 to 12 | | from the near bearing to the far end
stub | m | [0, 5] usual 0 to 0.5 | = 0 | from the near bearing back to the coupling, under torque alone
root_diameter | m | (0.001, 0.5) usual 0.003 to 0.2 | | diameter counted for stiffness; the nominal one if left out
""")

    def __post_init__(self) -> None:
        root = self.diameter if self.root_diameter is None else self.root_diameter
        check_values("screw", self.values, {**vars(self), "root_diameter": root})
        if root > self.diameter:
            raise InputError("exceeds the nominal diameter", "screw.root_diameter", "check which is which")

    @property
    def travel_per_radian(self) -> float:
        """L / 2 pi [m/rad]."""
        return self.lead / (2.0 * math.pi)

    @property
    def stiffness_diameter(self) -> float:
        """d_s, the diameter counted for stiffness [m]."""
        return self.diameter if self.root_diameter is None else self.root_diameter

    @property
    def axial_rigidity(self) -> float:
        """E A [N]: axial stiffness times length."""
        return self.material.young * math.pi * self.stiffness_diameter**2 / 4.0

    @property
    def torsional_rigidity(self) -> float:
        """G I_p [N m^2/rad]: torsional stiffness times length."""
        return self.material.shear * math.pi * self.stiffness_diameter**4 / 32.0

    def axial_stiffness(self, length: float) -> float:
        """k_BS = E A / l of a piece under axial force [N/m]; infinite for no length."""
        return self.axial_rigidity / length if length > 0.0 else math.inf

    def torsional_stiffness(self, length: float) -> float:
        """k_BS,T = G I_p / l of a piece under torque [N m/rad]; infinite for no length."""
        return self.torsional_rigidity / length if length > 0.0 else math.inf

    @property
    def mass_per_length(self) -> float:
        """rho pi d^2 / 4 [kg/m]."""
        return self.material.density * math.pi * self.diameter**2 / 4.0

    @property
    def inertia_per_length(self) -> float:
        """rho pi d^4 / 32 [kg m]."""
        return self.material.density * math.pi * self.diameter**4 / 32.0

    @property
    def mass(self) -> float:
        """Mass of the whole shaft, with the stub [kg]."""
        return self.mass_per_length * (self.length + self.stub)

    @property
    def inertia(self) -> float:
        """About its axis, of the whole shaft, with the stub [kg m^2]."""
        return self.inertia_per_length * (self.length + self.stub)
