"""`feeddrive keys [plant.ball_screw]`: what may stand in a file, as its reader declares it."""

from __future__ import annotations

from typing import Annotated

import typer

from feeddrive.cli.output import JsonOption, OutOption, deliver, tables_of
from feeddrive.interface.keys import keys


def command(
    path: Annotated[
        str, typer.Argument(help="File, section or key, such as plant.ball_screw or controller.filter.notch.")
    ] = "",
    as_json: JsonOption = False,
    out: OutOption = None,
) -> None:
    """Show the keys of a file: meaning, unit, range, default, and whether they are required."""
    found = keys(path)
    listing = found.listing()
    content = {"format": "feeddrive-keys/1", "path": found.path, "meaning": found.meaning, "keys": listing.records}
    deliver(content, tables_of([listing]), as_json, out)
