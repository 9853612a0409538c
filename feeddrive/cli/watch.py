"""`feeddrive watch FOLDER --plant PLANT`: follow an axis over months of recordings."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from feeddrive.cli.output import JsonOption, escaped, table, warnings_as_lines
from feeddrive.errors import InputError, printable
from feeddrive.interface.axis import load
from feeddrive.interface.measured.fleet import OVERVIEW, Fleet, watch_fleet
from feeddrive.interface.measured.watching import watch
from feeddrive.report.words.trend_words import shown_quantities


def command(
    folder: Annotated[Path, typer.Argument(help="Folder that recordings are added to; archives in it are read too.")],
    plant: Annotated[str, typer.Option(help="Plant file, or the name of a shipped machine.")],
    out: Annotated[Path | None, typer.Option(help="Folder of the results; FOLDER_watch beside it if left out.")] = None,
    mapping: Annotated[Path | None, typer.Option("--map", help="Mapping file of foreign recordings.")] = None,
    decimal: Annotated[str, typer.Option(help="Decimal sign, where files leave it open.")] = "",
    stamp: Annotated[
        str, typer.Option(help="Pattern of the date in names, '%Y%m%d_%H%M'; else taken from content or name.")
    ] = "",
    every: Annotated[str, typer.Option(help="Distance of recordings without dates, '1 day', in order of names.")] = "",
    first: Annotated[str, typer.Option(help="Date of the first of them, '2026-01-31 06:00'.")] = "",
    absolute: Annotated[
        list[str] | None,
        typer.Option(help="Channel that keeps its zero, table_position: an offset that moves is growth then."),
    ] = None,
    limit: Annotated[
        list[str] | None,
        typer.Option(help="What a quantity may move by: 'play=10 µm', 'coulomb=20 %'; again for others."),
    ] = None,
    search: Annotated[bool, typer.Option(help="Diagnose what is before and after each change; takes minutes.")] = False,
    each: Annotated[
        bool, typer.Option(help="Every folder in FOLDER is an axis of its own; a plant.toml in it is its plant.")
    ] = False,
    scheduler: Annotated[
        str, typer.Option(metavar="ADDRESS", help="Dask scheduler that follows the axes of --each, tcp://host:8786.")
    ] = "",
    as_json: JsonOption = False,
) -> None:
    """Say what changed on an axis, since when, at what odds; what is new in the folder costs seconds.

    Writes trend.html, trend.json, trend.csv and the figures, and keeps what it knows there for the next time.
    """
    if scheduler and not each:
        raise InputError("a cluster follows several axes", "--scheduler", "say --each, with a folder for each axis")
    options: dict[str, Any] = {
        "map": mapping,
        "decimal": decimal or None,
        "stamp": stamp,
        "every": every or None,
        "first": first,
        "absolute": tuple(absolute or ()),
        "limits": dict(map(_limit, limit or ())),
        "search": search,
    }
    with warnings_as_lines(), Console(stderr=True).status("looking into the folder") as status:

        def progress(text: str) -> None:
            status.update(printable(text))

        if each:
            fleet = watch_fleet(folder, plant, out=out, scheduler=scheduler, progress=progress, **options)
            _print_fleet(fleet, as_json)
            return
        found = watch(folder, load(plant), out=out, progress=progress, **options)
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


def _limit(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals or not name.strip() or not value.strip():
        raise InputError(f'"{text}" is no limit', "--limit", "write it as 'play=10 µm' or 'coulomb=20 %'")
    return name.strip(), value.strip()


def _print_fleet(fleet: Fleet, as_json: bool) -> None:
    if as_json:
        print(escaped((fleet.out / OVERVIEW).read_text(encoding="utf-8")), end="")
        return
    console = Console(soft_wrap=True, highlight=False)
    listing = fleet.listing()
    rows = [[printable(cell) for cell in row] for row in listing.rows]
    console.print(table(listing.title, listing.headings, rows), markup=False)
    console.print(f"pages: {printable(str(fleet.out))}, trend.html in the folder of each axis", markup=False)
