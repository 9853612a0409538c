"""Declared values of a plant file that may be other than declared: which, how well each is known, what would settle it.

Tolerances are those of `feeddrive.diagnosis.likelihood.tolerances`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from feeddrive.diagnosis.likelihood.tolerances import (
    CARRYING,
    DAMPING,
    FRICTION,
    LENGTH,
    MASS,
    MISSING,
    STIFFNESS,
    Kind,
    deviation_of,
    written_share,
)
from feeddrive.errors import InputError
from feeddrive.plant.analysis.stiffness_budget import stiffness_budget
from feeddrive.plant.file.plant_file import plant_from_entries
from feeddrive.plant.plant import Plant
from feeddrive.simulate.scenario.scenario_overrides import with_overrides
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import parse

_LEAST_SHARE = 1e-4  # of the compliance; a stiffer part than that counts as rigid
_LEAST_TOLERANCE = 1e-6  # of a value that is exact, so that its prior has a width


@dataclass(frozen=True)
class DeclaredValue:
    """A value that may be other than declared.

    Attributes:
        key: in the plant file, dotted, as `--set plant.KEY`.
        unit: SI unit.
        words: for sentences.
        value: as declared [SI]; of `missing` ones the stiffness that would double the whole compliance.
        deviation: standard deviation of the coordinate before anything is measured.
        settled_by: what would single it out.
        missing: whether the file declares none: the coordinate is then the share that it adds to the compliance, and
            else the logarithm of the value over the declared one.
    """

    key: str
    unit: str
    words: str
    value: float
    deviation: float
    settled_by: str
    missing: bool = False

    @property
    def exact(self) -> bool:
        """Whether nothing within its tolerance can be distinguished from it."""
        return not self.missing and self.deviation <= deviation_of(_LEAST_TOLERANCE)

    def at(self, coordinate: float) -> str | None:
        """The value at a coordinate as a file writes it; None where nothing is to be written."""
        number = self.number(coordinate)
        return None if number is None else f"{number!r} {self.unit}".removesuffix(" 1")

    def number(self, coordinate: float) -> float | None:
        """The value at a coordinate [SI]; None for a missing part that adds nothing."""
        if self.missing:
            return self.value / coordinate if coordinate > _LEAST_SHARE else None
        return self.value * math.exp(coordinate)


@dataclass(frozen=True)
class _Place:
    key: str
    unit: str
    words: str
    kind: Kind
    settled_by: str


_FORCE = "under the same force"
_SETTLED_DAMPING = "height of the resonance in a frequency response"
_PLACES = (
    _Place("nut.axial_stiffness", "N/m", "nut stiffness", STIFFNESS,
           f"displacement of the nut's flange against the screw beside it {_FORCE}"),
    _Place("nut.catalogue_stiffness", "N/m", "nut stiffness", STIFFNESS,
           f"displacement of the nut's flange against the screw beside it {_FORCE}"),
    _Place("nut.combined_stiffness", "N/m", "nut stiffness", STIFFNESS,
           f"displacement of the nut's flange against the screw beside it {_FORCE}"),
    _Place("bearing.near.axial_stiffness", "N/m", "stiffness of the bearing at the motor's end", STIFFNESS,
           f"displacement of the screw's end face against the bearing housing {_FORCE}"),
    _Place("bearing.far.axial_stiffness", "N/m", "stiffness of the far bearing", STIFFNESS,
           f"displacement of the screw's far end face against its housing {_FORCE}"),
    _Place("coupling.torsional_stiffness", "N m/rad", "coupling stiffness", STIFFNESS,
           f"twist of the screw's end against the motor's encoder {_FORCE}"),
    _Place("motor.shaft_stiffness", "N m/rad", "motor shaft stiffness", STIFFNESS,
           f"twist of the coupling's motor hub against the motor's encoder {_FORCE}"),
    _Place("belt.torsional_stiffness", "N m/rad", "belt stiffness", STIFFNESS,
           f"twist of the screw's end against the motor's encoder {_FORCE}"),
    _Place("gear.torsional_stiffness", "N m/rad", "gear stiffness", STIFFNESS,
           f"twist of the screw's end against the motor's encoder {_FORCE}"),
    _Place("brake.stiffness", "N m/rad", "brake stiffness", STIFFNESS,
           f"turn of the motor's encoder {_FORCE}"),
    _Place("transmission.axial_stiffness", "N/m", "axial stiffness", STIFFNESS,
           f"displacement of the table against the nut's screw end {_FORCE}"),
    _Place("transmission.torsional_stiffness", "N m/rad", "torsional stiffness", STIFFNESS,
           f"twist of the screw against the motor's encoder {_FORCE}"),
    _Place("ball_screw.root_diameter", "m", "root diameter of the screw", LENGTH, "root diameter, by measuring"),
    _Place("ball_screw.diameter", "m", "diameter that carries", CARRYING,
           "root diameter by measuring, or the stiffness at two more nut positions"),
    _Place("ball_screw.length", "m", "screw length", LENGTH, "length with a rule; the second natural frequency"),
    _Place("table.first_nut_position", "m", "place of the nut", LENGTH, "distance from bearing to nut with a rule"),
    _Place("table.mass", "kg", "table mass", MASS, "weighing, or the frequency again with a known mass added"),
    _Place("motor.rotor_inertia", "kg m^2", "rotor inertia", MASS, "torque of a known acceleration, coupling undone"),
    _Place("motor.inertia", "kg m^2", "motor inertia", MASS, "torque of a known acceleration, coupling undone"),
    _Place("ball_screw.inertia", "kg m^2", "screw inertia", MASS, "torque of a known acceleration"),
    _Place("damping.ratio", "1", "damping ratio", DAMPING, _SETTLED_DAMPING),
    _Place("transmission.torsional_damping", "N m s/rad", "torsional damping", DAMPING, _SETTLED_DAMPING),
    _Place("transmission.axial_damping", "N s/m", "axial damping", DAMPING, _SETTLED_DAMPING),
    _Place("coupling.inertia", "kg m^2", "coupling inertia", MASS, "the catalogue; the second natural frequency"),
)  # fmt: skip
_FRICTION_UNITS = {
    "guide_friction": {"coulomb": "N", "viscous": "N s/m"},
    "nut_drag": {"coulomb": "N m", "viscous": "N m/(rad/s)^(2/3)"},
    "bearing_drag": {"coulomb": "N m"},
}
_SETTLED_HOUSING = f"displacement of bearing housing and nut bracket against bed and table {_FORCE}"
_SETTLED_FRICTION = "torque at several constant speeds, with the nut or the coupling undone"


def declared_values(entries: Mapping[str, Any], whole_stiffness: float | None) -> tuple[DeclaredValue, ...]:
    """The values of a plant file that may be other than declared.

    Args:
        entries: of the file, read already.
        whole_stiffness: at the table, motor held [N/m]; None where nothing is elastic.

    Raises:
        InputError: a tolerance that cannot be read.
    """
    found = [value for place in _PLACES if (value := _declared(entries, place)) is not None]
    if any(value.key == "ball_screw.root_diameter" for value in found):
        found = [value for value in found if value.key != "ball_screw.diameter"]
    found += _frictions(entries)
    parts = any(value.key.startswith(("nut.", "bearing.")) for value in found)
    if whole_stiffness is not None and parts and "housing_stiffness" not in entries.get("support", {}):
        found.append(
            DeclaredValue("support.housing_stiffness", "N/m", "bracket and housing stiffness, declared rigid",
                          whole_stiffness, MISSING.catalogue / 2, _SETTLED_HOUSING, missing=True)
        )  # fmt: skip
    return tuple(found)


def _declared(entries: Mapping[str, Any], place: _Place) -> DeclaredValue | None:
    at: Any = entries
    *path, last = place.key.split(".")
    sources = [str(entries.get("source", ""))]
    for step in path:
        at = at.get(step) if isinstance(at, Mapping) else None
        if not isinstance(at, Mapping):
            return None
        sources.append(str(at.get("source", "")) or sources[-1])
    if last not in at:
        return None
    return _value(at[last], place, sources[-1])


def _value(written: Any, place: _Place, source: str) -> DeclaredValue | None:
    tolerance = ""
    if isinstance(written, Mapping):
        source, tolerance = str(written.get("source", source)), str(written.get("tolerance", ""))
        written = written.get("value")
    if isinstance(written, list):
        return None
    number = parse(written, place.unit, place.key)
    if not number > 0:
        return None
    share = written_share(tolerance, number, place.unit, place.key) if tolerance else place.kind.usual(source)
    deviation = deviation_of(max(share, _LEAST_TOLERANCE))
    return DeclaredValue(place.key, place.unit, place.words, number, deviation, place.settled_by)


def _frictions(entries: Mapping[str, Any]) -> list[DeclaredValue]:
    found, counts = [], dict[str, int]()
    for effect in entries.get("effect", []):
        name = effect.get("name", "")
        counts[name] = counts.get(name, 0) + 1
        if counts[name] > 1:
            continue  # an override names an effect by its name, and two of one name by their number
        for key, unit in _FRICTION_UNITS.get(name, {}).items():
            if key in effect:
                words = f"{name.replace('_', ' ')}, {key}"
                place = _Place(f"effect.{name}.{key}", unit, words, FRICTION, _SETTLED_FRICTION)
                source = str(effect.get("source", entries.get("source", "")))
                value = _value(effect[key], place, source)
                found += [value] if value is not None else []
    return found


@dataclass(frozen=True, eq=False)
class DeclaredPlant:
    """A plant file, and which of its values may be other than declared.

    Attributes:
        entries: of the file.
        path: of it.
        plant: read from it.
        values: that may be other.
    """

    entries: Mapping[str, Any]
    path: Path
    plant: Plant
    values: tuple[DeclaredValue, ...]

    def plant_with(self, coordinates: FloatArray) -> Plant:
        """The plant with other values, (k,) coordinates."""
        texts = {one.key: one.at(float(c)) for one, c in zip(self.values, coordinates, strict=True) if c != 0.0}
        written = {key: text for key, text in texts.items() if text is not None}
        return plant_from_entries(with_overrides(self.entries, written), self.path)


def values_of(entries: Mapping[str, Any], path: Path, plant: Plant, position: float) -> tuple[DeclaredValue, ...]:
    """What may be other than declared in a plant file; a missing part is measured by the stiffness at a position [m].

    Raises:
        InputError: nothing may.
    """
    values = declared_values(entries, stiffness_budget(plant, position).total if plant.chain.elastic else None)
    if not values:
        raise InputError("declares nothing that could be other", str(path), "declare its parts")
    return values
