"""Parquet tables: every numeric column; the unit from the field's metadata or from brackets behind its name."""

from __future__ import annotations

import io
from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.files.opening import FileContent
from feeddrive.recording.formats.sinumerik_edge import capture_of, is_capture
from feeddrive.recording.traces.container import optional, refuse_bomb, trace_of
from feeddrive.recording.traces.stamps import is_time
from feeddrive.recording.traces.trace import Trace

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
    arrays: dict[str, Any] = {}
    units: dict[str, str] = {}
    try:
        file = library.ParquetFile(io.BytesIO(content.data))
        refuse_bomb(file.metadata.num_rows * max(1, file.metadata.num_columns), content)
        table = file.read()
        while any(types.is_struct(field.type) for field in table.schema):
            table = table.flatten()
        for field, column in zip(table.schema, table.columns, strict=True):
            found = _column(field, column, types)
            if found is not None and found.size > 1:
                arrays[field.name], units[field.name] = found, _unit(field.metadata)
    except InputError:
        raise
    except Exception as error:  # the library meets damage with errors of every kind
        raise InputError(f"is a damaged {NAME}", where, "copy or write it again") from error
    if is_capture(list(arrays)):
        columns = {name: np.asarray(values, dtype=np.float64) for name, values in arrays.items()}
        return capture_of(columns, where, sample_time)
    return trace_of(NAME, arrays, units, sample_time, where)


def _column(field: Any, column: Any, types: Any) -> Any:
    """Return a column as numbers or dates, (n,), NaN or NaT where a row has none; None where it is neither."""
    kind = field.type.value_type if types.is_dictionary(field.type) else field.type
    if types.is_timestamp(kind) or types.is_duration(kind):
        return column.to_numpy()
    if types.is_time(kind):
        ticks = column.cast("int64" if kind.bit_width == 64 else "int32").cast("int64")
        there = column.is_valid().to_numpy()
        return np.where(there, ticks.fill_null(0).to_numpy().view(f"m8[{kind.unit}]"), np.timedelta64("NaT"))
    if types.is_string(kind) or types.is_large_string(kind):
        return _written(column.to_pylist()) if is_time(field.name) else None
    if types.is_decimal(kind):
        return column.cast("float64").to_numpy(zero_copy_only=False)
    if not (types.is_integer(kind) or types.is_floating(kind) or types.is_boolean(kind)):
        return None
    return column.to_numpy(zero_copy_only=False)


def _written(cells: list[str | None]) -> Any:
    """Return dates of ISO 8601 texts, (n,); None where one is none."""
    try:
        stamps = [datetime.fromisoformat(cell) if cell else None for cell in cells]
        zone = next((stamp.tzinfo for stamp in stamps if stamp is not None), None)
        begin = datetime(1970, 1, 1, tzinfo=UTC if zone else None)
        ticks = ["NaT" if stamp is None else (stamp - begin) // timedelta(microseconds=1) for stamp in stamps]
    except (ValueError, TypeError):  # of dates with a zone and without
        return None
    return np.array(ticks, dtype="M8[us]") if ticks else None


def _unit(metadata: Any) -> str:
    for key in (b"unit", b"units"):
        if metadata and key in metadata:
            return str(metadata[key].decode("utf-8", "replace"))
    return ""
