"""`feeddrive show PLANT`: values with their sources, stiffness budget, inertias, friction, modes, life."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from feeddrive.cli.output import JsonOption, deliver, print_written, tables_of, warnings_as_lines
from feeddrive.interface.axis import load
from feeddrive.output_folder import output_folder


def command(
    plant: Annotated[str, typer.Argument(help="Plant file, or the name of a shipped machine.")],
    at: Annotated[str, typer.Option(help="Table position for stiffness and modes, such as 250mm.")] = "",
    recording: Annotated[
        Path | None, typer.Option(help="Recording with the motor angle: what it takes of the life of each nut.")
    ] = None,
    as_json: JsonOption = False,
    out: Annotated[
        Path | None, typer.Option(help="Folder for show.json and figures, or a file such as axis.json or axis.txt.")
    ] = None,
) -> None:
    """Show a machine: values with their sources, stiffness budget, inertias, friction, modes, rated life, heat.

    With --recording also the life that it takes from each nut. Into a folder (--out) come figures of the stiffness,
    the efficiency of the screw, the guide and the life, as far as the file declares what they need.
    """
    with warnings_as_lines():
        found = load(plant).summary(at or None, recording)
        tables = tables_of(found.tables())
        for one in tables:
            one.columns[0].no_wrap = True  # names are searched for, so they stay in one piece
        into = out if out is not None and (out.is_dir() or not out.suffix) else None
        if into is not None:
            with output_folder(into) as folder:
                found.save(folder)
    deliver(found.record(), tables, as_json, None if into else out)
    print_written(into, as_json)
    if into and not as_json:
        for line in found.not_drawn:
            typer.echo(f"not drawn: {line}")
