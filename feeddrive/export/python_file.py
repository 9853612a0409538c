"""The linear model as a Python module that needs python-control alone.

    from bench_axis_ss import system
    system.poles()

It holds numbers as `repr` writes them, so that nothing is lost, and names and units beside them.
"""

from __future__ import annotations

from collections.abc import Sequence

from feeddrive import __version__
from feeddrive.errors import printable
from feeddrive.export.equation_quantities import Quantity
from feeddrive.export.linear_model import LinearModel
from feeddrive.export.notes import included, left_out, linear_notes
from feeddrive.typing import FloatArray


def python_text(model: LinearModel) -> str:
    """Source of the module: `A`, `B`, `C`, `D`, `STATES`, `INPUTS`, `OUTPUTS` as (name, unit, value at the point)."""
    lines = [
        *(f"# {line}" for line in _heading(model)),
        "import control",
        "",
        *_table("STATES", model.states),
        *_table("INPUTS", model.inputs),
        *_table("OUTPUTS", model.outputs),
        *(line for key in "ABCD" for line in _matrix(key, getattr(model.system, key))),
        "",
        "system = control.ss(",
        "    A, B, C, D,",
        *(f"    {kind.lower()}=[row[0] for row in {kind}]," for kind in ("STATES", "INPUTS", "OUTPUTS")),
        ")",
    ]
    return "\n".join(lines) + "\n"


def _heading(model: LinearModel) -> list[str]:
    name = model.plant.name
    lines = [
        f"{name}, linear about the table at {model.position!r} m moving at {model.velocity!r} m/s.",
        f"Made by feeddrive {__version__}. SI units: x' = A x + B u, y = C x + D u, deviations from the point.",
        *(f"Included: {line}" for line in included(model.plant)),
        *(f"Left out: {line}" for line in (*left_out(model.plant), *linear_notes(model.plant))),
    ]
    return [" ".join(printable(line).split()) for line in lines]  # a comment ends with its line


def _table(name: str, rows: Sequence[Quantity]) -> list[str]:
    with_value = name != "OUTPUTS"
    entries = [f"    ({row.name!r}, {row.unit!r}{f', {row.value!r}' if with_value else ''})," for row in rows]
    return [f"# name, unit{', value at the point' if with_value else ''}", f"{name} = [", *entries, "]"]


def _matrix(name: str, matrix: FloatArray) -> list[str]:
    return [f"{name} = [", *(f"    {row!r}," for row in matrix.tolist()), "]"]
