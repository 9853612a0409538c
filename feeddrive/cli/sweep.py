"""`feeddrive sweep`: many runs of a scenario with varied values; one table and one figure."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

_EXAMPLE = '"controller.position_gain=40:80:9 1/s"'


def command(
    scenario: Annotated[str, typer.Argument(help="Scenario file, or the name of a shipped scenario.")],
    more: Annotated[list[str] | None, typer.Argument(metavar="[KEY=VALUES]...", help="More of --vary.")] = None,
    vary: Annotated[
        list[str] | None,
        typer.Option("--vary", metavar="KEY=VALUES", help=f"first:last:points, v1,v2,v3 or low~high: {_EXAMPLE}."),
    ] = None,
    settings: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Value for all runs, as of `feeddrive run`.")
    ] = None,
    samples: Annotated[int | None, typer.Option(help="Samples of the random ranges low~high.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of the random ranges.")] = 0,
    workers: Annotated[int | None, typer.Option(help="Processes of this computer; all processors if left out.")] = None,
    scheduler: Annotated[str, typer.Option(metavar="ADDRESS", help="Dask scheduler, tcp://host:8786.")] = "",
    metric: Annotated[list[str] | None, typer.Option(metavar="NAME", help="Shown in the figure; up to 4.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print results.json instead of the summary.")] = False,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for table and figure; resumes a sweep.")] = None,
) -> None:
    """Run a scenario over varied values: one table and one figure; a stopped sweep resumes with the same --out."""
    from feeddrive.cli.sweeping import Wanted, sweep_and_tell

    wanted = Wanted(
        scenario, [*(vary or []), *(more or [])], settings or [], samples, seed, workers, scheduler, metric or [],
        as_json, out,
    )  # fmt: skip
    sweep_and_tell(wanted)
