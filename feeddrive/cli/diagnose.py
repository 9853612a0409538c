"""`feeddrive diagnose`: find what a machine's model lacks."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def command(
    plant: Annotated[str, typer.Argument(help="Plant file, or the name of a shipped plant.")],
    recordings: Annotated[list[Path], typer.Argument(metavar="REC...", help="Recordings that are fitted.")],
    out: Annotated[Path, typer.Option("--out", help="Folder for the report and its files.")],
    validate: Annotated[
        list[Path] | None, typer.Option("--validate", help="Recording to judge on; may be given again.")
    ] = None,
    split: Annotated[float, typer.Option("--split", help="Share fitted where no --validate is given.")] = 0.75,
    mapping: Annotated[Path | None, typer.Option("--map", help="Mapping of a foreign file to channels.")] = None,
    decimal: Annotated[str | None, typer.Option("--decimal", help="Decimal sign of CSV files: '.' or ','.")] = None,
    simulate: Annotated[
        bool, typer.Option("--simulate", help="Add the closed-loop simulation error, where a controller is declared.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print diagnosis.json instead of the summary.")] = False,
) -> None:
    """Find what a machine's model lacks, from recordings of it, and report the error before and after."""
    from feeddrive.cli.diagnosing import Job, run_job
    from feeddrive.files import find_plant

    files = tuple(recordings), tuple(validate or ())
    run_job(Job(find_plant(plant), *files, out, split, mapping, decimal, simulate), as_json)
