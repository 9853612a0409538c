"""The plant linearised about a point, with its matrices, names, units and modes.

    x' = A x + B u,  y = C x + D u     deviations from the point

Mass, damping and stiffness matrix are those of the chain at the point, friction apart.

The linear model as a Python module that needs python-control alone.

    from bench_axis_ss import system
    system.poles()

It holds numbers as `repr` writes them, so that nothing is lost, and names and units beside them.

The linear model as a .mat file of version 5, for MATLAB, Octave and scipy.

    load bench_axis.mat                                                  % MATLAB, Octave
    system = ss(A, B, C, D); system.StateName = state_names;

    model = scipy.io.loadmat("bench_axis.mat", simplify_cells=True)      # Python
    system = control.ss(model["A"], model["B"], model["C"], model["D"])

Names and units are cell arrays of text; SI units.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.io import savemat

from feeddrive import __version__
from feeddrive.errors import printable
from feeddrive.export.nonlinear_model import Quantity, identifier_of, inputs, outputs, parameters, states
from feeddrive.export.notes import included, left_out, linear_notes
from feeddrive.export.point import Point
from feeddrive.plant.analysis.linear import state_space
from feeddrive.plant.analysis.steady import steady_motion
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray

if TYPE_CHECKING:
    import control


@dataclass(frozen=True)
class LinearModel:
    """A state space and where it comes from.

    Attributes:
        plant: the machine.
        identifier: its name, for files.
        position, velocity: of the table at the point [m, m/s].
        system: A, B, C, D with names.
        states, inputs: with values at the point; outputs in the order of y.
        outputs: see above.
        mass, damping, stiffness: M, C, K of the chain, shape (n, n) [kg, N s/m, N/m, and with angles].
    """

    plant: Plant
    identifier: str
    position: float
    velocity: float
    system: control.StateSpace
    states: tuple[Quantity, ...]
    inputs: tuple[Quantity, ...]
    outputs: tuple[Quantity, ...]
    mass: FloatArray
    damping: FloatArray
    stiffness: FloatArray


def linear_model_of(plant: Plant, point: Point) -> LinearModel:
    """The plant linearised about the steady motion at a point, which without a velocity moves at `MOVING`.

    Raises InputError: a point outside the stroke, or where no steady motion is found.
    """
    plant.refuse_off_stroke(point.position, plant.name)
    position, velocity = point.position, point.linearised_at
    at = steady_motion(plant, velocity, position)
    values = plant.chain_values()
    chain = (plant.chain.mass, plant.chain.damping, plant.chain.stiffness)
    matrices = (np.array(matrix(values, position), dtype=float) for matrix in chain)
    rows = states(plant, at.state.tolist()), inputs(at.torque), outputs()
    system = state_space(plant, velocity, position)
    return LinearModel(plant, identifier_of(plant.name), position, velocity, system, *rows, *matrices)


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


def mat_bytes(model: LinearModel) -> bytes:
    """The content of the file.

    Variables: `A`, `B`, `C`, `D`; `mass_matrix`, `damping_matrix`, `stiffness_matrix` of the chain; `X_names`,
    `X_units` and `X_values` with X = state, input, parameter, and `output_names`, `output_units`; `coordinate_names`;
    `point` with `table_position` [m] and `table_velocity` [m/s]; `plant`, `feeddrive_version`, `notes`.
    """
    plant, system = model.plant, model.system
    content: dict[str, Any] = {key: getattr(system, key) for key in "ABCD"}
    content |= {"mass_matrix": model.mass, "damping_matrix": model.damping, "stiffness_matrix": model.stiffness}
    for name, rows in (("state", model.states), ("input", model.inputs), ("parameter", parameters(plant))):
        content |= _names(name, rows) | {f"{name}_values": np.array([[row.value] for row in rows])}
    content |= _names("output", model.outputs)
    content["coordinate_names"] = _cells([row.name for row in model.states[: len(plant.chain.coordinates)]])
    content["point"] = {"table_position": model.position, "table_velocity": model.velocity}
    content |= {"plant": plant.name, "feeddrive_version": __version__}
    notes = (
        *(f"included: {line}" for line in included(plant)),
        *(f"left out: {line}" for line in left_out(plant)),
        *linear_notes(plant),
    )
    content["notes"] = _cells(notes)
    buffer = io.BytesIO()
    savemat(buffer, content, oned_as="column")
    return f"MATLAB 5.0 MAT-file, made by feeddrive {__version__}".encode("ascii").ljust(116) + buffer.getvalue()[116:]


def _names(name: str, rows: Sequence[Quantity]) -> dict[str, Any]:
    return {f"{name}_names": _cells([row.name for row in rows]), f"{name}_units": _cells([row.unit for row in rows])}


def _cells(texts: Sequence[str]) -> Any:
    """A column of text, a cell array in the file."""
    cells = np.empty((len(texts), 1), dtype=object)
    cells[:, 0] = texts
    return cells
