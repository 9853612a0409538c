"""The sections of a plant file that name the parts of a drive, as a catalogue gives them.

[motor]         rotor_inertia, torque_limit, shaft_stiffness (may be left out: rigid)
[brake]         holding_torque, stiffness (both or none; without a brake the motor is held ideally)
[coupling]      torsional_stiffness, inertia of both hubs, screw_side_share
[belt], [gear]  ratio, torsional_stiffness at the screw, motor_wheel_inertia, screw_wheel_inertia
[ball_screw]    lead, diameter, root_diameter, length, stub; young, shear, density, expansion of another material
[support]       kind = "fixed-supported", ..., housing_stiffness
[bearing.near]  axial_stiffness of the bearing at the motor's end; [bearing.far] where that takes force too
[nut]           axial_stiffness, or catalogue_stiffness with catalogue_preload, preload and accuracy_factor
[table]         mass
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from dataclasses import asdict
from typing import TypeVar

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.parts.bearings.supports import ScrewSupports, Support, SupportBearing
from feeddrive.parts.coupling import Coupling, Transmission
from feeddrive.parts.motor import HoldingBrake, Motor
from feeddrive.parts.screw.ball_screw import STEEL, ScrewShaft, ShaftMaterial
from feeddrive.parts.screw.nut import CATALOGUE_VALUES, Nut, stiffness_at_preload
from feeddrive.parts.screw.screw_drive import BallScrewDrive
from feeddrive.parts.values import PartValue, part_values
from feeddrive.schema.table import Table

Made = TypeVar("Made")

_PART_SECTIONS = ("brake", "coupling", "belt", "gear", "bearing")
_MEASURED = {
    "support": ("near_stiffness", "far_stiffness", "source"),
    "nut": ("combined_stiffness", "damping", "source"),
}
"""Keys by which sections of parts hold measured values of the chain instead."""

_PRELOADED = ("catalogue_stiffness", "catalogue_preload", "preload", "accuracy_factor")
_NUT_VALUES = (*Nut.values, *CATALOGUE_VALUES)
(BEARING_RATING,) = part_values("""
static_rating | N | (0, 1e8) usual 500 to 5e6 | | static load rating C0 of the bearing
""")
"""C0 of a bearing, for plausibility rules."""

BEARING_VALUES = (*SupportBearing.values, BEARING_RATING)
"""Values of [bearing.near] and [bearing.far]."""

PART_VALUES: dict[str, tuple[PartValue, ...]] = {
    "motor": Motor.values,
    "brake": HoldingBrake.values,
    "coupling": Coupling.values,
    "belt": Transmission.values,
    "gear": Transmission.values,
    "ball_screw": (*ScrewShaft.values, *ShaftMaterial.values),
    "support": part_values("""
housing_stiffness | N/m | | | axial stiffness of bearing housing and nut bracket; rigid if left out
"""),
    "nut": _NUT_VALUES,
}
"""Values of parts by section."""


def describes_parts(top: Table) -> bool:
    """Whether the file describes the drive by its parts."""
    if any(section in top.entries for section in _PART_SECTIONS):
        return True
    return any(set(top.table(section).entries) - set(measured) for section, measured in _MEASURED.items())


def read_drive(top: Table) -> BallScrewDrive:
    """The parts of a drive; unknown keys of their sections are for the caller to refuse.

    Raises:
        InputError: a section or value that is missing, without unit or not possible; names file, section and key.

    Warns:
        ValidityWarning: unusual values, with the usual range.
    """
    wheels = [section for section in ("belt", "gear") if section in top.entries]
    if len(wheels) > 1:
        raise InputError("belt and gear are both declared", top.where, "keep the one between motor and screw")
    transmission = _part(top, wheels[0], Transmission, Transmission.values) if wheels else None
    coupling = _part(top, "coupling", Coupling, Coupling.values) if "coupling" in top.entries else None
    support, mass = top.table("support"), top.table("table").quantity("mass", "kg", "table_mass")
    housing = given_values(support, "support", PART_VALUES["support"])
    screw, nut, supports, motor = _screw(top), _nut(top), _supports(top), _motor(top)
    return placed(
        f"{top.where}, table",
        lambda: BallScrewDrive(
            screw=screw,
            nut=nut,
            supports=supports,
            table_mass=mass,
            motor=motor,
            coupling=coupling,
            transmission=transmission,
            housing_stiffness=housing.get("housing_stiffness"),
        ),
    )


def placed(where: str, make: Callable[[], Made]) -> Made:
    """What `make` makes, its errors and warnings reported at their place in the file.

    Parts tell `part.key: ...`; a person looks for file, section and key.

    Raises:
        InputError: that of `make`.

    Warns:
        ValidityWarning: those of `make`.
    """
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            made = make()
        except InputError as error:
            _, _, key = error.where.partition(".")
            raise InputError(error.what, f"{where}.{key}" if key else where, error.mend) from None
    for warning in caught:
        part, _, rest = str(warning.message).partition(".")
        text = f"{where}.{rest}" if rest and " " not in part else f"{where}: {warning.message}"
        warnings.warn(text, ValidityWarning, stacklevel=2)
    return made


def given_values(
    table: Table, section: str, known: Iterable[PartValue], needed: Iterable[str] = ()
) -> dict[str, float]:
    """Those of the known values that stand in the table, SI, and those that must: where they are missing, an error."""
    return {
        value.key: table.quantity(value.key, value.unit, f"{section}.{value.key}", value.usual)
        for value in known
        if value.key in table.entries or value.key in needed
    }


def _part(top: Table, section: str, make: Callable[..., Made], known: tuple[PartValue, ...], name: str = "") -> Made:
    """A part from all of its values; those with a default may be left out."""
    table, needed = top.table(section), [value.key for value in known if value.default is None]
    values = given_values(table, name or section, known, needed)
    return placed(table.where, lambda: make(**values))


def _motor(top: Table) -> Motor:
    brake = _part(top, "brake", HoldingBrake, HoldingBrake.values) if "brake" in top.entries else None
    table = top.table("motor")
    values = given_values(table, "motor", Motor.values, ("rotor_inertia", "torque_limit"))
    return placed(table.where, lambda: Motor(**values, brake=brake))


def _screw(top: Table) -> ScrewShaft:
    table = top.table("ball_screw")
    material = {**asdict(STEEL), **given_values(table, "ball_screw", ShaftMaterial.values)}
    steel = placed(table.where, lambda: ShaftMaterial(**material))
    values = given_values(table, "ball_screw", ScrewShaft.values, ("lead", "diameter", "length"))
    return placed(table.where, lambda: ScrewShaft(**values, material=steel))


def _supports(top: Table) -> ScrewSupports:
    support, bearing = top.table("support"), top.table("bearing")
    bearing.refuse_unknown(("near", "far", "source"))
    support.refuse_unknown(("kind", "housing_stiffness", "near_stiffness", "far_stiffness", "source"))
    kind = Support(support.choice("kind", [kind.value for kind in Support]))
    for end in ("near", "far"):
        bearing.table(end).refuse_unknown(("part", *(value.key for value in BEARING_VALUES), "source"))
    near = _part(bearing, "near", SupportBearing, SupportBearing.values, "bearing.near")
    far = None
    if "far" in bearing.entries:
        far = _part(bearing, "far", SupportBearing, SupportBearing.values, "bearing.far")
    return placed(bearing.where, lambda: ScrewSupports(kind, near, far))


def _nut(top: Table) -> Nut:
    table = top.table("nut")
    if "catalogue_stiffness" in table.entries:
        if "axial_stiffness" in table.entries:
            mend = "keep axial_stiffness, or the catalogue's value with the preloads"
            raise InputError("axial_stiffness and catalogue_stiffness are both given", table.where, mend)
        units = {value.key: value.unit for value in _NUT_VALUES}
        given = {key: table.quantity(key, units[key], f"nut.{key}") for key in _PRELOADED}
        stiffness = placed(table.where, lambda: stiffness_at_preload(**given))
        top.origins.found["nut.axial_stiffness"] = "computed from the catalogue's stiffness for this preload"
        return placed(table.where, lambda: Nut(stiffness))
    return _part(top, "nut", Nut, Nut.values)
