"""What files of named arrays (HDF5, MATLAB 7.3, Parquet, TDMS without a clock) share: which array is the time."""

from __future__ import annotations

import importlib
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.files.opening import FileContent
from feeddrive.recording.traces.naming import axis_in, conversion, known_unit, plain_words
from feeddrive.recording.traces.trace import Signal, Trace, clean, unique_names
from feeddrive.typing import FloatArray

_TIME = re.compile(r"^(?:t|time|zeit|timestamps?|time ?axis|time s|time ?vector|x ?time)$")
_UNIT = re.compile(r"^(.*\S)\s*[\[(]([^\])\[(]{1,20})[\])]$")


def optional(module: str, package: str, what: str, where: str) -> Any:
    """Import a library that only one format needs.

    Raises:
        InputError: it is not installed; the line says how to install it.
    """
    try:
        return importlib.import_module(module)
    except ImportError:
        raise not_installed(package, what, where) from None


def not_installed(package: str, what: str, where: str) -> InputError:
    """Return the error of a library that is not installed; the line says how to install it."""
    extra = {"h5py": "hdf5", "npTDMS": "tdms", "asammdf": "mdf", "pyarrow": "parquet"}[package]
    mend = f"pip install 'feeddrive[{extra}]'"
    mend += ", or save it in MATLAB with save(file, '-v7')" if package == "h5py" else f", or pip install {package}"
    return InputError(f"{what} are read with {package}, which is not installed", where, mend)


def refuse_bomb(values: int, content: FileContent) -> None:
    """Refuse a file that declares far more values than its size can hold, before memory is taken for them.

    Raises:
        InputError: more than 64 MB of doubles, and more than 500 times the size of the file.
    """
    if 8 * values > max(64 << 20, 500 * len(content.data)):
        what = f"declares {values} values in {len(content.data) // 1000} kB"
        raise InputError(what, str(content.path), "the file is damaged, or holds nothing: copy or save it again")


def vectors(arrays: Mapping[str, Any]) -> dict[str, FloatArray]:
    """Return the numeric vectors of a tree of arrays, (n,) each; columns of a matrix by name and number."""
    found: dict[str, FloatArray] = {}
    for name, value in arrays.items():
        array = np.asarray(value)
        if array.dtype.kind not in "fiub" or array.size < 2:
            continue
        array = np.squeeze(array)
        if array.ndim == 1:
            found[name] = np.ascontiguousarray(array, dtype=np.float64)
        elif array.ndim == 2 and min(array.shape) <= 64:
            tall = array if array.shape[0] >= array.shape[1] else array.T
            for column in range(tall.shape[1]):
                found[f"{name} column {column + 1}"] = np.ascontiguousarray(tall[:, column], dtype=np.float64)
    return found


def trace_of(
    format_: str, arrays: Mapping[str, FloatArray], units: Mapping[str, str], sample_time: float | None, where: str
) -> Trace:
    """Return the trace of named vectors: those of one length share the time vector of that length.

    Args:
        format_: what the file is, for people.
        arrays: name -> (n,).
        units: name -> unit, where the file says one.
        sample_time: [s], where the person says it.
        where: file name.

    Raises:
        InputError: no numeric vector.
    """
    if not arrays:
        raise InputError(
            f"this {format_} holds no numeric vector", where, "save the signals as vectors of real numbers"
        )
    notes: list[str] = []
    clocks: dict[int, tuple[str, FloatArray]] = {}
    for name, values in arrays.items():
        if _is_time(name) and values.size not in clocks and bool(np.all(np.diff(values) > 0.0)):
            clocks[values.size] = name, _seconds(name, values, units.get(name, ""), notes)
    signals = []
    for name, plain in zip(arrays, unique_names([clean(name) for name in arrays]), strict=True):
        values = arrays[name]
        clock = clocks.get(values.size)
        shown, unit = _unit_of(plain, units.get(name, ""))
        if clock is not None:
            time, timed = clock[1], True
        else:
            time = np.arange(values.size, dtype=np.float64) * (sample_time or 1.0)
            timed = sample_time is not None
        kind = "time" if clock is not None and clock[0] == name else ""
        about = shown if shown != plain else ""
        signals.append(Signal(plain, time, values, unit, axis_in(shown), about, kind, timed))
    if all(signal.kind == "time" for signal in signals):
        raise InputError(f"this {format_} holds a time and no signal", where, "save the signals beside it")
    return Trace(format_, tuple(signals), tuple(notes))


def _is_time(name: str) -> bool:
    last = re.split(r"[/.]", name)[-1]
    match = _UNIT.match(last)
    return _TIME.match(plain_words(match[1] if match else last)) is not None


def _unit_of(name: str, given: str) -> tuple[str, str]:
    """Return a name without the unit in brackets behind it, and the unit."""
    match = _UNIT.match(name)
    if match and known_unit(match[2]) and not given:
        return match[1], match[2]
    return name, given


def _seconds(name: str, stamps: FloatArray, unit: str, notes: list[str]) -> FloatArray:
    """Return time stamps in s, (n,)."""
    _, written = _unit_of(re.split(r"[/.]", name)[-1], unit)
    to_si = conversion(written, "s") if written else None
    if to_si is None:
        notes.append(f"the time {clean(name)} has no unit; s assumed, another by a mapping")
        return stamps
    return to_si.apply(stamps)
