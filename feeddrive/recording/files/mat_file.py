"""Variables of a MATLAB file up to version 7."""

from __future__ import annotations

import io
from typing import Any

from feeddrive.errors import InputError
from feeddrive.recording.files.opening import FileContent, is_hdf5


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
