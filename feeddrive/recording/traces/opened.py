"""A file of any trace format, opened: recognised by its content, read, and made channels of."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.files.channel_mapping import FileMapping, Hold, Variable
from feeddrive.recording.files.opening import FileContent, decode, head_of, is_hdf5
from feeddrive.recording.formats import (
    halscope,
    hdf5_file,
    matlab5,
    mdf4,
    parquet,
    sinumerik_edge,
    sinumerik_frf,
    sinumerik_trace,
    sinumerik_trace_table,
    tdms,
    tncscope,
    twincat,
)
from feeddrive.recording.frequency_response import FrequencyResponse, read_response, recognises_response
from feeddrive.recording.traces.channel_choice import Choice, Pick, Wishes, choose
from feeddrive.recording.traces.resampling import Series, gaps, on_one_grid, part_read, parts_of, same_time
from feeddrive.recording.traces.trace import Signal, Trace, clean
from feeddrive.typing import FloatArray

_FEWEST_STAMPS = 100
_Reader = Callable[[str, str, Wishes], Trace]
_TEXTS: tuple[tuple[Callable[[str], bool], _Reader], ...] = (
    (twincat.recognises, lambda text, where, wishes: twincat.read(text, where)),
    (sinumerik_edge.recognises, lambda text, where, wishes: sinumerik_edge.read(text, where, wishes.sample_time)),
    (
        sinumerik_edge.recognises_table,
        lambda text, where, wishes: sinumerik_edge.read_table(text, where, wishes.sample_time),
    ),
    (tncscope.recognises, lambda text, where, wishes: tncscope.read(text, where)),
    (sinumerik_trace.recognises, lambda text, where, wishes: sinumerik_trace.read(text, where)),
    (sinumerik_trace_table.recognises, lambda text, where, wishes: sinumerik_trace_table.read(text, where)),
    (halscope.recognises, lambda text, where, wishes: halscope.read(text, where)),
    (
        halscope.recognises_sampler,
        lambda text, where, wishes: halscope.read_sampler(text, where, wishes.sample_time, wishes.columns),
    ),
)


@dataclass(frozen=True, eq=False)
class Understood:
    """A trace and what it was taken for.

    Attributes:
        trace: as read.
        choice: signals for channels.
        time: of the channels, (n,) [s].
        channels: SI, (n,) each; empty where a question has to be answered first.
        notes: what was found, assumed and done.
    """

    trace: Trace
    choice: Choice
    time: FloatArray
    channels: dict[str, FloatArray]
    notes: tuple[str, ...]


def could_be_trace(start: bytes) -> bool:
    """Whether the first bytes of a file are those of a known trace format; `read_trace` then reads the file whole."""
    if is_hdf5(start) or any(known.recognises(start) for known in (matlab5, tdms, mdf4, parquet)):
        return True
    head = head_of(start)
    return recognises_response(head) or sinumerik_frf.recognises(head) or any(known(head) for known, _ in _TEXTS)


def read_trace(content: FileContent, wishes: Wishes) -> Trace | FrequencyResponse | None:
    """Read a file of a known trace format; None if it is none of them.

    Raises:
        InputError: the file is of a known format and cannot be used.
    """
    where = str(content.path)
    binary = _binary(content, wishes)
    if binary is not None:
        return _usable(binary, where)
    head = head_of(content.data)
    if recognises_response(head):
        return read_response(content)
    if sinumerik_frf.recognises(head):
        return sinumerik_frf.read(content, decode(content)[0])
    for recognises, read in _TEXTS:
        if recognises(head):
            text, remarks = decode(content)
            trace = read(text, where, wishes)
            if not text.endswith("\n") and not text.endswith(("}", ">")):  # JSON and XML tell their end
                remarks = (*remarks, "the file does not end with a line end: its last value may be cut short")
            return _usable(replace(trace, notes=(*remarks, *trace.notes)), where)
    return None


def _clocks(signals: Sequence[Signal]) -> list[str]:
    """Say two clocks: rates that would be the same but for some parts per million."""
    first = next((signal for signal in signals if signal.time.size > _FEWEST_STAMPS and not gaps(signal.time)), None)
    for other in signals if first is not None else ():
        if other.time.size <= _FEWEST_STAMPS or gaps(other.time) or first is None:
            continue
        ratio = _mean_step(other) / _mean_step(first)
        whole = max(1.0, round(ratio)) if ratio >= 1.0 else 1.0 / max(1.0, round(1.0 / ratio))
        off = ratio / whole - 1.0
        # Stamps resolve the ratio to one of their digits over the length; below 1 ppm no quartz is meant.
        if 1e-6 < abs(off) < 1e-2 and abs(off) * (other.time.size - 1) > 0.5:
            return [
                f"two clocks: {other.name} is sampled {off * 1e6:+.0f} ppm slower than {first.name} by their stamps"
            ]
    return []


def _mean_step(signal: Signal) -> float:
    return float(signal.time[-1] - signal.time[0]) / (signal.time.size - 1)


def _binary(content: FileContent, wishes: Wishes) -> Trace | None:
    """Read a file of a binary format; None if it is none of them."""
    data = content.data
    if is_hdf5(data):
        return hdf5_file.read(content, wishes.sample_time)
    if matlab5.recognises(data):
        return matlab5.read(content, wishes.sample_time)
    if tdms.recognises(data):
        return tdms.read(content, wishes.sample_time)
    if mdf4.recognises(data):
        return mdf4.read(content)
    if parquet.recognises(data):
        return parquet.read(content, wishes.sample_time)
    return None


def understand(trace: Trace, wishes: Wishes, where: str) -> Understood:
    """Choose signals for channels and bring them onto one grid.

    Raises:
        InputError: what a person wishes is not there, or the signals cannot be brought together.
    """
    with np.errstate(over="ignore", invalid="ignore"):  # of values that no drive has; they are refused later
        choice = choose(trace, wishes, where)
    notes = [*trace.notes, *_timing_notes([pick.signal for pick in choice.picks] or trace.signals)]
    notes += [f"{pick.channel} from {pick.signal.name}: {pick.reason}" for pick in choice.picks]
    notes += [finding.text for finding in choice.findings]
    if choice.blocking or not choice.picks:
        return Understood(trace, choice, np.empty(0), {}, tuple(notes))
    series = {pick.channel: pick.series for pick in choice.picks}
    time, channels, remarks = _on_grid(series, wishes, where)
    return Understood(trace, choice, time, channels, (*notes, *remarks))


def _on_grid(
    series: dict[str, Series], wishes: Wishes, where: str
) -> tuple[FloatArray, dict[str, FloatArray], tuple[str, ...]]:
    """Return time and channels of one part on one grid, and what was done."""
    for channel, one in series.items():
        if not np.all(np.isfinite(one.values)):
            first = float(one.time[~np.isfinite(one.values)][0])
            what = f"{channel} holds a value that is not a number, at {first:.6g} s"
            raise InputError(what, where, "leave the channel out, or record again")
    parts = parts_of(series, where)
    number, part = part_read(parts, wishes.part, where)
    notes = []
    if len(parts) > 1:
        longest = "" if wishes.part else ", the longest"
        notes.append(
            f"lost stretches leave {len(parts)} parts; part {number}{longest} is read: {part.start:.6g} s to "
            f"{part.stop:.6g} s; another by --part"
        )
    time, channels, remarks = on_one_grid(series, part, wishes.rate, where)
    return time, channels, (*notes, *remarks)


def columns_of(understood: Understood, where: str, of_command: str = "") -> dict[str, FloatArray]:
    """Return the canonical columns of what a trace was taken for, `time` first.

    `of_command` has the options that settle a question, where it is not the one at hand. Raises InputError: a question
    has to be answered first, or nothing was found that has a channel.
    """
    if understood.choice.blocking:
        what = understood.choice.blocking
        problem, _, option = what.partition(": ")
        raise InputError(problem, where, option + of_command)
    if not understood.channels:
        names = ", ".join(signal.name for signal in understood.trace.signals[:8])
        what = f"no signal of this {understood.trace.format} is known by its name (it holds {names})"
        mend = (
            "say which is which in a mapping file, --map, or by --channel 'motor_torque=NAME [N m]' of feeddrive read"
        )
        raise InputError(what, where, mend)
    return {"time": understood.time, **understood.channels}


def mapped(trace: Trace, mapping: FileMapping, where: str) -> Understood:
    """Take the signals that a mapping names, and bring them onto one grid.

    Raises:
        InputError: a signal that is absent, signals that are multiplied and were not sampled together.
    """
    by_name = {signal.name: signal for signal in trace.signals}
    series = {}
    picks: list[Pick] = []
    for channel, variable in mapping.channels.items():
        factors = [_named(name, by_name, where, variable.column) for name in variable.names]
        if mapping.time is not None:
            clock = _named(mapping.time.names[0], by_name, where, mapping.time.column)
            factors = [replace(one, time=_clock(clock, mapping.time, one, where)) for one in factors]
        if any(not same_time(one.time, factors[0].time) for one in factors):
            what = "signals that are multiplied were not sampled together"
            raise InputError(what, f"{where}, {' * '.join(variable.names)}", "map signals of one time")
        product = np.full(factors[0].values.size, variable.factor)
        for one in factors:
            product = product * one.values
        values = variable.conversion.apply(product)
        values = values + variable.offset if variable.offset else values
        if variable.hold is Hold.INTERVAL_BEFORE:
            values = np.concatenate((values[1:], values[-1:]))
        series[channel] = Series(factors[0].time, values)
        factor = variable.factor * variable.conversion.factor
        picks.append(Pick(channel, factors[0], "", factor, variable.offset, "by the mapping"))
    wishes = Wishes(rate=mapping.rate, part=mapping.part)
    if not all(pick.signal.timed for pick in picks) and mapping.time is None and mapping.sample_time is None:
        raise InputError(f"this {trace.format} holds no time", where, "add sample_time or [time] to the mapping")
    time, channels, notes = _on_grid(series, wishes, where)
    timing = _timing_notes([pick.signal for pick in picks])
    remarks = (f"read through the mapping {mapping.name}", *trace.notes, *timing, *notes)
    return Understood(trace, Choice("", tuple(picks), (), ()), time, channels, remarks)


def _named(name: str, by_name: dict[str, Signal], where: str, column: int) -> Signal:
    """Return a signal, or a column of a matrix."""
    if name not in by_name and f"{name} column {column}" in by_name:
        return by_name[f"{name} column {column}"]
    if name not in by_name:
        near = difflib.get_close_matches(name, by_name, n=1, cutoff=0.6)
        mend = f'did you mean "{near[0]}"?' if near else f"it holds {', '.join(list(by_name)[:12])}"
        raise InputError(f'no signal "{clean(name)}"', where, mend)
    return by_name[name]


def _clock(clock: Signal, variable: Variable, signal: Signal, where: str) -> FloatArray:
    if clock.values.size != signal.values.size:
        what = f'"{signal.name}" has {signal.values.size} values, the time "{clock.name}" {clock.values.size}'
        raise InputError(what, where, "map variables of the same length")
    stamps = variable.conversion.apply(variable.factor * clock.values) + variable.offset
    if not np.all(np.diff(stamps) > 0.0):
        raise InputError(f'the time "{clock.name}" does not increase', where, "name another variable in [time]")
    return stamps


def _usable(trace: Trace, where: str) -> Trace:
    if not trace.signals:
        raise InputError("the file holds no signal", where, "record again or name another file")
    return trace


def _timing_notes(signals: Sequence[Signal]) -> list[str]:
    """Say lost stretches, starts before zero and rates."""
    notes = []
    seen: list[FloatArray] = []
    for signal in signals:
        if any(signal.time is time for time in seen) or signal.time.size < 2:
            continue
        seen.append(signal.time)
        lost = gaps(signal.time)
        if lost:
            first = lost[0]
            many = f", and {len(lost) - 1} more" if len(lost) > 1 else ""
            notes.append(
                f"{first[1]} samples are missing behind row {first[0] + 1} of {signal.name}, at "
                f"{signal.time[first[0]]:.6g} s{many}"
            )
        if signal.time[0] < 0.0:
            notes.append(f"{signal.name} begins at {signal.time[0] * 1e3:.6g} ms, before zero")
    notes += _clocks(signals)
    steps = sorted({float(f"{signal.step:.6g}") for signal in signals if signal.step > 0.0})
    if len(steps) > 1:
        notes.append("sampled at different rates: every " + ", ".join(f"{step * 1e3:.6g} ms" for step in steps))
    return notes
