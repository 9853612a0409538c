"""`feeddrive thermal PLANT`: how a machine warms up, and what that does to the position of its table."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from feeddrive.cli.output import (
    JsonOption,
    deliver_saved,
    warnings_as_lines,
    working,
)
from feeddrive.interface.axis import load
from feeddrive.interface.runs.warm_up import warm_up
from feeddrive.output_folder import refuse_unusable


def command(
    plant: Annotated[
        str, typer.Argument(help="Plant file with a [thermal] section, or the name of a shipped machine.")
    ],
    speed: Annotated[
        str | None, typer.Option(help='Constant speed of the screw, "750 rev/min"; half the highest if left out.')
    ] = None,
    duration: Annotated[str | None, typer.Option(help='"180 min", which is the default, or "6 h".')] = None,
    stroke: Annotated[
        str | None,
        typer.Option(help='Of the nut: "150 mm" about the middle of the declared travel, or "150 mm to 350 mm".'),
    ] = None,
    duty: Annotated[
        Path | None, typer.Option(help="CSV in place of a constant speed: time, screw_speed, ambient_temperature.")
    ] = None,
    within: Annotated[str, typer.Option(help="Error at the table up to which the machine counts as warm.")] = "1 µm",
    order: Annotated[int, typer.Option(help="States of the reduced model that is compared.", min=2, max=200)] = 36,
    segments: Annotated[int, typer.Option(help="Segments of the shaft in the network.", min=3, max=100)] = 10,
    as_json: JsonOption = False,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for thermal.json, recording.csv, figures.")] = None,
) -> None:
    """Warm a machine up: temperatures, error at the table, time constants, warm-up time, energy, network."""
    refuse_unusable(out)
    with warnings_as_lines():
        axis = load(plant)
        with working(f"warming {axis.name} up: full and reduced model"):
            found = warm_up(
                axis,
                duty,
                speed=speed,
                duration=duration,
                within=within,
                order=order,
                stroke=None if stroke is None else [one.strip() for one in stroke.split(" to ")],
                segments=segments,
            )
    deliver_saved(found, as_json, out)
