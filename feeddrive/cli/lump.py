"""`feeddrive lump PLANT`: a machine described by its parts as the three inertias nearest to it at a table position."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table

from feeddrive.cli.output import JsonOption, deliver, table, warnings_as_lines
from feeddrive.errors import InputError
from feeddrive.files import find_plant, write_text_atomically
from feeddrive.plant.analysis.lumping import Lumped, lump
from feeddrive.plant.file.entries import read_toml
from feeddrive.plant.file.files import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.units.quantity import format_quantity, parse

_HEAT = "the [thermal] sections; temperatures are predicted with the file of the parts"


def command(
    plant: Annotated[str, typer.Argument(help="Plant file, or the name of a shipped machine.")],
    at: Annotated[str, typer.Option(help="Table position such as 250mm; the middle of the stroke if left out.")] = "",
    as_json: JsonOption = False,
    out: Annotated[Path | None, typer.Option("--out", help="Plant file to write, such as lumped.toml.")] = None,
) -> None:
    """Write a machine as three inertias: stiffness and inertia exactly, first resonances as near as three can be."""
    path = find_plant(plant)
    if out is not None and out.is_dir():
        raise InputError("is a folder, not a file", str(out), "name a file for --out, such as lumped.toml")
    if out is not None and out.resolve() == path.resolve():
        raise InputError("is the machine's own file", str(out), "name another file for --out")
    with warnings_as_lines():
        machine = read_plant(path)
        further = (_HEAT,) if "thermal" in read_toml(path, "plant file") else ()
        found = lump(machine, parse(at, "m", "--at") if at else machine.middle, further)
    if out is not None:
        write_text_atomically(out, found.text)
    deliver(_content(machine, found, out), _tables(machine, found, out), as_json, None)


def _content(plant: Plant, found: Lumped, out: Path | None) -> dict[str, Any]:
    """Everything, SI."""
    return {
        "format": "feeddrive-lumped/1",
        "name": plant.name,
        "position": found.position,
        "values": dict(found.plant.chain.values),
        "compared": [{**asdict(row), "error": row.error} for row in found.compared],
        "left_out": list(found.left_out),
        "file": str(out) if out is not None else None,
        "text": found.text,
    }


def _tables(plant: Plant, found: Lumped, out: Path | None) -> list[Table]:
    values = [
        [f"{value.section}.{value.section_key}", format_quantity(found.plant.chain.values[value.key], value.unit)]
        for value in found.plant.chain.known_values
    ]
    rows = [
        [row.name, format_quantity(row.machine, row.unit), format_quantity(row.lumped, row.unit), f"{row.error:+.2%}"]
        for row in found.compared
    ]
    at = format_quantity(found.position, "m")
    tables = [
        table(f"{plant.name} as three inertias, table at {at}", ("value", "quantity"), values),
        table("How near they are", ("figure", "machine", "three inertias", "error"), rows),
    ]
    if found.left_out:
        tables.append(table("Not in three inertias", ("what",), [[line] for line in found.left_out]))
    tables[-1].caption = f"Written to {out}." if out is not None else "Name a file with --out to write it."
    return tables
