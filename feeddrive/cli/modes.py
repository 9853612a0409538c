"""`feeddrive modes PLANT`: natural frequencies against the position of the table, motor held and free."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.table import Table

from feeddrive.cli.output import JsonOption, chain_remark, deliver, finite, table, tell_written, warnings_as_lines
from feeddrive.files import find_plant, write_bytes_atomically, write_text_atomically
from feeddrive.output_folder import output_folder, refuse_unusable
from feeddrive.plant.analysis.mode_map import ModeMap, mode_map
from feeddrive.plant.file.files import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import parse

SHOWN = 3
"""Frequencies in the table; JSON has all."""


def command(
    plant: Annotated[str, typer.Argument(help="Plant file, or the name of a shipped machine.")],
    at: Annotated[
        list[str] | None, typer.Option(help="Table position such as 250mm, or several; the stroke if left out.")
    ] = None,
    as_json: JsonOption = False,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for modes.json and the figure modes.png.")] = None,
) -> None:
    """Natural frequencies along the stroke, with the motor held by its brake or servo, and free."""
    refuse_unusable(out)
    with warnings_as_lines():
        machine = read_plant(find_plant(plant))
        places = np.array([parse(text, "m", "--at") for text in at]) if at else None
        found = mode_map(machine, places)
        if out is not None:
            with output_folder(out) as folder:
                _write(machine, found, folder)
    deliver(_content(machine, found), _tables(machine, found), as_json, None)
    tell_written(out, as_json)


def _write(plant: Plant, found: ModeMap, folder: Path) -> None:
    write_text_atomically(
        folder / "modes.json", json.dumps(_content(plant, found), indent=2, ensure_ascii=False) + "\n"
    )
    if plant.chain.varies and plant.stroke is not None:
        from feeddrive.report.figures.drawing import render  # matplotlib takes time to import
        from feeddrive.report.figures.figure_modes import modes_figure

        write_bytes_atomically(folder / "modes.png", render(modes_figure(plant)).png)


def _content(plant: Plant, found: ModeMap) -> dict[str, Any]:
    """Everything, SI."""
    return {
        "format": "feeddrive-modes/1",
        "name": plant.name,
        "structure": plant.chain.structure,
        **{key: value.tolist() for key, value in asdict(found).items() if key != "chain_valid_to"},
        "chain_valid_to": [finite(value) for value in found.chain_valid_to.tolist()],
    }


def _tables(plant: Plant, found: ModeMap) -> list[Table]:
    """One row per table position; of a rigid structure, which has no modes, a single row that says so."""
    title = f"{plant.name}: natural frequencies along the stroke"
    if not plant.chain.elastic:
        return [table(title, ("structure", "natural frequencies"), [["rigid", "none: nothing is elastic"]])]
    brake = plant.drive is not None and plant.drive.motor.brake is not None
    columns = [("table [mm]", _numbers(1e3 * found.positions))]
    if plant.chain.varies:
        columns.append(("nut [mm]", _numbers(1e3 * found.nut)))
    columns.append(("k [N/µm]", _numbers(1e-6 * found.stiffness)))
    for name, frequencies in (("braked" if brake else "held", found.held), ("free", found.free)):
        columns += [(f"{name} f{i} [Hz]", _numbers(column)) for i, column in enumerate(frequencies.T[:SHOWN], 1)]
    shown = table(title, [heading for heading, _ in columns], list(zip(*(cells for _, cells in columns), strict=True)))
    shown.caption = chain_remark(float(np.min(found.chain_valid_to)))
    return [shown]


def _numbers(values: FloatArray) -> list[str]:
    return [f"{value:.1f}" for value in values]
