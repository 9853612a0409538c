"""`feeddrive bench PLANT`: a page with sliders for gains, filters, position, payload and effects."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def command(
    plant: Annotated[str, typer.Argument(help="Plant file, folder of a diagnosis, or the name of a shipped machine.")],
    diagnosis: Annotated[
        Path | None, typer.Option(help="Folder of a diagnosis: the plant as diagnosed, its effects first.")
    ] = None,
    scenario: Annotated[
        str, typer.Option(help="Scenario or controller file with the settings at the start; tuned if left out.")
    ] = "",
    payload: Annotated[str, typer.Option(help="Largest mass on the table that can be chosen.")] = "100 kg",
    out: Annotated[Path | None, typer.Option("--out", help="The page, such as bench.html.")] = None,
) -> None:
    """Write a page on which the axis can be tried: loops with margins, step and circle follow the sliders, offline."""
    from feeddrive.cli.output import print_written, warnings_as_lines
    from feeddrive.errors import InputError
    from feeddrive.files import find_plant
    from feeddrive.interface.axis import load
    from feeddrive.interface.benching import bench

    if out is None:
        raise InputError("--out is missing", "", "give a file for the page, such as --out bench.html")
    if out.is_dir():
        raise InputError("is a folder, not a file", str(out), "name a file for the page, such as --out bench.html")
    with warnings_as_lines():
        axis = load(find_plant(plant))
        bench(axis, controller=scenario or None, diagnosis=diagnosis, payload=payload).save(out)
    print_written(out, False)
