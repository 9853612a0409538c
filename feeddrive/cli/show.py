"""`feeddrive show PLANT`: values with their sources, stiffness budget, inertias, friction, modes."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Annotated, Any

import typer
from rich.table import Table

from feeddrive.cli.output import JsonOption, OutOption, deliver, table, warnings_as_lines
from feeddrive.files import find_plant
from feeddrive.plant.files import read_plant, section_key
from feeddrive.plant.modes import Modes
from feeddrive.plant.plant import Plant
from feeddrive.plant.summary import Summary, summarise
from feeddrive.quantity import format_quantity


def command(
    plant: Annotated[str, typer.Argument(help="Plant file, or the name of a shipped machine.")],
    as_json: JsonOption = False,
    out: OutOption = None,
) -> None:
    """Show a machine: values with their sources, stiffness budget, inertias, friction, modes."""
    with warnings_as_lines():
        machine = read_plant(find_plant(plant))
        summary = summarise(machine)
    deliver(_content(machine, summary), _tables(machine, summary), as_json, out)


def _content(plant: Plant, summary: Summary) -> dict[str, Any]:
    """Everything as plain values, SI."""
    return {
        "format": "feeddrive-show/1",
        "name": plant.name,
        "structure": plant.chain.structure,
        "values": {
            key: {"value": value, "unit": unit, "source": source} for key, value, unit, source in _values(plant)
        },
        "inertia_at_motor": summary.inertia_at_motor,
        "mass_at_table": summary.mass_at_table,
        "stiffness": asdict(summary.stiffness) if summary.stiffness else None,
        "friction": [asdict(row) for row in summary.friction],
        "modes": {"braked": _modes_content(summary.braked), "free": _modes_content(summary.free)},
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
    for value in plant.chain.required:
        key = f"{value.section}.{section_key(value)}"
        rows.append((key, plant.chain.values[value.key], value.unit, plant.origins.get(value.key, "")))
    if math.isfinite(plant.torque_limit):
        rows.append(("motor.torque_limit", plant.torque_limit, "N m", plant.origins.get("torque_limit", "")))
    for effect in plant.effects:
        for parameter in (p for p in effect.parameters if p.key in effect.values):
            key = f"{effect.label}.{parameter.key}"
            rows.append((key, effect.values[parameter.key], parameter.unit, plant.origins.get(key, "")))
    return rows


def _tables(plant: Plant, summary: Summary) -> list[Table]:
    values = [[key, _shown(value, unit), source] for key, value, unit, source in _values(plant)]
    return [
        table(f"{plant.name}, {plant.chain.structure}", ("value", "quantity", "source"), values),
        table("Inertia and stiffness", ("figure", "quantity", "share of compliance"), _stiffness_rows(summary)),
        table("Constant motion, + along + motion", ("speed", "force +", "force −", "torque +", "torque −"),
              _friction_rows(summary)),
        table("Modes of the chain, in table travel", ("motor", "frequency", "damping", *plant.chain.coordinates),
              [*_mode_rows("held", summary.braked), *_mode_rows("free", summary.free)]),
    ]  # fmt: skip


def _stiffness_rows(summary: Summary) -> list[list[str]]:
    rows = [
        ["moving inertia at the motor", format_quantity(summary.inertia_at_motor, "kg m^2"), ""],
        ["moving mass at the table", format_quantity(summary.mass_at_table, "kg"), ""],
    ]
    budget = summary.stiffness
    if budget is None:
        return rows
    return [
        *rows,
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


def _mode_rows(motor: str, modes: Modes) -> list[list[str]]:
    return [
        [motor, format_quantity(frequency, "Hz"), f"{damping:.2%}", *(f"{part:+.2f}" for part in shape + 0.0)]
        for frequency, damping, shape in zip(modes.frequencies, modes.damping, modes.shapes.T, strict=True)
    ]


def _shown(value: Any, unit: str) -> str:
    numbers = value if isinstance(value, tuple) else (value,)
    return ", ".join(format_quantity(number, unit) for number in numbers)
