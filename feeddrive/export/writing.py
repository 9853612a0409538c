"""Write a plant in the form of another tool."""

from __future__ import annotations

from collections.abc import Callable
from enum import StrEnum
from pathlib import Path

from feeddrive.compiler import find_compiler
from feeddrive.export.c_selftest import selftest_text
from feeddrive.export.c_source import header_text, source_text
from feeddrive.export.casadi_file import casadi_bytes, casadi_notes
from feeddrive.export.fmu import fmu_bytes
from feeddrive.export.json_file import json_text
from feeddrive.export.linear_model import linear_model_of
from feeddrive.export.mat_file import mat_bytes
from feeddrive.export.model import model_of
from feeddrive.export.point import Point
from feeddrive.export.python_file import python_text
from feeddrive.files import write_bytes_atomically
from feeddrive.plant.plant import Plant


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
    """Write the files of one form; nothing is written where one of them cannot be made.

    Args:
        plant: the machine.
        form: which.
        point: about which is linearised, or at which a nonlinear model starts.
        folder: where to; made if it is not there.

    Returns:
        The files.

    Raises:
        InputError: no steady motion at the point, or a file cannot be written.
    """
    files = _MAKERS[form](plant, point)
    for name, data in files.items():
        write_bytes_atomically(folder / name, data)
    return tuple(folder / name for name in files)


def _ss(plant: Plant, point: Point) -> dict[str, bytes]:
    model = linear_model_of(plant, point)
    return {f"{model.identifier}_ss.py": python_text(model).encode()}


def _mat(plant: Plant, point: Point) -> dict[str, bytes]:
    model = linear_model_of(plant, point)
    return {f"{model.identifier}.mat": mat_bytes(model)}


def _json(plant: Plant, point: Point) -> dict[str, bytes]:
    model = linear_model_of(plant, point)
    return {f"{model.identifier}.json": json_text(model).encode()}


def _casadi(plant: Plant, point: Point) -> dict[str, bytes]:
    model = model_of(plant, point)
    name = model.identifier
    return {f"{name}.casadi": casadi_bytes(model), f"{name}_casadi.json": casadi_notes(model).encode()}


def _c(plant: Plant, point: Point) -> dict[str, bytes]:
    model = model_of(plant, point)
    texts = {".h": header_text(model), ".c": source_text(model), "_selftest.c": selftest_text(model)}
    return {f"{model.identifier}{ending}": text.encode() for ending, text in texts.items()}


def _fmu(plant: Plant, point: Point) -> dict[str, bytes]:
    model = model_of(plant, point)
    return {f"{model.identifier}.fmu": fmu_bytes(model, find_compiler())}


_MAKERS: dict[Form, Callable[[Plant, Point], dict[str, bytes]]] = {
    Form.SS: _ss,
    Form.MAT: _mat,
    Form.CASADI: _casadi,
    Form.C: _c,
    Form.FMU: _fmu,
    Form.JSON: _json,
}
