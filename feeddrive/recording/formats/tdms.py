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
from feeddrive.recording.traces.naming import axis_in, conversion, known_unit, plain_words
from feeddrive.recording.traces.stamps import is_time
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
    values = {name: values for name, (_, _, values) in zip(names, numeric, strict=True)}
    units = {name: _unit(channel) for name, (_, channel, _) in zip(names, numeric, strict=True)}
    waves = {name: channel for name, (_, channel, _) in zip(names, numeric, strict=True) if _step(channel)}
    rest = {name: one for name, one in values.items() if name not in waves}
    plain = trace_of(NAME, rest, units, sample_time, where) if not waves or _signals(rest) else None
    if not waves and plain is not None:
        return plain
    times: dict[tuple[float, float, int], FloatArray] = {}
    signals = []
    starts = [start for channel in waves.values() if (start := _start(channel)) is not None]
    first = min(starts, default=0.0)
    for name, channel in waves.items():
        step, begin = _step(channel), _start(channel)
        offset = _number(channel.properties.get("wf_start_offset", 0.0)) * _seconds(channel)
        key = (step, offset + ((begin - first) if begin is not None else 0.0), values[name].size)
        if key not in times:
            times[key] = key[1] + step * np.arange(values[name].size, dtype=np.float64)
        about = clean(f"{channel.group_name} {channel.properties.get('description', '')}")
        axis = axis_in(name, plain_words(about))
        signals.append(Signal(name, times[key], values[name].astype(np.float64), units[name], axis, about))
    by_name = {signal.name: signal for signal in [*signals, *(plain.signals if plain is not None else ())]}
    return Trace(NAME, tuple(by_name[name] for name in names if name in by_name), plain.notes if plain else ())


def _signals(values: dict[str, Any]) -> bool:
    """Tell whether there is more than times."""
    return any(one.dtype.kind != "M" and not is_time(name) for name, one in values.items())


def _values(channel: Any) -> Any:
    raw = channel[:]
    return raw if getattr(raw, "dtype", np.dtype("O")).kind in "fiubM" else None


def _step(channel: Any) -> float:
    """Return the distance of a waveform's samples [s]; 0 where it has none, or is none over time."""
    step = _number(channel.properties.get("wf_increment", 0.0)) * _seconds(channel)
    unset = step == 1.0 and "wf_start_time" not in channel.properties  # what LabVIEW writes where nobody set it
    return step if 1e-9 < step < 1e6 and not unset else 0.0


def _seconds(channel: Any) -> float:
    """Return the seconds of a unit of a waveform's axis; 0 where it is none of time."""
    unit = str(channel.properties.get("wf_xunit_string", "") or "s")
    to_si = conversion(known_unit(unit) or unit, "s")
    return 0.0 if to_si is None else to_si.factor


def _start(channel: Any) -> float | None:
    """Return the start of a waveform [s], in any common zero; None if it has none."""
    start = channel.properties.get("wf_start_time")
    if not isinstance(start, np.datetime64) or np.isnat(start):
        return None
    return float((start - np.datetime64("2000-01-01T00:00:00", "us")) / np.timedelta64(1, "us")) * 1e-6


def _unit(channel: Any) -> str:
    return str(channel.properties.get("unit_string", "") or channel.properties.get("NI_UnitDescription", "") or "")


def _number(value: Any) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        return 0.0
