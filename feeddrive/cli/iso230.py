"""`feeddrive iso230 FILE`: accuracy of an axis after ISO 230 from readings or a recording."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from feeddrive.cli.output import (
    JsonOption,
    deliver_saved,
    warnings_as_lines,
)
from feeddrive.interface.axis import load
from feeddrive.interface.measured.iso230 import iso230
from feeddrive.output_folder import refuse_unusable


def command(
    files: Annotated[
        list[Path],
        typer.Argument(help="Table of a laser's or ball-bar's readings, or a recording with a scale; two of a circle."),
    ],
    plant: Annotated[str, typer.Option(help="Machine: what of E, M and B it explains, and by which effect.")] = "",
    part: Annotated[int, typer.Option(help="2 positioning, 3 drift, 4 circle; else taken from the columns.")] = 0,
    radius: Annotated[str, typer.Option(help="Nominal radius of a circle, '150 mm'.")] = "",
    stop: Annotated[str, typer.Option(help="When the axis stops in a test of drift, '4 h'.")] = "",
    mapping: Annotated[Path | None, typer.Option("--map", help="Mapping file of a foreign recording.")] = None,
    decimal: Annotated[str, typer.Option(help="Decimal sign, where the file leaves it open.")] = "",
    as_json: JsonOption = False,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for report.html, iso230.json, figures.")] = None,
) -> None:
    """Evaluate a measured test: -2 positioning (A, E, M, R, B), -3 drift of a warm-up, -4 circle (G, F, glitches).

    Columns of tables: target with up 1, down 1, up 2, ... (or direction and deviation); time with at 0 mm, at 250 mm,
    ...; angle with radius or radial; x and y. Units stand in the headings, as in "target [mm],up 1 [µm]".
    """
    refuse_unusable(out)
    with warnings_as_lines():
        found = iso230(
            list(files),
            plant=load(plant) if plant else None,
            part=part or None,
            radius=radius or None,
            stop=stop or None,
            map=mapping,
            decimal=decimal or None,
        )
        deliver_saved(found, as_json, out)
