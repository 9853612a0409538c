"""`feeddrive read FILE`: what a file of a drive, control or logger holds, and how it is understood."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from feeddrive.cli.output import JsonOption
from feeddrive.cli.read_file import Request, run


def command(
    file: Annotated[Path, typer.Argument(help="Trace file, recording or frequency response.", show_default=False)],
    mapping: Annotated[Path | None, typer.Option("--map", help="Mapping file, in place of what names tell.")] = None,
    axis: Annotated[str, typer.Option(help="Axis of a file that holds several, such as X1.")] = "",
    lead: Annotated[str, typer.Option(help="Lead, such as '10 mm': makes angles of motor encoders in mm.")] = "",
    channel: Annotated[
        list[str] | None,
        typer.Option(help="'motor_torque=NAME [N m]': which signal a channel is, and its unit; may come again."),
    ] = None,
    rate: Annotated[str, typer.Option(help="Rate to resample to, such as '1 kHz'; the slowest channel's else.")] = "",
    part: Annotated[int, typer.Option(help="Stretch between gaps, 1 for the first; the longest else.")] = 0,
    sample_time: Annotated[str, typer.Option(help="Distance of samples where the file has no time: '1 ms'.")] = "",
    columns: Annotated[str, typer.Option(help="Names of columns without any, between commas (halsampler).")] = "",
    decimal: Annotated[str, typer.Option(help="Decimal sign of a CSV file, where it cannot be told.")] = "",
    out: Annotated[
        Path | None,
        typer.Option(
            help="Canonical file to write, .csv or .csv.gz; NAME_map.toml, its mapping, is written beside it."
        ),
    ] = None,
    figure: Annotated[Path | None, typer.Option(help="Picture of a frequency response to write, .png.")] = None,
    as_json: JsonOption = False,
) -> None:
    """Show what a trace file holds: channels, units, rates, gaps, and which channel each signal is taken for, and why.

    TwinCAT Scope, TNCscope, SINUMERIK traces and Edge captures, halscope and halsampler, MATLAB, HDF5, TDMS, MDF4,
    Parquet and CSV are known by their content.
    """
    request = Request(file, mapping, axis, lead, tuple(channel or ()), rate, part, sample_time, columns, decimal, out,
                      figure)  # fmt: skip
    run(request, as_json)
