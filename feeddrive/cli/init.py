"""`feeddrive init my_axis.toml`: a plant file from options, or from answers on a terminal."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from feeddrive.cli.output import deliver, print_written, tables_of, warnings_as_lines
from feeddrive.errors import InputError
from feeddrive.interface.machine.drafts import draft

_QUESTIONS = {
    "screw": "Ball screw, such as 32 x 10 mm",
    "motor": "Motor, such as 400 W",
    "mass": "Mass of the table with its load, such as 80 kg",
    "stroke": "Stroke, such as 800 mm",
    "guide": "Size of the guide rails, such as 25",
}


def command(
    path: Annotated[Path, typer.Argument(help="Plant file to write; one that is there already is kept.")],
    screw: Annotated[str, typer.Option(help="Size of the ball screw, '32 x 10 mm', or its name.")] = "",
    length: Annotated[str, typer.Option(help="Length of the screw between its bearings.")] = "",
    motor: Annotated[str, typer.Option(help="Rated power of the motor, '400 W', or its name.")] = "",
    guide: Annotated[str, typer.Option(help="Size of the guide rails, '25', or name of the carriages.")] = "",
    carriages: Annotated[int, typer.Option(help="How many carriages.")] = 4,
    mass: Annotated[str, typer.Option(help="Mass of the table with its load.")] = "",
    stroke: Annotated[str, typer.Option(help="Stroke of the table.")] = "",
    preload: Annotated[str, typer.Option(help="Preload of the nut.")] = "",
    supports: Annotated[str, typer.Option(help="fixed-supported, fixed-fixed, ...: near and far end.")] = "",
    bearing: Annotated[str, typer.Option(help="Name of the support bearing.")] = "",
    coupling: Annotated[str, typer.Option(help="Name of the coupling.")] = "",
    orientation: Annotated[str, typer.Option(help="horizontal or vertical.")] = "horizontal",
    structure: Annotated[str, typer.Option(help="distributed_screw or three_inertias.")] = "distributed_screw",
    name: Annotated[str, typer.Option(help="Name of the machine; that of the file if left out.")] = "",
) -> None:
    """Write a plant file: parts of the catalogue, guesses where nothing is given, every further key as a comment."""
    if path.exists():
        raise InputError("exists already", str(path), "name another file, or remove this one")
    given = {"screw": screw, "motor": motor, "mass": mass, "stroke": stroke, "guide": guide}
    if sys.stdin.isatty():
        for key, question in _QUESTIONS.items():
            if not given[key] and not (key == "stroke" and length):
                given[key] = typer.prompt(question, err=True).strip()
    with warnings_as_lines():
        made = draft(
            screw=given["screw"],
            motor=given["motor"],
            mass=given["mass"],
            stroke=given["stroke"] or None,
            length=length or None,
            guide=given["guide"],
            carriages=carriages,
            preload=preload or None,
            supports=supports,
            bearing=bearing,
            coupling=coupling,
            orientation=orientation,
            structure=structure,
            name=name or path.stem.replace("_", " "),
        )
        checked = made.check()
        made.save(path)
    told = [one for one in checked.findings if not one.source.startswith("guess")]  # the second table has every guess
    deliver({}, tables_of([replace(checked, findings=told).listing(), made.listing()]), False, None)
    print_written(path, False)
