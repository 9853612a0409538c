"""HDF5, and MATLAB 7.3, which is HDF5: every numeric vector by its path, MATLAB's structs as `struct.field`."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.files.opening import FileContent
from feeddrive.recording.traces.container import optional, refuse_bomb, trace_of, vectors
from feeddrive.recording.traces.trace import Trace

_MOST_DATASETS = 10_000
_UNITS = ("unit", "units", "Unit", "Units", "UNIT")


def read(content: FileContent, sample_time: float | None) -> Trace:
    """Read all numeric vectors.

    Raises:
        InputError: h5py is not installed, a damaged file, nothing numeric.
    """
    where = str(content.path)
    h5py = optional("h5py", "h5py", "HDF5 and MATLAB 7.3 files", where)
    arrays: dict[str, Any] = {}
    units: dict[str, str] = {}
    matlab = content.data.startswith(b"MATLAB")
    try:
        with h5py.File(io.BytesIO(content.data), "r") as file:
            _collect(file, "", arrays, units, h5py, content, 0)
    except InputError:
        raise
    except Exception as error:  # the library meets damage with errors of every kind
        raise InputError(
            f"is a damaged {_name(matlab)}", where, "copy it, or save it again: in MATLAB with save(file, '-v7')"
        ) from error
    return trace_of(_name(matlab), vectors(arrays), units, sample_time, where)


def _name(matlab: bool) -> str:
    return "MATLAB 7.3 file" if matlab else "HDF5 file"


def _collect(
    group: Any, path: str, arrays: dict[str, Any], units: dict[str, str], h5py: Any, content: FileContent, depth: int
) -> None:
    """Collect datasets; links out of the file and back up the tree are not followed."""
    if depth > 20 or len(arrays) > _MOST_DATASETS:
        return
    for key in group:
        if key.startswith("#"):  # MATLAB's own
            continue
        link = group.get(key, getlink=True)
        if not isinstance(link, h5py.HardLink):
            continue
        item = group[key]
        name = f"{path}.{key}" if path else key
        if isinstance(item, h5py.Group):
            _collect(item, name, arrays, units, h5py, content, depth + 1)
        elif isinstance(item, h5py.Dataset) and _numeric(item):
            refuse_bomb(item.size + sum(np.size(array) for array in arrays.values()), content)
            arrays[name] = item[()]
            units[name] = _unit(item.attrs)


def _numeric(item: Any) -> bool:
    return item.dtype.kind in "fiub" and item.shape is not None and item.size > 1 and not item.is_virtual


def _unit(attributes: Any) -> str:
    for key in _UNITS:
        if key in attributes:
            value = attributes[key]
            return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)
    return ""
