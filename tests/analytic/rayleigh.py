"""What the screw's own mass and inertia add to the table's in the first mode (Rayleigh).

    m_eff = M + rho A integral(U^2 dz) + rho I_p (2 pi / L)^2 integral(P^2 dz) + (2 pi / L)^2 sum(J_i P_i^2)

| symbol | meaning | unit |
|---|---|---|
| U(z) | axial displacement of the screw when the table is pushed by 1, motor held | 1 |
| P(z) | (L / 2 pi) times its twist | 1 |
| J_i, P_i | hubs and wheels, and P where they turn | kg m^2, 1 |
| M | mass of the table | kg |

The static shape is a guess of the mode's shape, so the frequency is a bound from above. Against finite elements it is
0.5 to 1 % too high for the drive of paper 004, up to 3.5 % with its nut near the motor and 5 % with both ends fixed:
the more the screw turns beside the table, the more. With heavy wheels on a soft belt it can be above 10 %; a warning
says where the added mass exceeds a quarter of the table's. `feeddrive.plant.analysis.modes` has no
such limit. Valid for the first mode, motor held. Source: Rayleigh's quotient.
"""

from __future__ import annotations

import warnings
from dataclasses import astuple, dataclass

from feeddrive.errors import ValidityWarning
from feeddrive.parts.combined_stiffness import combined_stiffness, natural_frequency
from feeddrive.parts.screw.screw_drive import BallScrewDrive

_LARGEST_SHARE = 0.25
"""Added mass over the table's, up to which the error was below 5.2 % in all cases tried."""


@dataclass(frozen=True)
class AddedMass:
    """Masses at the table that stand for the screw and what turns with it [kg].

    Attributes:
        axial_stub, axial_span, axial_overhang: screw's mass behind the near bearing, up to the nut, beyond it.
        rotary_span, rotary_overhang: its rotary inertia from the coupling to the nut, beyond it.
        hubs: coupling, wheels and, where the brake gives way, the rotor.
    """

    axial_stub: float
    axial_span: float
    axial_overhang: float
    rotary_span: float
    rotary_overhang: float
    hubs: float

    @property
    def total(self) -> float:
        """Sum [kg]."""
        return float(sum(astuple(self)))


def added_mass(drive: BallScrewDrive, position: float) -> AddedMass:
    """Rayleigh's masses with the motor held and the nut at `position` from the near bearing [m].

    Raises:
        InputError: a position outside the screw.
    """
    screw, r = drive.screw, drive.screw.travel_per_radian
    k = combined_stiffness(drive, position).total
    beyond = screw.length - position
    at_nut, at_near, at_far = _axial_shape(drive, position, k)
    twist, hubs = 0.0, 0.0
    *springs, span = drive.torsion_springs(position)
    for spring in springs:
        twist += k * r**2 * spring.compliance
        hubs += spring.inertia * twist**2 / r**2
    whole_twist = twist + k * r**2 * span.compliance
    per_length, rotary = screw.mass_per_length, screw.inertia_per_length / r**2
    return AddedMass(
        axial_stub=per_length * screw.stub * at_near**2,
        axial_span=per_length * _integral_of_square(at_near, at_nut, position),
        axial_overhang=per_length * _integral_of_square(at_nut, at_far, beyond),
        rotary_span=rotary * _integral_of_square(twist, whole_twist, position + screw.stub),
        rotary_overhang=rotary * beyond * whole_twist**2,
        hubs=hubs,
    )


def rayleigh_frequency(drive: BallScrewDrive, position: float) -> float:
    """First natural frequency with the screw's own mass, motor held [Hz]; a bound from above.

    Raises:
        InputError: a position outside the screw.

    Warns:
        ValidityWarning: screw, hubs and wheels add more than a quarter of the table's mass.
    """
    added = added_mass(drive, position).total
    if added > _LARGEST_SHARE * drive.table_mass:
        text = (
            f"screw and hubs add {added:.3g} kg to {drive.table_mass:.3g} kg: Rayleigh's frequency may be 5 % too high"
        )
        warnings.warn(f"{text} or more", ValidityWarning, stacklevel=2)
    return natural_frequency(combined_stiffness(drive, position).total, drive.table_mass + added)


def _axial_shape(drive: BallScrewDrive, position: float, k: float) -> tuple[float, float, float]:
    """U at the nut, the near bearing and the far end, linear between, for table displacement 1 under the force k."""
    screw, supports = drive.screw, drive.supports
    near, far = supports.load_shares(screw, position)
    at_nut = k * sum(supports.compliances(screw, position))
    at_near = at_nut - k * near * position / screw.axial_rigidity
    at_far = at_nut - k * far * (screw.length - position) / screw.axial_rigidity
    return at_nut, at_near, at_far


def _integral_of_square(begin: float, end: float, length: float) -> float:
    """Integral of the square of a straight line over a length."""
    return length * (begin**2 + begin * end + end**2) / 3.0
