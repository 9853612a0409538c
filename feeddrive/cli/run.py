"""`feeddrive run`: run a scenario, write its recording, figures and metrics."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def command(
    scenario: Annotated[str, typer.Argument(help="Scenario file, or the name of a shipped scenario.")],
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help='Value in place of the file\'s, "trajectory.dwell=1 s".'),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print metrics.json instead of the summary.")] = False,
    out: Annotated[
        Path | None, typer.Option("--out", help="Folder for recording, figures and metrics; a stopped run resumes.")
    ] = None,
) -> None:
    """Run a scenario: the plant under its controller; following error, settling and what else the scenario asks for."""
    from feeddrive.cli.running import run_and_tell

    run_and_tell(scenario, settings or [], as_json, out)
