"""NI TDMS: channels with their property `unit_string`, and the clock of their waveform properties."""

from __future__ import annotations

import io
import logging
import warnings
from typing import Any

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.files.opening import FileContent
from feeddrive.recording.traces.container import optional, trace_of
from feeddrive.recording.traces.naming import axis_in, plain_words
from feeddrive.recording.traces.trace import Signal, Trace, clean, unique_names
from feeddrive.typing import FloatArray

NAME = "TDMS file"


def recognises(data: bytes) -> bool:
    """Tell by its first bytes whether a file is TDMS."""
    return data.startswith(b"TDSm")


def read(content: FileContent, sample_time: float | None) -> Trace:
    """Read all numeric channels.

    Raises:
        InputError: npTDMS is not installed, a damaged file, nothing numeric.
    """
    where = str(content.path)
    library = optional("nptdms", "npTDMS", "TDMS files", where)
    for name in [name for name in logging.root.manager.loggerDict if name.startswith("nptdms")]:
        logging.getLogger(name).setLevel(logging.CRITICAL)  # each of its modules has a level of its own
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of the library, about a last segment that was cut short
            file = library.TdmsFile.read(io.BytesIO(content.data))
            channels = [(group.name, channel) for group in file.groups() for channel in group.channels()]
            read_ = [(group, channel, _values(channel)) for group, channel in channels]
    except Exception as error:  # the library meets damage with errors of every kind
        raise InputError(f"is a damaged {NAME}", where, "copy or save it again") from error
    numeric = [(group, channel, values) for group, channel, values in read_ if values is not None and values.size > 1]
    several = len({group for group, _, _ in numeric}) > 1
    names = unique_names([f"{group}/{channel.name}" if several else str(channel.name) for group, channel, _ in numeric])
    if not any(_step(channel) for _, channel, _ in numeric):
        arrays = {name: values for name, (_, _, values) in zip(names, numeric, strict=True)}
        units = {name: _unit(channel) for name, (_, channel, _) in zip(names, numeric, strict=True)}
        return trace_of(NAME, arrays, units, sample_time, where)
    times: dict[tuple[float, float, int], FloatArray] = {}
    signals = []
    starts = [start for _, channel, _ in numeric if (start := _start(channel)) is not None]
    first = min(starts, default=0.0)
    for name, (group, channel, values) in zip(names, numeric, strict=True):
        step = _step(channel) or sample_time or 0.0
        offset = _number(channel.properties.get("wf_start_offset", 0.0))
        begin = _start(channel)
        key = (step, offset + ((begin - first) if begin is not None else 0.0), values.size)
        if key not in times:
            times[key] = key[1] + (step or 1.0) * np.arange(values.size, dtype=np.float64)
        about = clean(f"{group} {channel.properties.get('description', '')}")
        signals.append(
            Signal(name, times[key], values, _unit(channel), axis_in(name, plain_words(about)), about, timed=step > 0.0)
        )
    return Trace(NAME, tuple(signals))


def _values(channel: Any) -> FloatArray | None:
    raw = channel[:]
    return np.ascontiguousarray(raw, dtype=np.float64) if getattr(raw, "dtype", np.dtype("O")).kind in "fiub" else None


def _step(channel: Any) -> float:
    step = _number(channel.properties.get("wf_increment", 0.0))
    return step if 1e-9 < step < 1e6 else 0.0


def _start(channel: Any) -> float | None:
    """Return the start of a waveform [s], in any common zero; None if it has none."""
    start = channel.properties.get("wf_start_time")
    if not isinstance(start, np.datetime64) or np.isnat(start):
        return None
    return float((start - np.datetime64("2000-01-01T00:00:00", "us")) / np.timedelta64(1, "us")) * 1e-6


def _unit(channel: Any) -> str:
    return str(channel.properties.get("unit_string", "") or "")


def _number(value: Any) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        return 0.0
