"""Parts by their name: read from the files beside this module, once.

A file holds parts of one kind, maker and source; a `[[part]]` has a name, a size in words, what only the catalogue
needs (bore, rated power, preload), and one table per section of a plant file to which it gives values.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

from feeddrive.errors import InputError

KINDS = ("screw", "bearing", "guide", "coupling", "motor")
"""Kinds of parts, as `feeddrive parts` takes them."""

SECTIONS = {
    "ball_screw": "screw",
    "nut": "screw",
    "bearing": "bearing",
    "guide": "guide",
    "coupling": "coupling",
    "motor": "motor",
}
"""Section of a plant file to the kind of part that gives it values."""


@dataclass(frozen=True)
class CataloguePart:
    """One part of the catalogue.

    Attributes:
        name: unique, as plant files write it.
        kind: of `KINDS`.
        maker: who sells it.
        size: in words.
        source: document, table or page, as origins show it.
        address: where the document was read.
        sections: section of a plant file to its keys and values, as written.
        further: what else is printed: bore, rated power, ratings, preload.
    """

    name: str
    kind: str
    maker: str
    size: str
    source: str
    address: str
    sections: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    further: Mapping[str, Any] = field(default_factory=dict)

    @property
    def origin(self) -> str:
        """Name and source, as a value that is taken from it shows them."""
        return f"catalogue: {self.name}, {self.source}"


@lru_cache(maxsize=1)
def catalogue() -> Mapping[str, CataloguePart]:
    """Every part by its name, in the order of files and rows."""
    found: dict[str, CataloguePart] = {}
    for path in sorted(Path(__file__).parent.glob("*.toml")):
        for part in _parts(tomllib.loads(path.read_text(encoding="utf-8"))):
            assert part.name not in found, f"{path.name}: {part.name} occurs twice"
            found[part.name] = part
    return found


def find_part(name: str, kind: str, where: str, otherwise: str = "") -> CataloguePart:
    """The part of a name and a kind of `KINDS`; `otherwise` is what else may be done where there is none.

    The InputError names the nearest of that kind; `where` is file and key.
    """
    part = catalogue().get(name)
    if part is None:
        raise InputError(f'no {kind} "{name}" in the catalogue', where, _mend(name, kind, otherwise))
    if part.kind != kind:
        raise InputError(f"{name} is a {part.kind}, not a {kind}", where, _mend(name, kind, otherwise))
    return part


def nearest_names(name: str, kind: str, most: int = 4) -> list[str]:
    """Names of that kind that are nearest to a word."""
    from difflib import get_close_matches

    known = {one.name.casefold(): one.name for one in catalogue().values() if one.kind == kind}
    begins = [known[one] for one in known if name and one.startswith(name.casefold())]
    near = [known[one] for one in get_close_matches(name.casefold(), known, n=most, cutoff=0.3)]
    return list(dict.fromkeys([*begins, *near]))[:most]


def _mend(name: str, kind: str, otherwise: str) -> str:
    near = nearest_names(name, kind)
    guess = f"near are {', '.join(near)}" if near else ""
    return "; ".join(one for one in (guess, f"`feeddrive parts {kind}` lists all", otherwise) if one)


def _parts(content: Mapping[str, Any]) -> list[CataloguePart]:
    shared = {key: value for key, value in content.items() if key not in (*_OF_FILE, "part")}
    return [
        CataloguePart(
            row["name"],
            content["kind"],
            content["maker"],
            row["size"],
            content["source"],
            content["address"],
            {name: row[name] for name in SECTIONS if name in row},
            {**shared, **{key: value for key, value in row.items() if key not in (*SECTIONS, "name", "size")}},
        )
        for row in content["part"]
    ]


_OF_FILE = ("kind", "maker", "source", "address", "year")
