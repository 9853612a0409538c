"""Write a plant in the form of another tool."""

from __future__ import annotations

from collections.abc import Callable
from enum import StrEnum
from pathlib import Path

from feeddrive.compiler import find_compiler
from feeddrive.errors import InputError
from feeddrive.export.c_selftest import selftest_text
from feeddrive.export.c_source import header_text, source_text
from feeddrive.export.casadi_file import casadi_bytes, casadi_notes
from feeddrive.export.fmu import fmu_bytes
from feeddrive.export.heat_model import heat_model_of, heat_python_text
from feeddrive.export.json_file import json_text
from feeddrive.export.linear_model import linear_model_of, mat_bytes, python_text
from feeddrive.export.nonlinear_model import Model, identifier_of, model_of
from feeddrive.export.point import Point
from feeddrive.files import write_bytes_atomically
from feeddrive.plant.plant import Plant
from feeddrive.thermal.machine_heat import Heat


class Form(StrEnum):
    """Forms of other tools; see `feeddrive.export`."""

    SS = "ss"
    MAT = "mat"
    CASADI = "casadi"
    C = "c"
    FMU = "fmu"
    JSON = "json"

    @property
    def is_linear(self) -> bool:
        """Whether it holds the linear model."""
        return self in (Form.SS, Form.MAT, Form.JSON)


def write_export(plant: Plant, form: Form, point: Point, folder: Path) -> tuple[Path, ...]:
    """Write the files of one form into a folder, made if need be; none is written where one of them cannot be made.

    About the point is linearised, or at it a nonlinear model starts. Raises InputError: no steady motion there, or a
    file that cannot be written.
    """
    files = _LINEAR[form](plant, point) if form.is_linear else _NONLINEAR[form](model_of(plant, point))
    for name, data in files.items():
        write_bytes_atomically(folder / name, data)
    return tuple(folder / name for name in files)


def write_heat_export(heat: Heat, form: Form, velocity: float, folder: Path) -> tuple[Path, ...]:
    """Write the heat of a machine as a state space, CasADi, C or FMU, linearised at a table velocity [m/s].

    Raises InputError: a form that heat is not written in, or a file that cannot be written.
    """
    if form is Form.SS:
        name = identifier_of(f"{heat.name} heat")
        files = {f"{name}_ss.py": heat_python_text(heat, abs(velocity) / heat.lead).encode()}
    elif form in _NONLINEAR:
        files = _NONLINEAR[form](heat_model_of(heat))
    else:
        raise InputError(f"heat is not written as {form}", "--to", "take ss, casadi, c or fmu")
    for file, data in files.items():
        write_bytes_atomically(folder / file, data)
    return tuple(folder / file for file in files)


def _ss(plant: Plant, point: Point) -> dict[str, bytes]:
    model = linear_model_of(plant, point)
    return {f"{model.identifier}_ss.py": python_text(model).encode()}


def _mat(plant: Plant, point: Point) -> dict[str, bytes]:
    model = linear_model_of(plant, point)
    return {f"{model.identifier}.mat": mat_bytes(model)}


def _json(plant: Plant, point: Point) -> dict[str, bytes]:
    model = linear_model_of(plant, point)
    return {f"{model.identifier}.json": json_text(model).encode()}


def _casadi(model: Model) -> dict[str, bytes]:
    name = model.identifier
    return {f"{name}.casadi": casadi_bytes(model), f"{name}_casadi.json": casadi_notes(model).encode()}


def _c(model: Model) -> dict[str, bytes]:
    texts = {".h": header_text(model), ".c": source_text(model), "_selftest.c": selftest_text(model)}
    return {f"{model.identifier}{ending}": text.encode() for ending, text in texts.items()}


def _fmu(model: Model) -> dict[str, bytes]:
    return {f"{model.identifier}.fmu": fmu_bytes(model, find_compiler())}


_LINEAR: dict[Form, Callable[[Plant, Point], dict[str, bytes]]] = {Form.SS: _ss, Form.MAT: _mat, Form.JSON: _json}
_NONLINEAR: dict[Form, Callable[[Model], dict[str, bytes]]] = {Form.CASADI: _casadi, Form.C: _c, Form.FMU: _fmu}
