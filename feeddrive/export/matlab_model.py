"""The linear model as a .mat file of version 5, for MATLAB, Octave and scipy.

    load bench_axis.mat                                                  % MATLAB, Octave
    system = ss(A, B, C, D); system.StateName = state_names;

    model = scipy.io.loadmat("bench_axis.mat", simplify_cells=True)      # Python
    system = control.ss(model["A"], model["B"], model["C"], model["D"])

Names and units are cell arrays of text; SI units.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.io import savemat

from feeddrive import __version__
from feeddrive.export.equation_quantities import Quantity, parameters
from feeddrive.export.linear_model import LinearModel
from feeddrive.export.notes import included, left_out, linear_notes
from feeddrive.typing import FloatArray


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
        content |= _names(name, rows) | {f"{name}_values": _column(rows)}
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
    return _without_date(buffer.getvalue())


def _names(name: str, rows: Sequence[Quantity]) -> dict[str, Any]:
    return {f"{name}_names": _cells([row.name for row in rows]), f"{name}_units": _cells([row.unit for row in rows])}


def _column(rows: Sequence[Quantity]) -> FloatArray:
    return np.array([[row.value] for row in rows])


def _cells(texts: Sequence[str]) -> Any:
    """A column of text, a cell array in the file."""
    cells = np.empty((len(texts), 1), dtype=object)
    cells[:, 0] = texts
    return cells


def _without_date(data: bytes) -> bytes:
    """The first 116 bytes are free text; scipy puts the date there, so that two files of one plant would differ."""
    return f"MATLAB 5.0 MAT-file, made by feeddrive {__version__}".encode("ascii").ljust(116) + data[116:]
