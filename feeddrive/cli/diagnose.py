"""`feeddrive diagnose`: find what a machine's model lacks."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from feeddrive.errors import InputError


def command(
    arguments: Annotated[
        list[str],
        typer.Argument(
            metavar="PLANT REC...",
            help="Plant file, or the name of a shipped plant; then the recordings that are fitted, oldest first, or "
            "one TOML file of measured numbers, or one frequency response. With --continue the plant may be left out.",
        ),
    ],
    out: Annotated[
        Path | None, typer.Option("--out", help="Folder for the report and its files; that of --continue if left out.")
    ] = None,
    validate: Annotated[
        list[Path] | None, typer.Option("--validate", help="Recording to judge on; may be given again.")
    ] = None,
    earlier: Annotated[
        Path | None, typer.Option("--continue", help="Folder of an earlier diagnosis that the recordings are added to.")
    ] = None,
    split: Annotated[
        float | None, typer.Option("--split", help="Share fitted where no --validate is given; 0.75 if left out.")
    ] = None,
    measured: Annotated[
        Path | None, typer.Option("--measured", help="File of numbers that were measured beside the recordings.")
    ] = None,
    mapping: Annotated[Path | None, typer.Option("--map", help="Mapping of a foreign file to channels.")] = None,
    decimal: Annotated[str | None, typer.Option("--decimal", help="Decimal sign of CSV files: '.' or ','.")] = None,
    simulate: Annotated[
        bool, typer.Option("--simulate", help="Simulate the closed loop where a controller is declared, and refine.")
    ] = False,
    at: Annotated[
        str, typer.Option("--at", help='Operating point of a frequency response, "x=200 mm,v=3 m/min".')
    ] = "",
    controller: Annotated[
        str | None, typer.Option("--controller", help="Controller file of a frequency response of the speed loop.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print diagnosis.json instead of the summary.")] = False,
) -> None:
    """Find what a machine's model lacks, from recordings of it, and report the error before and after."""
    from feeddrive.cli.explaining import are_no_recordings, explain_and_tell

    if earlier is None and are_no_recordings(arguments[1:]):
        if measured is not None:
            raise InputError("is for numbers beside recordings", "--measured", "name the file behind the plant")
        explain_and_tell(arguments[0], arguments[1], at, controller, out, as_json)
        return
    if controller is not None:
        what = "is for a frequency response, and recordings over time are given"
        raise InputError(what, "--controller", "leave it out; declare the controller in the plant file for --simulate")
    from feeddrive.cli.continuing import continued_job, first_job
    from feeddrive.cli.diagnosing import Options, run_job

    options = Options(out, tuple(validate or ()), split, mapping, decimal, simulate, measured)
    job = first_job(arguments, options) if earlier is None else continued_job(arguments, earlier, options)
    run_job(job, as_json)
