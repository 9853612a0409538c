"""`feeddrive compensate SOURCE`: tables against lead errors, backlash and heat, in the form that a control reads."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from feeddrive.cli.output import JsonOption, escaped, print_written, tables_of, warnings_as_lines
from feeddrive.errors import InputError, printable
from feeddrive.interface.compensating import compensate
from feeddrive.interface.measured.reading import read


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
    if out is not None and out.is_dir():
        raise InputError("is a folder", str(out), "name a file, such as --out enc_comp.ini")
    if bool(start) != bool(end):
        raise InputError("--from and --to belong together", "", 'write both, such as --from "0 mm" --to "500 mm"')
    with warnings_as_lines(), Console(stderr=True).status("simulating"):
        done = compensate(
            source if mapping is None else read(source, mapping),
            form,
            every=every or None,
            reference=reference or None,
            stroke=(start, end) if start else None,
            axis=axis,
            controller=controller or None,
            lead=lead or None,
            resolution=resolution or None,
        )
        if figure is not None:
            done.save_figure(figure)
        if out is not None:
            done.save(out)
    if as_json:
        typer.echo(escaped(json.dumps(done.record(), indent=2, ensure_ascii=False)))
        return
    console = Console(soft_wrap=True, highlight=False, markup=False, emoji=False)
    if out is None:
        console.print(escaped(done.text), end="")
        return
    console.print(*tables_of([done.listing()]))
    for line in done.left:
        console.print(f"left: {printable(line)}")
    print_written(out, False)
    typer.echo(f"its sheet: {printable(str(out.resolve()))}.txt")
