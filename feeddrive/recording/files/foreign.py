"""Foreign files turned into canonical channels by a mapping."""

from __future__ import annotations

import difflib
import io
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from feeddrive.errors import InputError, quoted
from feeddrive.recording.files.channel_mapping import FileMapping, Hold, Variable
from feeddrive.recording.files.csv_file import Table
from feeddrive.recording.files.opening import FileContent, is_hdf5
from feeddrive.typing import FloatArray


def table_variables(table: Table) -> dict[str, Any]:
    """Return the columns of a text table, (n,) each, by heading, and by heading without its unit where that is free."""
    variables: dict[str, Any] = {}
    for index, name in enumerate(table.names):
        short = re.sub(r"\s*\[[^\]]*\]$", "", name)
        variables.setdefault(short, table.columns[index])
    return variables | dict(zip(table.names, table.columns, strict=True))


def mapped_columns(variables: Mapping[str, Any], mapping: FileMapping, where: str) -> dict[str, FloatArray]:
    """Return the columns that a mapping names, SI units, (n,) each; `time` among them, first.

    Variables are name -> number, vector, matrix or nested dict. Raises InputError: a variable that is absent or not
    numeric, or channels of different lengths.
    """
    columns: dict[str, FloatArray] = {}
    if mapping.time is not None:
        columns["time"] = _channel(variables, mapping.time, where)
    for name, variable in mapping.channels.items():
        columns[name] = _channel(variables, variable, where)
    lengths = {name: column.size for name, column in columns.items()}
    if len(set(lengths.values())) > 1:
        what = "channels of different lengths: " + ", ".join(f"{name} {size}" for name, size in lengths.items())
        raise InputError(what, where, "map variables of the same length")
    if mapping.sample_time is not None:
        rows = next(iter(lengths.values()))
        columns = {"time": mapping.sample_time * np.arange(rows, dtype=np.float64), **columns}
    return columns


def _channel(variables: Mapping[str, Any], variable: Variable, where: str) -> FloatArray:
    factors = [
        _vector(_find(variables, name, where), variable.column, f'{where}, variable "{name}"')
        for name in variable.names
    ]
    longest = max(factor.size for factor in factors)
    product: FloatArray = np.full(longest if len(factors) > 1 else 1, variable.factor)
    with np.errstate(all="ignore"):  # a number beyond all bounds is refused where its row is known
        for factor in factors:
            if factor.size not in (1, longest):
                what = f"variables of {factor.size} and {longest} values cannot be multiplied"
                raise InputError(what, f"{where}, {' * '.join(variable.names)}", "map variables of the same length")
            product = product * factor
        channel = variable.conversion.apply(product) + variable.offset
    if variable.hold is Hold.INTERVAL_BEFORE:
        channel = np.concatenate((channel[1:], channel[-1:]))
    return channel


def _find(variables: Mapping[str, Any], name: str, where: str) -> Any:
    """Return a variable; a dot reaches into a struct."""
    if name in variables:
        return variables[name]
    value: Any = variables
    for part in name.split("."):
        if not isinstance(value, Mapping) or part not in value:
            raise _absent(name, part, value if isinstance(value, Mapping) else variables, where)
        value = value[part]
    return value


def _absent(name: str, part: str, among: Mapping[str, Any], where: str) -> InputError:
    near = difflib.get_close_matches(part, list(among)[:1000], n=1, cutoff=0.6)
    held = ", ".join(quoted(one, 40) for one in list(among)[:12])
    return InputError(f'no variable "{name}"', where, f'did you mean "{near[0]}"?' if near else f"it holds {held}")


def _vector(value: Any, column: int, where: str) -> FloatArray:
    """Return a numeric vector of a variable, taking a column of a matrix."""
    array = np.asarray(value)
    if array.dtype.kind not in "fiub" or array.ndim > 2:
        raise InputError("is not a real numeric vector", where, "map a vector of real numbers")
    if array.ndim == 2 and 1 not in array.shape:
        if column > array.shape[1]:
            raise InputError(f"has {array.shape[1]} columns, no column {column}", where, "correct the key column")
        array = array[:, column - 1]
    return np.ascontiguousarray(array.reshape(-1), dtype=np.float64)


def read_variables(content: FileContent) -> dict[str, Any]:
    """Return the variables of a .mat file; structs as nested dicts.

    Raises:
        InputError: version 7.3 (HDF5), or not a .mat file.
    """
    where = str(content.path)
    if is_hdf5(content.data):
        mend = "save it again in MATLAB with save(file, '-v7')"
        raise InputError("is a .mat file of version 7.3 (HDF5), which is not read", where, mend)
    from scipy.io import loadmat

    try:
        read: dict[str, Any] = loadmat(io.BytesIO(content.data), simplify_cells=True)
    except Exception as error:  # the parser meets garbage with errors of every kind
        raise InputError(
            "is not a .mat file, or it is damaged", where, "save it again with save(file, '-v7')"
        ) from error
    return {name: value for name, value in read.items() if not name.startswith("__")}
