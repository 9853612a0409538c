"""`feeddrive watch FOLDER --plant PLANT`: follow an axis over months of recordings."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from feeddrive.cli.output import JsonOption


def command(
    folder: Annotated[Path, typer.Argument(help="Folder that recordings are added to; archives in it are read too.")],
    plant: Annotated[str, typer.Option(help="Plant file, or the name of a shipped machine.")],
    out: Annotated[Path | None, typer.Option(help="Folder of the results; FOLDER_watch beside it if left out.")] = None,
    mapping: Annotated[Path | None, typer.Option("--map", help="Mapping file of foreign recordings.")] = None,
    decimal: Annotated[str, typer.Option(help="Decimal sign, where files do not tell.")] = "",
    stamp: Annotated[
        str, typer.Option(help="Pattern of the date in names, '%Y%m%d_%H%M'; content or name tell else.")
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
    from feeddrive.cli.following import Asked, follow_and_tell

    asked = Asked(
        folder, plant, out, mapping, decimal, stamp, every, first, tuple(absolute or ()), tuple(limit or ()), search,
        each, scheduler,
    )  # fmt: skip
    follow_and_tell(asked, as_json)
