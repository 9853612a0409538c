"""Values of a chain from the parts of a drive: what a catalogue sells becomes inertias and springs.

    k_d = 1 / sum c_i,   a_j = (sum of c_i up to hub j) / sum c_i                     distributed screw
    k_XS, k_TS of paper 004, eqs. (6) and (7), without the brake                      three inertias

| symbol | meaning | unit |
|---|---|---|
| c_i | compliance of motor shaft, belt or gear, coupling, at the screw | rad/(N m) |
| a_j | share by which hub or wheel j follows the screw's end rather than the motor | 1 |

For three inertias everything up to the coupling turns with the motor, and the whole screw at the nut.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from feeddrive.errors import InputError
from feeddrive.parts.bearings.supports import Support
from feeddrive.parts.combined_stiffness import Deformation, combined_stiffness
from feeddrive.parts.screw.screw_drive import BallScrewDrive
from feeddrive.plant.chain.linear_chain import Hubs
from feeddrive.units.quantity import format_quantity


@dataclass(frozen=True)
class Computed:
    """A value of the chain.

    Attributes:
        value: [SI].
        source: from what it was computed; empty where it is a value of the file.
        of: that value, by `section.key`, and others it may be instead.
    """

    value: float
    source: str
    of: tuple[str, ...] = ()


def distributed_values(drive: BallScrewDrive, middle: float) -> dict[str, Computed]:
    """Chain values of a distributed screw by their keys, dampers left out.

    The nut in the middle of the stroke, `middle` [m] from the near bearing, decides which end counts where force goes
    to one at a time. Raises InputError where nothing gives way between motor and screw.
    """
    return {
        **_rotary(drive),
        **_screw(drive),
        **_supports(drive, middle),
        "nut_stiffness": _nut(drive),
        "table_mass": Computed(drive.table_mass, ""),
    }


def lumped_values(drive: BallScrewDrive, position: float) -> dict[str, Computed]:
    """Chain values of three inertias with the nut at `position` from the near bearing [m], dampers left out.

    Raises:
        InputError: a gear, which this structure does not have, or a position outside the screw.
    """
    if drive.transmission is not None:
        mend = 'use structure = "distributed_screw"'
        raise InputError("three_inertias has no gear between motor and screw", "belt or gear", mend)
    stiffness = combined_stiffness(without_brake(drive), position)
    hubs = drive.coupling.inertia if drive.coupling is not None else 0.0
    at = f"nut at {format_quantity(position, 'm')}"
    axial, torsional = (", ".join(stiffness.shares_within(kind)) for kind in (Deformation.AXIAL, Deformation.TORSIONAL))
    return {
        "motor_inertia": Computed(drive.motor.rotor_inertia + hubs, "computed from rotor and coupling"),
        "screw_inertia": Computed(drive.screw.inertia, "computed from the screw's diameter and length"),
        "torsional_stiffness": Computed(stiffness.torsional, f"computed from {torsional}, {at}"),
        "axial_stiffness": Computed(stiffness.axial, f"computed from {axial}, {at}"),
    }


def without_brake(drive: BallScrewDrive) -> BallScrewDrive:
    """The drive with its rotor held ideally."""
    return replace(drive, motor=replace(drive.motor, brake=None))


def hubs_between(drive: BallScrewDrive) -> Hubs:
    """(a_j, J_j) of hubs and wheels that ride between motor and screw, in their order [1, kg m^2]."""
    springs = without_brake(drive).torsion_springs(0.0)[1:-1]
    compliance = math.fsum(spring.compliance for spring in springs)
    found: dict[float, float] = {}
    passed = 0.0
    for spring in springs:
        passed += spring.compliance
        share = passed / compliance
        if spring.inertia > 0 and 0 < share < 1 - 1e-12:
            found[share] = found.get(share, 0.0) + spring.inertia
    return tuple(found.items())


def _rotary(drive: BallScrewDrive) -> dict[str, Computed]:
    """Springs and inertias between motor and screw."""
    springs = without_brake(drive).torsion_springs(0.0)[1:-1]
    compliance = sum(spring.compliance for spring in springs)
    if compliance == 0.0:
        what = "nothing gives way between motor and screw"
        raise InputError(what, "coupling", "give the torsional_stiffness of [coupling], or shaft_stiffness of [motor]")
    ratio = drive.transmission.ratio if drive.transmission is not None else 1.0
    passed = at_motor = shared = at_screw = 0.0
    for spring in springs:
        passed += spring.compliance
        share = passed / compliance
        at_motor += spring.inertia * (1 - share) ** 2
        shared += spring.inertia * share * (1 - share)
        at_screw += spring.inertia * share**2
    names = ", ".join(spring.part for spring in springs if spring.compliance > 0.0)
    hubs = "computed from hubs and wheels"
    return {
        "motor_inertia": Computed(drive.motor.rotor_inertia + at_motor / ratio**2, "computed from rotor and hubs"),
        "ratio": Computed(
            ratio, "" if drive.transmission is not None else "direct drive", ("belt.ratio", "gear.ratio")
        ),
        "drive_stiffness": Computed(1 / compliance, f"computed from {names}"),
        "shared_inertia": Computed(shared, hubs),
        "drive_end_inertia": Computed(at_screw, hubs),
    }


def _screw(drive: BallScrewDrive) -> dict[str, Computed]:
    screw = drive.screw
    thick = "diameter" if screw.root_diameter is None else "root diameter"
    return {
        "drive_length": Computed(screw.stub, ""),
        "screw_length": Computed(screw.length, ""),
        "bearing_distance": Computed(screw.length, "end of the screw"),
        "axial_rigidity": Computed(screw.axial_rigidity, f"computed from {thick} and E"),
        "torsional_rigidity": Computed(screw.torsional_rigidity, f"computed from {thick} and G"),
        "mass_per_length": Computed(screw.mass_per_length, "computed from diameter and density"),
        "inertia_per_length": Computed(screw.inertia_per_length, "computed from diameter and density"),
    }


def _supports(drive: BallScrewDrive, middle: float) -> dict[str, Computed]:
    supports = drive.supports
    near, far = supports.near.axial_stiffness, supports.far.axial_stiffness if supports.far is not None else 0.0
    source = f"{supports.kind.value}, bearing"
    if supports.kind is Support.SUPPORTED_SUPPORTED:
        # A linear chain can have one of the two directions: the softer one, to which such an axis is designed.
        near_share, far_share = supports.load_shares(drive.screw, middle)
        near, far = near * near_share, far * far_share
        source = f"{supports.kind.value}, softer direction at mid-stroke"
    return {"bearing_stiffness": Computed(near, source), "far_bearing_stiffness": Computed(far, source)}


def _nut(drive: BallScrewDrive) -> Computed:
    """The nut, and its housing in series with it."""
    if drive.housing_stiffness is None:
        return Computed(drive.nut.axial_stiffness, "", ("nut.axial_stiffness",))
    stiffness = 1 / (1 / drive.nut.axial_stiffness + 1 / drive.housing_stiffness)
    return Computed(stiffness, "computed from nut and housing")
