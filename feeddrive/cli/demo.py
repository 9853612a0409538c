"""`feeddrive demo`: the main job on a shipped machine and a shipped recording."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from feeddrive.cli.diagnose import diagnose_and_print
from feeddrive.files import find_plant, find_scenario_file
from feeddrive.interface.measured.diagnosis_run import Job, Source


def command(
    out: Annotated[Path, typer.Option("--out", help="Folder for the report.")] = Path("feeddrive-demo"),
) -> None:
    """Diagnose a shipped machine from a shipped recording, and say where the report is."""
    recording = find_scenario_file("recordings/demo.csv.gz")
    diagnose_and_print(Job(find_plant("bench_axis"), (Source(recording),), (), out))
