"""`feeddrive show PLANT`: values with their sources, stiffness budget, inertias, friction, modes, life."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table

from feeddrive.cli.output import JsonOption, chain_remark, deliver, finite, table, tell_written, warnings_as_lines
from feeddrive.cli.show_folder import is_folder, write_folder
from feeddrive.cli.show_heat import heat_content, heat_tables
from feeddrive.cli.show_life import life_content, life_table
from feeddrive.interface.axis import load
from feeddrive.output_folder import output_folder
from feeddrive.plant.analysis.modes import Modes
from feeddrive.plant.analysis.rated_life import LifeRow, rated_life
from feeddrive.plant.analysis.summary import Summary, summarise
from feeddrive.plant.plant import Plant
from feeddrive.units.quantity import format_quantity, parse

_KNOWN = ("motor", "screw", "axial", "table")


def command(
    plant: Annotated[str, typer.Argument(help="Plant file, or the name of a shipped machine.")],
    at: Annotated[str, typer.Option(help="Table position for stiffness and modes, such as 250mm.")] = "",
    as_json: JsonOption = False,
    out: Annotated[
        Path | None, typer.Option(help="Folder for show.json and figures, or a file such as axis.json or axis.txt.")
    ] = None,
) -> None:
    """Show a machine: values with their sources, stiffness budget, inertias, friction, modes, rated life."""
    with warnings_as_lines():
        axis = load(plant)
        if not axis.has_motion:
            deliver(heat_content(axis.heat), heat_tables(axis.heat), as_json, out)
            return
        machine = axis.plant
        summary = summarise(machine, parse(at, "m", "--at") if at else None)
        life = rated_life(machine)
        content = _content(machine, summary, life)
        if out is not None and is_folder(out):
            with output_folder(out) as folder:
                write_folder(machine, summary.position, content, folder)
    deliver(content, _tables(machine, summary, life), as_json, None if is_folder(out) else out)
    tell_written(out if is_folder(out) else None, as_json)


def _content(plant: Plant, summary: Summary, life: Sequence[LifeRow]) -> dict[str, Any]:
    """Everything as plain values, SI."""
    return {
        "format": "feeddrive-show/1",
        "name": plant.name,
        "structure": plant.chain.structure,
        "values": {
            key: {"value": value, "unit": unit, "source": source} for key, value, unit, source in _values(plant)
        },
        "parts": {
            key: {"value": datum.value, "unit": datum.unit, "source": plant.origins.get(key, "")}
            for key, datum in plant.data.items()
        },
        "position": summary.position,
        "inertia_at_motor": summary.inertia_at_motor,
        "mass_at_table": summary.mass_at_table,
        "inertias": [asdict(row) for row in summary.inertias],
        "stiffness": asdict(summary.stiffness) if summary.stiffness else None,
        "friction": [asdict(row) for row in summary.friction],
        "life": life_content(life),
        "modes": {
            "coordinates": list(summary.modes.coordinates),
            "braked": _modes_content(summary.modes.braked),
            "free": _modes_content(summary.modes.free),
            "chain_valid_to": finite(summary.modes.chain_valid_to),
        },
    }


def _modes_content(modes: Modes) -> dict[str, Any]:
    return {
        "frequencies": modes.frequencies.tolist(),
        "damping": modes.damping.tolist(),
        "shapes": modes.shapes.T.tolist(),
    }


def _values(plant: Plant) -> list[tuple[str, Any, str, str]]:
    """Key, SI value, unit and source of every value of chain and effects."""
    rows: list[tuple[str, Any, str, str]] = []
    for value in plant.chain.known_values:
        key = f"{value.section}.{value.section_key}"
        rows.append((key, plant.chain.values[value.key], value.unit, plant.origins.get(value.key, "")))
    if math.isfinite(plant.torque_limit):
        rows.append(("motor.torque_limit", plant.torque_limit, "N m", plant.origins.get("torque_limit", "")))
    for effect in plant.effects:
        for parameter in (p for p in effect.parameters if p.key in effect.values):
            key = f"{effect.label}.{parameter.key}"
            rows.append((key, effect.values[parameter.key], parameter.unit, plant.origins.get(key, "")))
    return rows


def _tables(plant: Plant, summary: Summary, life: Sequence[LifeRow]) -> list[Table]:
    values = [[key, _shown(value, unit), source] for key, value, unit, source in _values(plant)]
    at = f", table at {format_quantity(summary.position, 'm')}" if plant.chain.varies else ""
    tables = [
        table(f"{plant.name}, {plant.chain.structure}", ("value", "quantity", "source"), values),
        table("Parts as declared", ("part", "quantity", "source"), _part_rows(plant)),
        table(f"Inertia{at}", ("moves with", "at the motor", "at the table", "share"), _inertia_rows(summary)),
        table(f"Stiffness, motor held{at}", ("part", "felt at the table", "share of compliance"),
              _stiffness_rows(summary)),
        table("What constant motion takes in + and in − direction; signs are those of the axis",
              ("speed", "force +", "force −", "torque +", "torque −"), _friction_rows(summary)),
        _mode_table(plant, summary, at),
        life_table(life),
    ]  # fmt: skip
    for shown in tables:
        shown.columns[0].no_wrap = True  # names are searched for, so they stay in one piece
    return [shown for shown in tables if shown.row_count]


def _mode_table(plant: Plant, summary: Summary, at: str) -> Table:
    """Modes by the coordinates that people know; JSON has all modes and coordinates."""
    found = summary.modes
    names = found.coordinates
    kept = [i for i, name in enumerate(names) if name in _KNOWN]
    rows = [*_mode_rows("held", found.braked, kept), *_mode_rows("free", found.free, kept)]
    headings = ("motor is", "frequency", "damping", *(names[i] for i in kept))
    shown = table(f"Modes, in table travel{at}", headings, rows)
    shown.caption = chain_remark(found.chain_valid_to)
    return shown


def _part_rows(plant: Plant) -> list[list[str]]:
    return [
        [key, format_quantity(datum.value, datum.unit), plant.origins.get(key, "")] for key, datum in plant.data.items()
    ]


def _inertia_rows(summary: Summary) -> list[list[str]]:
    rows = [
        [row.coordinate.replace("_", " "), format_quantity(row.at_motor, "kg m^2"), format_quantity(row.at_table, "kg"),
         f"{row.share:.0%}"]
        for row in summary.inertias
    ]  # fmt: skip
    whole = [format_quantity(summary.inertia_at_motor, "kg m^2"), format_quantity(summary.mass_at_table, "kg")]
    return [*rows, ["all", *whole, "100%"]]


def _stiffness_rows(summary: Summary) -> list[list[str]]:
    budget = summary.stiffness
    if budget is None:
        return []
    parts = [
        [f"{part.part}, {part.deformation}", format_quantity(1 / part.compliance, "N/m"), f"{part.share:.1%}"]
        for part in budget.parts
    ]
    return [
        *parts,
        ["axial stiffness", format_quantity(budget.axial, "N/m"), f"{budget.axial_share:.0%}"],
        ["torsional stiffness at the table", format_quantity(budget.torsional, "N/m"), f"{budget.torsional_share:.0%}"],
        ["combined stiffness, motor held", format_quantity(budget.total, "N/m"), "100%"],
    ]


def _friction_rows(summary: Summary) -> list[list[str]]:
    return [
        [
            format_quantity(row.speed, "m/s"),
            format_quantity(row.force_forward, "N"),
            format_quantity(row.force_backward, "N"),
            format_quantity(row.torque_forward, "N m"),
            format_quantity(row.torque_backward, "N m"),
        ]
        for row in summary.friction
    ]


def _mode_rows(motor: str, modes: Modes, kept: Sequence[int]) -> list[list[str]]:
    columns = zip(modes.frequencies, modes.damping, modes.shapes.T[:, kept] + 0.0, strict=False)
    return [
        [motor, format_quantity(frequency, "Hz"), f"{damping:.2%}", *(f"{part:+.2f}" for part in shape)]
        for frequency, damping, shape in columns
    ]


def _shown(value: Any, unit: str) -> str:
    numbers = value if isinstance(value, tuple) else (value,)
    return ", ".join(format_quantity(number, unit) for number in numbers)
