"""`feeddrive run`: run a scenario, write its recording, figures and metrics."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from feeddrive.cli.output import deliver_saved, progress_bar, warnings_as_lines
from feeddrive.interface.runs.scenario import run
from feeddrive.output_folder import refuse_unusable
from feeddrive.simulate.scenario.scenario_overrides import parse_overrides

CHECKPOINT = "checkpoint.npz"


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
    refuse_unusable(out)
    with warnings_as_lines(), progress_bar(Path(scenario).stem) as bar:
        found = run(
            scenario,
            set=parse_overrides(settings or []),
            checkpoint=None if out is None else out / CHECKPOINT,
            progress=None if bar is None else lambda share: bar(share, 1.0),
        )
    deliver_saved(found, as_json, out)
