"""`feeddrive modes PLANT`: natural frequencies against the position of the table, motor held and free."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from feeddrive.cli.output import JsonOption, deliver_saved, warnings_as_lines
from feeddrive.interface.axis import load
from feeddrive.output_folder import refuse_unusable


def command(
    plant: Annotated[str, typer.Argument(help="Plant file, or the name of a shipped machine.")],
    at: Annotated[
        list[str] | None, typer.Option(help="Table position such as 250mm, or several; the stroke if left out.")
    ] = None,
    as_json: JsonOption = False,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for modes.json and the figure modes.png.")] = None,
) -> None:
    """Natural frequencies along the stroke, with the motor held by its brake or servo, and free."""
    refuse_unusable(out)
    with warnings_as_lines():
        found = load(plant).modes(at or None)
        deliver_saved(found, as_json, out)
