"""The command line as the fuzz modules run it: in this process, quick, and silent of what is only unusual."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import matplotlib

os.environ["FEEDDRIVE_COMPILER"] = "none"  # a changed machine would be compiled for seconds
matplotlib.use("Agg")

from feeddrive.cli import output, running, sweeping  # noqa: E402
from feeddrive.cli.main import main  # noqa: E402
from feeddrive.errors import InputError  # noqa: E402

MOST_TICKS = 4000
"""Of a run; a longer one that is possible is cut, for interpreted it takes its time."""

MOST_RUNS = 3
"""Of a sweep."""

_run_scenario, _run_sweep = running.run_scenario, sweeping.run_sweep


def _short(scenario: Any, *others: Any) -> Any:
    return _run_scenario(replace(scenario, ticks=min(scenario.ticks, MOST_TICKS)), *others)


def _few(design: Any, *others: Any) -> Any:
    if len(design.rows) > MOST_RUNS:
        raise InputError(f"{len(design.rows)} runs", "fuzz", "it runs few")
    return _run_sweep(design, *others)


def command(arguments: Sequence[str]) -> int:
    """Run a command line; runs and sweeps are cut short, and what is merely unusual is not told."""
    running.run_scenario, sweeping.run_sweep = _short, _few
    output.tell = lambda warning: None
    return main(list(arguments))
