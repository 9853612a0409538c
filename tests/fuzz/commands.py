"""The command line as the fuzz modules run it: in this process, quick, and silent of what is only unusual."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import matplotlib
import scipy.integrate
import scipy.io
import scipy.optimize
import scipy.signal
import scipy.special  # noqa: F401

matplotlib.use("Agg")

from feeddrive.cli import output
from feeddrive.cli.main import COMMANDS, load, main
from feeddrive.engine import compiled
from feeddrive.errors import InputError
from feeddrive.interface.runs import scenario as running
from feeddrive.interface.runs import sweep as sweeping

MOST_TICKS = 4000
"""Of a run; a longer one that is possible is cut, for interpreted it takes its time."""

MOST_RUNS = 3
"""Of a sweep."""

for _name in COMMANDS:
    load(_name)  # so that no case is charged with the imports

_run_scenario, _run_sweep = running.run_scenario, sweeping.run_sweep


def _short(scenario: Any, *others: Any) -> Any:
    return _run_scenario(replace(scenario, ticks=min(scenario.ticks, MOST_TICKS)), *others)


def _few(design: Any, *others: Any) -> Any:
    if len(design.rows) > MOST_RUNS:
        raise InputError(f"{len(design.rows)} runs", "fuzz", "it runs few")
    return _run_sweep(design, *others)


def command(arguments: Sequence[str]) -> int:
    """Run a command line; runs and sweeps are cut short, and what is merely unusual is not told."""
    compiled.compiled_library = lambda *_: None  # a changed machine would be compiled for seconds
    running.run_scenario, sweeping.run_sweep = _short, _few
    output.tell = lambda line: None
    return main(list(arguments))
