"""MATLAB before 7.3 (save with -v7, -v6): every numeric vector by its path, as of a file of MATLAB 7.3."""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.files.foreign import read_variables
from feeddrive.recording.files.opening import FileContent
from feeddrive.recording.traces.container import Tree, refuse_bomb, trace_of_tree
from feeddrive.recording.traces.trace import Trace

NAME = "MATLAB file"
_DEEPEST = 20


def recognises(data: bytes) -> bool:
    """Tell by its first bytes whether a file is of MATLAB 5 to 7."""
    return data.startswith(b"MATLAB 5.0")


def read(content: FileContent, sample_time: float | None) -> Trace:
    """Read all numeric vectors.

    Raises:
        InputError: a damaged file, nothing numeric.
    """
    from scipy.io import whosmat

    where = str(content.path)
    try:
        sizes = [int(np.prod(shape)) for _, shape, _ in whosmat(io.BytesIO(content.data))]
    except Exception as error:  # the parser meets garbage with errors of every kind
        raise InputError(f"is a damaged {NAME}", where, "copy it or save it again") from error
    refuse_bomb(sum(sizes), content)
    tree = Tree()
    for name, value in read_variables(content).items():
        _take(value, name, tree, 0)
    return trace_of_tree(NAME, tree, sample_time, where)


def _take(value: Any, path: str, tree: Tree, depth: int) -> None:
    """Take a variable; elements of a cell are numbered as in MATLAB."""
    if depth > _DEEPEST:
        return
    if isinstance(value, Mapping):
        for key, inner in value.items():
            _take(inner, f"{path}.{key}", tree, depth + 1)
    elif isinstance(value, str):
        tree.texts[path] = value
    elif isinstance(value, list) or (isinstance(value, np.ndarray) and value.dtype == object):
        for number, inner in enumerate(np.ravel(np.asarray(value, dtype=object), order="F"), start=1):
            _take(inner, f"{path}{{{number}}}", tree, depth + 1)
    elif isinstance(value, np.ndarray) and value.dtype.names:
        tree.objects.append(path)
    elif isinstance(value, np.ndarray) and value.dtype.kind in "fiub":
        tree.arrays[path] = value
