"""Texts of the pages that are written from the package: commands, interface, files, scenarios."""

from __future__ import annotations

import inspect
import os
import re
from collections.abc import Sequence
from pathlib import Path
from unittest.mock import patch

import feeddrive as fd
from feeddrive.cli.main import COMMANDS, load

ROOT = Path(__file__).resolve().parents[2]
HELP_WIDTH = 80

EFFECTS = "plant.effect."
"""Beginning of the sections of effects."""

GROUPS = {
    "An axis": ("load", "Axis", "effect", "Effect", "list_plants", "list_effects", "list_scenarios"),
    "Under its controller": ("tune", "Servo", "run", "Run", "sweep", "Sweep"),
    "Recordings": ("read", "Recording", "diagnose", "Diagnosed", "explain", "Explained"),
    "Answers of an axis": ("Modes", "Stiffness", "Check", "Life", "UsedLife", "Bode"),
    "Heat": ("warm_up", "WarmUp"),
    "Units and errors": ("si", "InputError", "ValidityWarning"),
}
"""Headings of the reference of the interface; a name that is not listed comes under the last one."""
FURTHER = "Further names"


def commands_page() -> str:
    """Every command with its `--help`."""
    parts = [
        "# Commands\n",
        "A command ends with status 0, or with 2 and one line: what is wrong, where, and the remedy. `--json` prints "
        "what was found for programs, in SI units; `--out` says where files and figures go.\n",
    ]
    for name, entry in COMMANDS.items():
        command = load(name)
        width = patch.dict(os.environ, COLUMNS=str(HELP_WIDTH))  # no longer than for this: other output has its own
        with width, command.make_context(name, [], resilient_parsing=True) as context:
            context.info_name = f"feeddrive {name}"
            context.terminal_width = context.max_content_width = HELP_WIDTH
            text = command.get_help(context)
        parts.append(f"## `{name}`\n\n{entry.summary}\n\n```text\n{text.strip()}\n```\n")
    return "\n".join(parts)


def interface_page() -> str:
    """Every public name with its documentation."""
    listed = {name for names in GROUPS.values() for name in names}
    groups = {**GROUPS, FURTHER: tuple(n for n in fd.__all__ if n not in listed and n != "__version__")}
    parts = [
        "# Python interface\n",
        "`import feeddrive as fd`; these names, and nothing else, are the interface. [As a library](../../python.md) "
        "shows them at work.\n",
    ]
    for words, names in groups.items():
        present = [name for name in names if name in fd.__all__]
        if present:
            parts += [f"## {words}\n", "```{eval-rst}", *map(_documented, present), "```\n"]
    return "\n".join(parts)


def _documented(name: str) -> str:
    value = getattr(fd, name)
    if inspect.isclass(value):
        bases = "\n   :no-members:" if issubclass(value, Exception) else ""
        return f".. autoclass:: feeddrive.{name}{bases}\n"
    return f".. autofunction:: feeddrive.{name}\n"


def files_page() -> str:
    """The files that people write: their keys where the package lists them, and those that are shipped, whole."""
    parts = [
        "# Files\n",
        "All are TOML: data, nothing in it is evaluated. A dimensional value is a string with its unit; a bare number "
        "is refused with the unit that it needs, an unknown key with the nearest known one.\n",
    ]
    if hasattr(fd, "keys"):
        parts += ["## Keys\n", "`feeddrive keys plant.ball_screw` prints the same.\n", *keys_of("")]
    parts.append(
        "## Shipped files, whole\n\nThe comments say what each key is. Take the nearest and change the numbers.\n"
    )
    for words, path in {
        "Machine on three inertias": "plants/bench_axis.toml",
        "Machine of parts": "plants/kimm_testbed.toml",
        "Machine with belt, brake and counterbalance": "plants/vertical_axis.toml",
        "One mass, with its controller": "plants/emps.toml",
        "Heat alone": "plants/thermal_bench.toml",
        "Motion and heat": "plants/warm_axis.toml",
        "Mapping of a foreign file": "plants/emps_map.toml",
        "Controller": "scenarios/controllers/bench_axis.toml",
        "Scenario": "scenarios/circular_test.toml",
        "Measured numbers": "scenarios/measured/kimm_testbed.toml",
    }.items():
        text = (ROOT / path).read_text(encoding="utf-8")
        parts.append(f"### {words}\n\n`{path}`\n\n```toml\n{text.strip()}\n```\n")
    return "\n".join(parts)


def keys_of(path: str) -> list[str]:
    """Tables of the keys of a section and of the sections inside it; effects have pages of their own."""
    found = fd.keys(path)
    listing = found.listing()
    rows = [row for row, record in zip(listing.rows, listing.records, strict=True) if "key" in record]
    parts = [f"### `{path}`\n", f"{found.meaning}\n"] if path else []
    if rows:
        # the meaning, which comes last in a terminal, stands beside the key: a narrow page shows both
        parts += [_row(_meaning_second(listing.headings)), _row(["---"] * len(listing.headings))]
        parts += [_row(_meaning_second([f"`{row[0]}`", *row[1:]])) for row in rows]
        parts.append("")
    inside = [one for one in found.sections if one != path and not one.startswith(EFFECTS)]
    return [*parts, *(line for one in inside for line in keys_of(one))]


def _meaning_second(cells: Sequence[str]) -> list[str]:
    return [cells[0], cells[-1], *cells[1:-1]]


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(str(cell).replace('|', chr(92) + '|') for cell in cells)} |"


def scenarios_page() -> str:
    """The page on scenarios stands beside them."""
    text = (ROOT / "scenarios" / "README.md").read_text(encoding="utf-8")
    return re.sub(r"\]\((?!https?:|#)([^)]+)\)", r"](../../../scenarios/\1)", text)
