"""HDF5, and MATLAB 7.3, which is HDF5: every numeric vector by its path, MATLAB's structs as `struct.field`."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.files.opening import FileContent
from feeddrive.recording.traces.container import Tree, optional, refuse_bomb, trace_of_tree
from feeddrive.recording.traces.trace import Trace

_MOST_DATASETS, _MOST_CELLS, _LONGEST_TEXT = 10_000, 1000, 10_000
_UNITS = ("unit", "units", "Unit", "Units", "UNIT")


def read(content: FileContent, sample_time: float | None) -> Trace:
    """Read all numeric vectors.

    Raises:
        InputError: h5py is not installed, a damaged file, nothing numeric.
    """
    where = str(content.path)
    h5py = optional("h5py", "h5py", "HDF5 and MATLAB 7.3 files", where)
    tree = Tree()
    matlab = content.data.startswith(b"MATLAB")
    try:
        with h5py.File(io.BytesIO(content.data), "r") as file:
            _collect(file, "", tree, h5py, content, 0)
    except InputError:
        raise
    except Exception as error:  # the library meets damage with errors of every kind
        raise InputError(
            f"is a damaged {_name(matlab)}", where, "copy it, or save it again: in MATLAB with save(file, '-v7')"
        ) from error
    return trace_of_tree(_name(matlab), tree, sample_time, where)


def _name(matlab: bool) -> str:
    return "MATLAB 7.3 file" if matlab else "HDF5 file"


def _collect(group: Any, path: str, tree: Tree, h5py: Any, content: FileContent, depth: int) -> None:
    """Collect datasets; links out of the file and back up the tree are not followed."""
    for key in group:
        if key.startswith("#"):  # MATLAB's own
            continue
        link = group.get(key, getlink=True)
        if isinstance(link, h5py.HardLink):
            _take(group[key], f"{path}.{key}" if path else key, tree, h5py, content, depth)


def _take(item: Any, name: str, tree: Tree, h5py: Any, content: FileContent, depth: int) -> None:
    """Take a group or a dataset; the elements of a cell are numbered as in MATLAB."""
    if depth > 20 or len(tree.arrays) > _MOST_DATASETS:
        return
    if isinstance(item, h5py.Group):
        _collect(item, name, tree, h5py, content, depth + 1)
    elif not isinstance(item, h5py.Dataset) or item.shape is None or item.is_virtual:
        return
    elif "MATLAB_object_decode" in item.attrs and _of_class(item) not in ("logical", "char"):
        tree.objects.append(name)
    elif _of_class(item) == "char" or item.dtype.kind in "OS":
        if h5py.check_ref_dtype(item.dtype) is not None:
            for number, reference in enumerate(item[()].ravel(order="F")[:_MOST_CELLS], start=1):
                if reference:
                    _take(item.file[reference], f"{name}{{{number}}}", tree, h5py, content, depth + 1)
        elif item.size <= _LONGEST_TEXT:
            tree.texts[name] = _text(item[()])
    elif item.dtype.kind in "fiub" and item.size > 1 and "MATLAB_empty" not in item.attrs:
        refuse_bomb(item.size + sum(np.size(array) for array in tree.arrays.values()), content)
        tree.arrays[name], tree.units[name] = item[()], _unit(item.attrs)


def _of_class(item: Any) -> str:
    return _text(item.attrs["MATLAB_class"]) if "MATLAB_class" in item.attrs else ""


def _text(value: Any) -> str:
    """Return a text of bytes, letters or numbers of letters, alone or in an array."""
    array = np.asarray(value)
    if array.dtype.kind in "ui":
        return "".join(chr(int(number)) for number in array.ravel(order="F"))
    first = array.ravel()[0] if array.size else ""
    return first.decode("utf-8", "replace") if isinstance(first, bytes) else str(first)


def _unit(attributes: Any) -> str:
    return next((_text(attributes[key]) for key in _UNITS if key in attributes), "")
