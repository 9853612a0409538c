"""What files of named arrays (HDF5, MATLAB 7.3, Parquet, TDMS without a clock) share: which array is the time."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.files.opening import FileContent
from feeddrive.recording.traces.naming import axis_in
from feeddrive.recording.traces.stamps import clock_for, clocks_of, unit_of
from feeddrive.recording.traces.trace import Signal, Trace, clean, unique_names
from feeddrive.typing import FloatArray


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


def vectors(arrays: Mapping[str, Any]) -> dict[str, Any]:
    """Return the numeric vectors of a tree of arrays, (n,) each; columns of a matrix by name and number."""
    found: dict[str, Any] = {}
    for name, value in arrays.items():
        array = np.asarray(value)
        if array.dtype.kind not in "fiubMm" or array.size < 2:
            continue
        array = np.squeeze(array)
        if array.ndim == 1:
            found[name] = array
        elif array.ndim == 2 and min(array.shape) <= 64:
            tall = array if array.shape[0] >= array.shape[1] else array.T
            for column in range(tall.shape[1]):
                found[f"{name} column {column + 1}"] = tall[:, column]
    return found


@dataclass
class Tree:
    """What a file of nested structs holds; a path is written with dots.

    Attributes:
        arrays: path -> numbers.
        units: path -> unit, where the file says one at the array itself.
        texts: path -> text.
        objects: paths of what is there and cannot be read.
    """

    arrays: dict[str, Any] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    texts: dict[str, str] = field(default_factory=dict)
    objects: list[str] = field(default_factory=list)


def trace_of_tree(format_: str, tree: Tree, sample_time: float | None, where: str) -> Trace:
    """Return the trace of the numeric vectors of a tree.

    Raises:
        InputError: no numeric vector.
    """
    what = f"{', '.join(map(clean, tree.objects[:4]))}: a table, timetable or other object of MATLAB, which is not read"
    mend = "save its columns as vectors, in MATLAB s = table2struct(timetable2table(T), 'ToScalar', true)"
    arrays = vectors(tree.arrays)
    if not arrays and tree.objects:
        raise InputError(f"this {format_} holds {what}", where, mend)
    trace = trace_of(format_, *_called(arrays, tree), sample_time, where)
    return replace(trace, notes=(*trace.notes, f"{what}; {mend}")) if tree.objects else trace


def _called(arrays: dict[str, Any], tree: Tree) -> tuple[dict[str, Any], dict[str, str]]:
    """Return vectors and units by the names that a struct means: `rec.speed.data` with its unit is `rec.speed`."""
    found: dict[str, Any] = {}
    units: dict[str, str] = {}
    for path, values in arrays.items():
        whole, _, column = path.partition(" column ")
        place, _, last = whole.rpartition(".")
        name, unit = path, tree.units.get(whole, "")
        if place and last.lower() in _DATA:
            label = next((tree.texts[f"{place}.{key}"] for key in _LABELS if tree.texts.get(f"{place}.{key}")), "")
            name = place.removesuffix(".signals") + (f".{label}" if label else "") + (column and f" column {column}")
            unit = unit or next((tree.texts[f"{place}.{key}"] for key in _UNITS if f"{place}.{key}" in tree.texts), "")
        name = path if name in found or name in arrays else name
        found[name], units[name] = values, unit
    return found, units


_DATA = ("data", "value", "values", "samples", "y")
_LABELS, _UNITS = ("label", "name", "Name"), ("unit", "units", "Unit", "Units")


def trace_of(
    format_: str, arrays: Mapping[str, Any], units: Mapping[str, str], sample_time: float | None, where: str
) -> Trace:
    """Return the trace of named vectors: those of one length share the time vector of that length, of their own group.

    A signal that lacks values, as one that is sampled more slowly does in a joined table, has those that are there.

    Args:
        format_: what the file is, for people.
        arrays: name -> (n,), numbers; or dates, which are times.
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
    clocks = clocks_of(arrays, units, sample_time)
    notes = list(dict.fromkeys(clock.note for clock in clocks if clock.note))
    names = {clock.name: clock for clock in clocks}
    shared: dict[tuple[str, bytes], FloatArray] = {}
    counted: dict[int, FloatArray] = {}
    signals = []
    for name, plain in zip(arrays, unique_names([clean(name) for name in arrays]), strict=True):
        clock = names.get(name) or clock_for(name, arrays[name].size, clocks)
        fault = clock.fault if clock is not None else ""
        numbers = np.ascontiguousarray(arrays[name], dtype=np.float64)
        if clock is not None and not fault:
            time, numbers, timed = clock.time, numbers if clock.kept.all() else numbers[clock.kept], True
        else:
            time = counted.setdefault(numbers.size, np.arange(numbers.size, dtype=np.float64) * (sample_time or 1.0))
            timed = sample_time is not None
        there = ~np.isnan(numbers)
        if not there.all() and name not in names:
            if np.sum(there) < 2:
                notes.append(f"{plain} has no values and is left out")
                continue
            notes.append(f"{plain} lacks {int(np.sum(~there))} values")
            key = clock.name if clock is not None else "", there.tobytes()
            time, numbers = shared.setdefault(key, time[there]), numbers[there]
        shown, unit = unit_of(plain, units.get(name, ""))
        about, kind = shown if shown != plain else "", "time" if name in names else ""
        signals.append(Signal(plain, time, numbers, unit, axis_in(shown), about, kind, timed, fault))
    if all(signal.kind == "time" for signal in signals):
        raise InputError(f"this {format_} holds a time and no signal", where, "save the signals beside it")
    return Trace(format_, tuple(signals), tuple(notes))
