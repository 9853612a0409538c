"""`feeddrive read FILE`: what a file of a drive, control or logger holds, and how it is understood."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from feeddrive.cli.output import JsonOption, deliver, parts_of, tables_of
from feeddrive.errors import InputError
from feeddrive.interface.measured.inspected import refuse_ending
from feeddrive.interface.measured.inspection import inspect
from feeddrive.interface.shown import Listing


def command(
    file: Annotated[Path, typer.Argument(help="Trace file, recording or frequency response.", show_default=False)],
    mapping: Annotated[Path | None, typer.Option("--map", help="Mapping file, in place of the names.")] = None,
    axis: Annotated[str, typer.Option(help="Axis of a file that holds several, such as X1.")] = "",
    lead: Annotated[str, typer.Option(help="Lead, such as '10 mm': makes angles of motor encoders in mm.")] = "",
    channels: Annotated[
        list[str] | None,
        typer.Option(
            "--channel", help="'motor_torque=NAME [N m]': which signal a channel is, and its unit; may come again."
        ),
    ] = None,
    rate: Annotated[str, typer.Option(help="Rate to resample to, such as '1 kHz'; the slowest channel's else.")] = "",
    part: Annotated[int, typer.Option(help="Stretch between gaps, 1 for the first; the longest else.")] = 0,
    sample_time: Annotated[str, typer.Option(help="Distance of samples where the file has no time: '1 ms'.")] = "",
    columns: Annotated[str, typer.Option(help="Names of columns without any, between commas (halsampler).")] = "",
    decimal: Annotated[str, typer.Option(help="Decimal sign of a CSV file, where it leaves it open.")] = "",
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
    if out is not None:
        refuse_ending(out)
    found = inspect(
        file,
        mapping,
        axis=axis,
        lead=lead or None,
        channels=_channels(channels or []),
        rate=rate or None,
        part=part or None,
        sample_time=sample_time or None,
        columns=parts_of(columns),
        decimal=decimal or None,
    )
    written = []
    if figure is not None:
        written.append(found.save_figure(figure))
    if out is not None:
        written = [*found.save(out), *written]
    *tables, last = found.tables()
    if written:
        lines = [["written", str(path)] for path in written]
        more = replace(last, rows=[*last.rows, *lines]) if not last.headings else Listing("", (), lines)
        tables, last = ([*tables] if not last.headings else [*tables, last]), more
    deliver(found.record() | {"written": [str(path) for path in written]}, tables_of([*tables, last]), as_json, None)


def _channels(texts: list[str]) -> dict[str, str]:
    found = {}
    for text in texts:
        channel, separator, rest = text.partition("=")
        if not separator or not rest.strip():
            raise InputError(f'"{text}" says no channel', "--channel", "write --channel 'motor_torque=NAME [N m]'")
        found[channel.strip()] = rest.strip()
    return found
