"""What `feeddrive watch` does: follow the folder, write the files, print the findings."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console

from feeddrive.cli.output import escaped, table, warnings_as_lines
from feeddrive.errors import InputError, printable
from feeddrive.interface.axis import load
from feeddrive.interface.fleet import OVERVIEW, Fleet, watch_fleet
from feeddrive.interface.watching import watch
from feeddrive.report.words.trend_words import shown_quantities


@dataclass(frozen=True)
class Asked:
    """What was typed, as typed; empty where nothing was."""

    folder: Path
    plant: str
    out: Path | None
    mapping: Path | None
    decimal: str
    stamp: str
    every: str
    first: str
    absolute: tuple[str, ...]
    limit: tuple[str, ...]
    search: bool
    each: bool = False
    scheduler: str = ""


def follow_and_tell(asked: Asked, as_json: bool) -> None:
    """Follow the folder, write the results beside it, and print the findings or the JSON.

    Raises:
        InputError: a folder, a plant or an option that cannot be used.
    """
    if asked.scheduler and not asked.each:
        raise InputError("a cluster follows several axes", "--scheduler", "say --each, with a folder for each axis")
    options: dict[str, Any] = {
        "map": asked.mapping, "decimal": asked.decimal or None, "stamp": asked.stamp, "every": asked.every or None,
        "first": asked.first, "absolute": asked.absolute, "limits": dict(map(_limit, asked.limit)),
        "search": asked.search,
    }  # fmt: skip
    with warnings_as_lines(), Console(stderr=True).status("looking into the folder") as status:

        def said(text: str) -> None:
            status.update(printable(text))

        if asked.each:
            fleet = watch_fleet(
                asked.folder, asked.plant, out=asked.out, scheduler=asked.scheduler, progress=said, **options
            )
            _tell_fleet(fleet, as_json)
            return
        found = watch(asked.folder, load(asked.plant), out=asked.out, progress=said, **options)
        place = found.save()
    if as_json:
        print(escaped(json.dumps(found.record(), indent=2, ensure_ascii=False)))
        return
    console = Console(soft_wrap=True, highlight=False)
    console.print(printable(found.verdict), markup=False)
    listing = found.listing()
    rows = [[one.name, *row[1:5]] for one, row in zip(shown_quantities(found.trend), listing.rows, strict=True)]
    console.print(table(listing.title, listing.headings[:5], rows), markup=False)
    for note in found.trend.notes:
        console.print(printable(note), markup=False)
    waiting = sum(one.status != "used" for one in found.trend.entries)
    if waiting:
        console.print(f"{waiting} files are not used; trend.html says why", markup=False)
    console.print(f"page: {printable(str((place / 'trend.html').resolve()))}", markup=False)


def _tell_fleet(fleet: Fleet, as_json: bool) -> None:
    if as_json:
        print(escaped((fleet.out / OVERVIEW).read_text(encoding="utf-8")), end="")
        return
    console = Console(soft_wrap=True, highlight=False)
    listing = fleet.listing()
    rows = [[printable(cell) for cell in row] for row in listing.rows]
    console.print(table(listing.title, listing.headings, rows), markup=False)
    console.print(f"pages: {printable(str(fleet.out))}, trend.html in the folder of each axis", markup=False)


def _limit(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals or not name.strip() or not value.strip():
        raise InputError(f'"{text}" is no limit', "--limit", "write it as 'play=10 µm' or 'coulomb=20 %'")
    return name.strip(), value.strip()
