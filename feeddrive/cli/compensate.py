"""`feeddrive compensate SOURCE`: tables against lead errors, backlash and heat, in the form that a control reads."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from feeddrive.cli.output import JsonOption


def command(
    source: Annotated[
        str,
        typer.Argument(
            metavar="DIAGNOSIS|PLANT|RECORDING",
            help="Folder of a diagnosis, plant file with what was found, or recording with a scale.",
        ),
    ],
    form: Annotated[
        str,
        typer.Option(
            help="linuxcnc, sinumerik-enc, sinumerik-cec, sinumerik-temp, isg, heidenhain-csv, fanuc-parameters, csv."
        ),
    ] = "csv",
    every: Annotated[str, typer.Option(help="Distance of the points, such as 10mm; chosen if left out.")] = "",
    reference: Annotated[str, typer.Option(help="Where the axis is referenced; P0 of sinumerik-temp.")] = "",
    start: Annotated[str, typer.Option("--from", help="Least position; that of the stroke if left out.")] = "",
    end: Annotated[str, typer.Option("--to", help="Greatest position; that of the stroke if left out.")] = "",
    axis: Annotated[str, typer.Option(help="Name of the axis in the control.")] = "X",
    controller: Annotated[
        str, typer.Option(help="Controller or scenario file for the prediction; recommended if left out.")
    ] = "",
    lead: Annotated[str, typer.Option(help="Nominal travel per motor revolution, for recordings.")] = "",
    resolution: Annotated[str, typer.Option(help="Step of a value in the control, such as 0.1um.")] = "",
    mapping: Annotated[Path | None, typer.Option("--map", help="Mapping of a foreign recording to channels.")] = None,
    figure: Annotated[Path | None, typer.Option(help="PNG of the circle, or of the deviations.")] = None,
    as_json: JsonOption = False,
    out: Annotated[
        Path | None, typer.Option("--out", help="File for the control; its sheet is written beside it as FILE.txt.")
    ] = None,
) -> None:
    """Write a compensation table as a control reads it: sign rule, check of one point, what it brings, what is left."""
    from feeddrive.cli.compensating import Request, run

    ends = (start, end)
    run(
        Request(source, form, every, reference, ends, axis, controller, lead, resolution, mapping, figure), as_json, out
    )
