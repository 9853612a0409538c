"""What may make a drive softer, or its first natural frequency lower, than its catalogue says: one change at a time.

Each candidate changes one value of the drive, and says which measurement would single it out.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from feeddrive.parts.bearings.bearing import SupportBearing
from feeddrive.parts.combined_stiffness import combined_stiffness
from feeddrive.parts.screw.nut import Nut
from feeddrive.parts.screw.screw_drive import BallScrewDrive

_SHORTEST_OVERHANG = 1e-3
"""Screw beyond the nut's middle that the search begins with [m]; the chain needs the nut on the screw."""


@dataclass(frozen=True)
class DriveAt:
    """A drive with its nut at a place.

    Attributes:
        drive: motor held.
        position: nut from the near bearing [m].
        guide_stiffness: of guides that stick, felt only by motion below their break-away (a hammer's) [N/m].
    """

    drive: BallScrewDrive
    position: float
    guide_stiffness: float = 0.0

    @property
    def stiffness(self) -> float:
        """What a static test over more than the guides' break-away finds [N/m]."""
        return combined_stiffness(self.drive, self.position).total


@dataclass(frozen=True)
class Candidate:
    """A single change.

    Attributes:
        name: of the changed value.
        unit: SI.
        declared: its value as declared; None where the declared drive takes it as rigid or does not have it.
        ends: range that is searched for it [unit], from the declared value's side.
        applied: the drive with the value changed.
        measurement: what would single it out.
    """

    name: str
    unit: str
    declared: float | None
    ends: tuple[float, float]
    applied: Callable[[float], DriveAt]
    measurement: str


def softer_parts(start: DriveAt) -> tuple[Candidate, ...]:
    """Candidates that lower the static stiffness; parts that the drive does not have are left out."""
    drive, position = start.drive, start.position
    screw, supports = drive.screw, drive.supports

    def changed(**values: object) -> DriveAt:
        return replace(start, drive=replace(drive, **values))  # type: ignore[arg-type]

    found = [
        Candidate(
            "housing and bracket stiffness", "N/m", drive.housing_stiffness, (drive.housing_stiffness or 1e13, 1e6),
            lambda value: changed(housing_stiffness=value),
            "displacement of bearing housing and nut bracket against bed and table under the same force",
        ),
        Candidate(
            "bearing stiffness", "N/m", supports.near.axial_stiffness, (supports.near.axial_stiffness, 1e6),
            lambda value: changed(supports=replace(supports, near=SupportBearing(value))),
            "displacement of the screw's end face against the bearing housing under the same force",
        ),
        Candidate(
            "nut stiffness", "N/m", drive.nut.axial_stiffness, (drive.nut.axial_stiffness, 1e6),
            lambda value: changed(nut=Nut(value)),
            "displacement of the nut's flange against the screw beside it under the same force",
        ),
        Candidate(
            "diameter that carries", "m", screw.stiffness_diameter, (screw.stiffness_diameter, 0.5 * screw.diameter),
            lambda value: changed(screw=replace(screw, root_diameter=value)),
            "root diameter by measuring over balls, or the stiffness at two more nut positions",
        ),
        Candidate(
            "screw under load", "m", position, (position, screw.length),
            lambda value: replace(start, position=value),
            "distance from bearing to nut with a rule",
        ),
    ]  # fmt: skip
    coupling = drive.coupling
    if coupling is not None:
        found.append(
            Candidate(
                "coupling stiffness", "N m/rad", coupling.torsional_stiffness, (coupling.torsional_stiffness, 10.0),
                lambda value: changed(coupling=replace(coupling, torsional_stiffness=value)),
                "twist of the screw's end against the motor's encoder under the same force",
            )
        )  # fmt: skip
    return tuple(found)


def slower_masses(start: DriveAt) -> tuple[Candidate, ...]:
    """Candidates that move the natural frequency and leave the static stiffness as it is."""
    drive, screw = start.drive, start.drive.screw

    def changed(**values: object) -> DriveAt:
        return replace(start, drive=replace(drive, **values))  # type: ignore[arg-type]

    found = [
        Candidate(
            "screw length", "m", screw.length, (start.position + _SHORTEST_OVERHANG, start.position + 3.0),
            lambda value: changed(screw=replace(screw, length=value)),
            "length with a rule; the second natural frequency",
        ),
        Candidate(
            "table mass", "kg", drive.table_mass, (drive.table_mass, 3.0 * drive.table_mass),
            lambda value: changed(table_mass=value),
            "weighing, or the frequency again with a known mass added",
        ),
        Candidate(
            "guides that stick", "N/m", 0.0, (0.0, 0.5 * start.stiffness),
            lambda value: replace(start, guide_stiffness=value),
            "the frequency at several hammer forces: sticking guides soften as the force grows",
        ),
    ]  # fmt: skip
    coupling = drive.coupling
    if coupling is not None:
        found.append(
            Candidate(
                "coupling inertia", "kg m^2", coupling.inertia, (0.0, 0.1),
                lambda value: changed(coupling=replace(coupling, inertia=value)),
                "inertia from the catalogue; the second natural frequency",
            )
        )  # fmt: skip
    return tuple(found)
