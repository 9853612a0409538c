"""`feeddrive sweep`: many runs of a scenario with varied values; one table and one figure."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from feeddrive.cli.output import deliver_saved, progress_bar
from feeddrive.errors import InputError
from feeddrive.interface.runs.sweep import sweep
from feeddrive.output_folder import refuse_unusable
from feeddrive.simulate.scenario.scenario_overrides import parse_overrides

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
    metrics: Annotated[
        list[str] | None, typer.Option("--metric", metavar="NAME", help="Shown in the figure; up to 4.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print results.json instead of the summary.")] = False,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for table and figure; resumes a sweep.")] = None,
) -> None:
    """Run a scenario over varied values: one table and one figure; a stopped sweep resumes with the same --out."""
    refuse_unusable(out)
    if scheduler and workers is not None:
        raise InputError("--workers and --scheduler are both given", "", "leave one of them out")
    with progress_bar(Path(scenario).stem) as bar:
        try:
            found = sweep(
                scenario,
                vary=[*(vary or []), *(more or [])],
                set=parse_overrides(settings or []),
                samples=samples,
                seed=seed,
                workers=workers,
                scheduler=scheduler,
                metrics=metrics or [],
                folder=out,
                progress=bar,
            )
        except KeyboardInterrupt:
            typer.echo("stopped; started again with the same --out it goes on", err=True)
            raise
    deliver_saved(found, as_json, out)
