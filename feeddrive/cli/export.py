"""`feeddrive export PLANT --to ...`: a machine in the form of another tool."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from feeddrive.cli.output import deliver, warnings_as_lines
from feeddrive.compiler import find_compiler
from feeddrive.errors import printable
from feeddrive.export.exported_plant import Form
from feeddrive.export.notes import included, left_out, linear_notes
from feeddrive.export.point import Point, export_point
from feeddrive.interface.axis import load
from feeddrive.output_folder import output_folder, refuse_unusable
from feeddrive.plant.plant import Plant
from feeddrive.units.quantity import format_quantity


def command(
    plant: Annotated[str, typer.Argument(help="Plant file, or the name of a shipped machine.")],
    to: Annotated[list[Form], typer.Option("--to", help="Form; may be given again for several.")],
    out: Annotated[Path, typer.Option("--out", help="Folder for the files.")],
    at: Annotated[
        str,
        typer.Option(
            "--at",
            metavar="POINT",
            help='Table position and velocity, "x=200 mm,v=3 m/min"; without x the middle of the stroke.',
        ),
    ] = "",
    heat: Annotated[
        bool, typer.Option("--heat", help="Temperatures and growth in place of the motion: ss, casadi, c, fmu.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print files, point and notes as JSON.")] = False,
) -> None:
    """Write a machine in the form of another tool; NAME is that of the machine.

    \b
    Linear about the point, without v at 3 m/min:
      ss      NAME_ss.py   from NAME_ss import system           (needs python-control)
      mat     NAME.mat     load NAME.mat; system = ss(A,B,C,D)  (MATLAB, Octave, scipy)
      json    NAME.json    everything: matrices, units, parameters, modes, notes

    \b
    Nonlinear with all effects, starting at the point, without v at rest:
      casadi  NAME.casadi  f = casadi.Function.load("NAME.casadi"); f(x=x0, motor_torque=1.5)["xdot"]
      c       NAME.h, .c   cc -ffp-contract=off NAME.c NAME_selftest.c -lm && ./a.out
      fmu     NAME.fmu     fmpy.simulate_fmu("NAME.fmu", start_values={"motor_torque": 1.5})

    With --heat, or from a file that declares heat alone, the same forms but mat and json hold the heat of the machine:
    inputs are the speed of the screw and the temperature of the air.

    All in SI units. CasADi loads files of its own version or an older one. The FMU is FMI 2.0 for model exchange, with
    sources; its binary is for this platform.
    """
    refuse_unusable(out)
    with warnings_as_lines():
        axis = load(plant)
        if heat or not axis.has_motion:
            with output_folder(out) as folder:
                paths = [path for form in dict.fromkeys(to) for path in axis.export(form, folder, at, heat=True)]
            paths = [out / path.name for path in paths]
            content = {"format": "feeddrive-exported/1", "plant": axis.name, "files": [str(path) for path in paths]}
            deliver(content, [f"{path}: heat of {axis.name}" for path in paths], as_json, None)
            return
        machine, point = axis.plant, export_point(axis.plant, at, "at")
        with output_folder(out) as folder:
            files = {form: axis.export(form, folder, at) for form in dict.fromkeys(to)}
        files = {form: tuple(out / path.name for path in paths) for form, paths in files.items()}
    content = _content(machine, point, files)
    if as_json:
        deliver(content, [], as_json, None)
        return
    for line in _lines(machine, point, files):
        typer.echo(printable(line))


def _content(plant: Plant, point: Point, files: dict[Form, tuple[Path, ...]]) -> dict[str, Any]:
    """What was written, SI."""
    return {
        "format": "feeddrive-exported/1",
        "plant": plant.name,
        "files": {form.value: [str(path) for path in paths] for form, paths in files.items()},
        "point": {
            "table_position": point.position,
            "linear_at_velocity": point.linearised_at,
            "starts_at_velocity": point.starts_at,
        },
        "notes": {"included": included(plant), "left_out": _left_out(plant, list(files))},
    }


def _left_out(plant: Plant, forms: list[Form]) -> list[str]:
    lines = list(left_out(plant))
    if any(form.is_linear for form in forms):
        lines += [f"linear forms: {line}" for line in linear_notes(plant)]
    if Form.FMU in forms and find_compiler() is None:
        lines.append("the FMU's binary: no C compiler was found, it holds sources alone")
    return lines


def _lines(plant: Plant, point: Point, files: dict[Form, tuple[Path, ...]]) -> list[str]:
    position = format_quantity(point.position, "m")
    lines = []
    for form, paths in files.items():
        velocity = format_quantity(point.linearised_at if form.is_linear else point.starts_at, "m/s")
        how = "linear about" if form.is_linear else "starts at"
        lines.append(f"{', '.join(map(str, paths))}: {how} x = {position}, v = {velocity}")
    return [*lines, *(f"left out: {line}" for line in _left_out(plant, list(files)))]
