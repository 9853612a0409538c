"""A new axis from a few words, and the parts catalogue that fills it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from feeddrive.errors import InputError
from feeddrive.files import write_text_atomically
from feeddrive.interface.axis import Axis, axis_of_text
from feeddrive.interface.machine.check import Check
from feeddrive.interface.quantities import Quantity, si
from feeddrive.interface.shown import Listing, Shown
from feeddrive.parts.catalogue.part_files import KINDS, CataloguePart, catalogue
from feeddrive.plant.file.draft_text import draft_text
from feeddrive.plant.file.drafting import Wishes, drafted
from feeddrive.schema.toml_text import nearest_choice
from feeddrive.units.quantity import parse

_WANTED: dict[str, dict[str, tuple[str, str]]] = {
    "screw": {"diameter": ("nominal_diameter", "m"), "lead": ("ball_screw.lead", "m")},
    "bearing": {"bore": ("bore", "m")},
    "guide": {"rail": ("rail", "1")},
    "coupling": {"torque": ("rated_torque", "N m")},
    "motor": {"power": ("rated_power", "W"), "torque": ("rated_torque", "N m")},
}
"""Kind to what can be asked for: its place in a part, and its SI unit; a torque is at least the one asked for."""


@dataclass(frozen=True, repr=False, eq=False)
class Parts(Shown):
    """Parts of the catalogue.

    Attributes:
        found: in the order of the catalogue.
        nearest: where there are none, what parts have that are nearest to it.
    """

    found: Sequence[CataloguePart]
    nearest: str = ""

    def __iter__(self) -> Iterator[CataloguePart]:
        """The parts."""
        return iter(self.found)

    def __len__(self) -> int:
        return len(self.found)

    def listing(self) -> Listing:
        """One row per part, with every value and its source."""
        rows = [[one.name, one.maker, one.kind, one.size, _values(one), one.source] for one in self.found]
        records = [
            {
                "name": one.name,
                "kind": one.kind,
                "maker": one.maker,
                "size": one.size,
                **{f"{section}.{key}": value for section, held in one.sections.items() for key, value in held.items()},
                **one.further,
                "source": one.source,
                "address": one.address,
            }
            for one in self.found
        ]
        headings = ("name", "maker", "kind", "size", "values", "source")
        return Listing(f"{len(rows)} parts", headings, rows, records, self.nearest)


def list_parts(kind: str = "", **wanted: Quantity) -> Parts:
    """Parts of the catalogue, each value with its public source.

    Args:
        kind: "screw", "bearing", "guide", "coupling" or "motor"; all if left out.
        **wanted: diameter and lead of a screw, bore of a bearing, rail of a guide, torque of a coupling or motor (at
            least), power of a motor; strings with units, or numbers in SI.

    Raises:
        InputError: no such kind, or a property that this kind has not.

    >>> import feeddrive as fd
    >>> [part.name for part in fd.list_parts("motor", power="400 W")]
    ['HG-KN43J', 'SGM7J-04A', 'SGMAH-04A']
    """
    if kind and kind not in KINDS:
        raise InputError(f'no kind "{kind}"', "parts", nearest_choice(kind, KINDS))
    found, nearest = [part for part in catalogue().values() if kind in ("", part.kind)], ""
    for name, value in wanted.items():
        if name not in _WANTED.get(kind, {}):
            mend = f"of a {kind} one can ask for {', '.join(_WANTED[kind])}" if kind else "name a kind first"
            raise InputError(f"{name} is no property of a {kind or 'part'}", "parts", mend)
        place, unit = _WANTED[kind][name]
        number = si(value, unit, name)
        before, found = found, [part for part in found if _is(part, place, unit, number, name == "torque")]
        if before and not found:
            held = {_held(part, place, unit): _text(part, place) for part in before}
            near = sorted(sorted(held, key=lambda own: abs(own - number))[:3])
            nearest = f"none has a {name} of {value}; the nearest have {', '.join(held[own] for own in near)}"
    return Parts(tuple(found), nearest)


def _text(part: CataloguePart, place: str) -> str:
    section, _, key = place.rpartition(".")
    return str(part.sections[section][key] if section else part.further[key])


def _held(part: CataloguePart, place: str, unit: str) -> float:
    return parse(_text(part, place), unit, part.name)


def _is(part: CataloguePart, place: str, unit: str, wanted: float, at_least: bool) -> bool:
    own = _held(part, place, unit)
    return own >= wanted * (1 - 1e-9) if at_least else math.isclose(own, wanted, rel_tol=0.01)


def _values(part: CataloguePart) -> str:
    held = [f"{key} {value}" for values in part.sections.values() for key, value in values.items()]
    return ", ".join([*held, *(f"{key} {_short(value)}" for key, value in part.further.items())])


def _short(value: object) -> str:
    return ", ".join(f"{key} {one}" for key, one in value.items()) if isinstance(value, Mapping) else f"{value}"


@dataclass(frozen=True, repr=False, eq=False)
class Draft(Shown):
    """A plant file that `draft` made.

    Attributes:
        text: of the file.
        guesses: dotted key to why this value; what is still to be settled.
    """

    text: str
    guesses: Mapping[str, str]

    def listing(self) -> Listing:
        """What is still a guess."""
        rows = [[key, why] for key, why in self.guesses.items()]
        records = [{"key": key, "why": why} for key, why in self.guesses.items()]
        return Listing(f"{len(rows)} guesses", ("key", "still a guess: why this value"), rows, records)

    @property
    def axis(self) -> Axis:
        """The axis, as `load` would give it once the file is saved."""
        return axis_of_text(self.text, Path("draft.toml"))

    def check(self) -> Check:
        """Rules of plausibility, and what is still a guess."""
        return self.axis.check()

    def save(self, path: str | Path) -> Path:
        """Write the file, whole or not at all; a file that is there already is not overwritten.

        Raises:
            InputError: the file exists, or cannot be written.
        """
        target = Path(path)
        if target.exists():
            raise InputError("exists already", str(target), "name another file, or remove this one")
        write_text_atomically(target, self.text)
        return target


def draft(
    *,
    screw: str,
    motor: str,
    mass: Quantity,
    stroke: Quantity | None = None,
    length: Quantity | None = None,
    guide: str = "",
    carriages: int = 4,
    preload: Quantity | None = None,
    supports: str = "",
    bearing: str = "",
    coupling: str = "",
    orientation: str = "horizontal",
    structure: str = "distributed_screw",
    name: str = "my axis",
) -> Draft:
    """A plant file of parts of the catalogue, with a guess wherever nothing is given.

    Args:
        screw: name of a screw, or its size, "32 x 10 mm".
        motor: name of a motor, or its rated power, "400 W".
        mass: of the table with its load.
        stroke: of the table; from the length of the screw if left out.
        length: of the screw between its bearings; from the stroke if left out.
        guide: name of a carriage, or the size of its rail, "25".
        carriages: how many.
        preload: of the nut.
        supports: "fixed-free", "fixed-supported", "supported-supported" or "fixed-fixed".
        bearing: name of the support bearing.
        coupling: name of the coupling.
        orientation: "horizontal" or "vertical", + upward.
        structure: "distributed_screw" or "three_inertias".
        name: of the machine.

    Raises:
        InputError: something needed is missing, or the catalogue does not hold it; says what it holds.

    >>> import feeddrive as fd
    >>> made = fd.draft(screw="32 x 10 mm", length="1.2 m", motor="400 W", guide="25", mass="80 kg")
    >>> made.axis
    Axis 'my axis': distributed_screw, 3 effects, stroke 0 mm to 1000 mm
    >>> "nut.preload" in made.guesses
    True
    """
    if isinstance(carriages, bool) or not isinstance(carriages, int) or not 1 <= carriages <= 1000:
        raise InputError(f"{carriages!r} is no number of carriages", "--carriages", "write a whole number, such as 4")
    wishes = Wishes(
        screw,
        motor,
        _size(mass, "kg", "mass"),
        _size(stroke, "m", "stroke"),
        _size(length, "m", "length"),
        guide,
        carriages,
        _size(preload, "N", "preload"),
        supports,
        bearing,
        coupling,
        orientation,
        structure,
        name,
    )
    if '"' in name or not name.isprintable() or not name.strip():
        raise InputError(f"{name!r} is no name", "--name", "write letters without quotation marks")
    made = drafted(wishes)
    return Draft(draft_text(made, wishes), made.guesses)


def _size(value: Quantity | None, unit: str, name: str) -> float | None:
    if value is None or value == "":
        return None
    number = si(value, unit, f"--{name}")
    if not number > 0:
        raise InputError(f"{value} is not above zero", f"--{name}", "write a positive value")
    return number
