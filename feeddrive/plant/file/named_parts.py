"""`part = "…"` in a plant file: the values of a part of the catalogue where the file leaves them out.

What the file writes wins; `departures` tells where it differs from the part that it names. The stiffness of a nut is
one value or follows from the catalogue's at another preload, so that `axial_stiffness` takes the place of all of these;
a preload that is left out is the one for which the catalogue states the stiffness.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from feeddrive.errors import InputError
from feeddrive.parts.catalogue.part_files import CataloguePart, catalogue, find_part
from feeddrive.parts.values import PartValue
from feeddrive.plant.file.drive_sections import BEARING_VALUES, PART_VALUES
from feeddrive.plant.file.ratings import RATINGS
from feeddrive.units.quantity import parse

_PLACES = (("motor",), ("coupling",), ("ball_screw",), ("nut",), ("bearing", "near"), ("bearing", "far"))
_SAME = 1e-3
"""Relative difference up to which two values are the same: catalogues print three or four digits."""


@dataclass(frozen=True)
class Departure:
    """A value that a file writes otherwise than the part that it names.

    Attributes:
        key: dotted.
        part: name of the part.
        written, catalogue: both values [unit].
        unit: SI unit.
        source: of the written value; "" where it has none.
    """

    key: str
    part: str
    written: float
    catalogue: float
    unit: str
    source: str


def with_named_parts(entries: Mapping[str, Any], where: str) -> dict[str, Any]:
    """The entries of a plant file, copied, with the values of the parts that it names put in.

    Raises InputError: a part that the catalogue does not hold, or a name that is no text.
    """
    found = dict(entries)
    for place in _PLACES:
        section = _section(found, place)
        if section is None or "part" not in section:
            continue
        part = _part(section, place, where)
        filled = {**_given(part, place, section), **section}
        if len(place) == 1:
            found[place[0]] = filled
        else:
            found[place[0]] = {**found[place[0]], place[1]: filled}
    return found


def departures(entries: Mapping[str, Any], where: str) -> Iterator[Departure]:
    """Where a plant file writes a value otherwise than the part that it names; arguments and errors as above."""
    top = str(entries.get("source", ""))
    for place in _PLACES:
        section = _section(entries, place)
        if section is not None and "part" in section:
            part = _part(section, place, where)
            units = {key: _known(place[0], key).unit for key in part.sections.get(place[0], {})}
            yield from _differing(part, part.sections.get(place[0], {}), units, section, place, top)
    guide = _section(entries, ("guide",)) or {}
    rated = catalogue().get(str(guide.get("carriage", "")))
    if rated is not None and rated.kind == "guide":
        printed = {**rated.sections["guide"], "friction_coefficient": rated.further["friction_coefficient"]}
        units = {"seal_drag": "N", "friction_coefficient": "1"}
        yield from _differing(rated, printed, units, guide, ("guide",), top)


def _differing(
    part: CataloguePart,
    printed: Mapping[str, Any],
    units: Mapping[str, str],
    section: Mapping[str, Any],
    place: tuple[str, ...],
    source: str,
) -> Iterator[Departure]:
    """Values of one section that are written otherwise than printed."""
    for key, listed in printed.items():
        if key not in section:
            continue
        dotted = ".".join((*place, key))
        entry, named = section[key], str(section.get("source", source))
        if isinstance(entry, Mapping):
            named = str(entry.get("source", named))
        written = entry.get("value") if isinstance(entry, Mapping) else entry
        number, catalogued = parse(written, units[key], dotted), parse(listed, units[key], dotted)
        if not math.isclose(number, catalogued, rel_tol=_SAME):
            yield Departure(dotted, part.name, number, catalogued, units[key], named)


def _section(entries: Mapping[str, Any], place: tuple[str, ...]) -> Mapping[str, Any] | None:
    at: Any = entries
    for step in place:
        at = at.get(step) if isinstance(at, Mapping) else None
    return at if isinstance(at, Mapping) else None


def _part(section: Mapping[str, Any], place: tuple[str, ...], where: str) -> CataloguePart:
    kind = {"ball_screw": "screw", "nut": "screw"}.get(place[0], place[0])
    name = section["part"]
    key = f"{where}, {'.'.join(place)}.part"
    if not isinstance(name, str) or not name.strip():
        raise InputError(f"{name!r} is no name of a part", key, f"`feeddrive parts {kind}` lists them")
    part = find_part(name, kind, key, "or leave `part` out and write the values")
    if place[0] not in part.sections and not (place[0] == "nut" and "axial_stiffness" in section):
        what = f"the catalogue prints no stiffness of the nut of {name}"
        raise InputError(what, key, 'write axial_stiffness = "... N/µm" in [nut], and leave its part out')
    return part


def _given(part: CataloguePart, place: tuple[str, ...], section: Mapping[str, Any]) -> dict[str, Any]:
    """The values of the part for a section, each with its source."""
    values = dict(part.sections.get(place[0], {}))
    if place[0] == "nut":
        if "axial_stiffness" in section:
            return {}
        values.setdefault("preload", values["catalogue_preload"])
    return {key: {"value": value, "source": part.origin} for key, value in values.items()}


def _known(section: str, key: str) -> PartValue:
    """What a value of a section is: its unit and range."""
    known = (
        *PART_VALUES.get(section, ()),
        *RATINGS.get(section, ()),
        *(BEARING_VALUES if section == "bearing" else ()),
    )
    if section == "motor" and key == "torque_constant":
        return PartValue(key, "N m/A")
    return next(value for value in known if value.key == key)
