"""ASAM MDF, version 3 and 4: every numeric channel with its unit and the master of its group as its time."""

from __future__ import annotations

import gc
import io
import logging
import sys
import warnings
from typing import Any

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.formats.container import optional
from feeddrive.recording.formats.naming import axis_in
from feeddrive.recording.formats.trace import Signal, Trace, clean, unique_names
from feeddrive.recording.opening import FileContent
from feeddrive.typing import FloatArray

NAME = "MDF file"


def recognises(data: bytes) -> bool:
    """Tell by its first bytes whether a file is MDF, also one that was not closed."""
    return data.startswith((b"MDF     ", b"UnFinMF "))


def read(content: FileContent) -> Trace:
    """Read all numeric channels.

    Raises:
        InputError: asammdf is not installed, a damaged file, nothing numeric.
    """
    where = str(content.path)
    library = optional("asammdf", "asammdf", "MDF files", where)
    logging.getLogger("asammdf").setLevel(logging.CRITICAL)
    found = _channels(library, content)
    if found is None:
        raise InputError(f"is a damaged {NAME}", where, "copy or save it again")
    kept = [row for row in found if np.ndim(row[4]) == 1 and np.size(row[4]) > 1 and row[4].dtype.kind in "fiub"]
    if not kept:
        raise InputError(f"this {NAME} holds no numeric channel", where, "record again")
    signals: list[Signal] = []
    times: list[FloatArray] = []
    for name, (_, unit, about, stamps, samples) in zip(unique_names([row[0] for row in kept]), kept, strict=True):
        time = np.ascontiguousarray(stamps, dtype=np.float64)
        if time.size != samples.size or not np.all(np.diff(time) > 0.0):
            raise InputError(f"the time of {name} does not increase", where, "record again")
        time = next((other for other in times if np.array_equal(other, time)), time)
        times.append(time)
        values = np.ascontiguousarray(samples, dtype=np.float64)
        signals.append(Signal(name, time, values, str(unit), axis_in(name), clean(str(about))))
    return Trace(NAME, tuple(signals))


def _channels(library: Any, content: FileContent) -> list[tuple[str, str, str, Any, Any]] | None:
    """Return name, unit, comment, times and samples of each channel; None for a damaged file.

    The library's object of a damaged file complains on the error stream when it is thrown away, so it is thrown away
    here, unheard.
    """
    kept, sys.unraisablehook = sys.unraisablehook, lambda _: None
    found: list[tuple[str, str, str, Any, Any]] | None = None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with library.MDF(io.BytesIO(content.data)) as file:
                found = [(one.name, one.unit or "", one.comment or "", one.timestamps, one.samples)
                         for one in file.iter_channels(skip_master=True)]  # fmt: skip
    except Exception:  # the library meets damage with errors of every kind
        found = None
    finally:
        gc.collect()
        sys.unraisablehook = kept
    return found
