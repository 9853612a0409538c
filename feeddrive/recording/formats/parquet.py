"""Parquet tables: every numeric column; the unit from the field's metadata or from brackets behind its name."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.files.opening import FileContent
from feeddrive.recording.traces.container import optional, refuse_bomb, trace_of
from feeddrive.recording.traces.trace import Trace
from feeddrive.typing import FloatArray

NAME = "Parquet table"


def recognises(data: bytes) -> bool:
    """Tell by its first bytes whether a file is Parquet."""
    return data.startswith(b"PAR1")


def read(content: FileContent, sample_time: float | None) -> Trace:
    """Read all numeric columns.

    Raises:
        InputError: pyarrow is not installed, a damaged file, nothing numeric.
    """
    where = str(content.path)
    library = optional("pyarrow.parquet", "pyarrow", "Parquet files", where)
    types = optional("pyarrow.types", "pyarrow", "Parquet files", where)
    arrays: dict[str, FloatArray] = {}
    units: dict[str, str] = {}
    try:
        file = library.ParquetFile(io.BytesIO(content.data))
        refuse_bomb(file.metadata.num_rows * max(1, file.metadata.num_columns), content)
        table = file.read()
        for field, column in zip(table.schema, table.columns, strict=True):
            if types.is_timestamp(field.type) or types.is_duration(field.type):
                ticks = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}[field.type.unit]
                whole = column.cast("int64").to_numpy().astype(np.int64)
                arrays[field.name] = (whole - whole[0]).astype(np.float64) * ticks
                units[field.name] = "s"
            elif types.is_integer(field.type) or types.is_floating(field.type) or types.is_boolean(field.type):
                arrays[field.name] = _values(column)
                units[field.name] = _unit(field.metadata)
    except InputError:
        raise
    except Exception as error:  # the library meets damage with errors of every kind
        raise InputError(f"is a damaged {NAME}", where, "copy or write it again") from error
    return trace_of(
        NAME, {name: values for name, values in arrays.items() if values.size > 1}, units, sample_time, where
    )


def _values(column: Any) -> FloatArray:
    return np.ascontiguousarray(column.to_numpy(zero_copy_only=False), dtype=np.float64)


def _unit(metadata: Any) -> str:
    for key in (b"unit", b"units"):
        if metadata and key in metadata:
            return str(metadata[key].decode("utf-8", "replace"))
    return ""
