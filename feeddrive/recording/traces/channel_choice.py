"""Which signals of a trace become which channels: axis, names, units; what cannot be settled is asked for.

A slow bus holds samples in a fast file: a channel that changes only every k-th row. Read as they stand they are a
staircase, late by half its step on average, and their derivative is a comb. So the channel is read at its updates
alone, with their times.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.channels import channel_unit
from feeddrive.recording.traces.inference import Finding, infer
from feeddrive.recording.traces.naming import MOTOR_SIDE, Candidate, candidate, conversion, is_rotary, known_unit
from feeddrive.recording.traces.resampling import Part, Series, part_read, parts_of
from feeddrive.recording.traces.trace import Signal, Trace
from feeddrive.units.quantity import format_quantity

_FEWEST = 30  # updates; fewer can stand k rows apart by chance
_REGULAR = 0.8  # of the steps between changes; an update that brings the same value doubles one
_STEPS = 5  # different sizes of change; an encoder that moves evenly steps by one count in even times


def held_rows(signal: Signal) -> int:
    """Return every how many rows a signal is updated; 1 where it is in every row or unknown."""
    changes = np.flatnonzero(np.diff(signal.values) != 0.0) + 1
    if changes.size < _FEWEST:
        return 1
    between = np.diff(changes)
    counts = np.bincount(between[between <= 1000], minlength=2)
    rows = int(np.argmax(counts))
    if rows < 2 or counts[rows] < _REGULAR * between.size or int(between.min()) < rows:
        return 1
    if np.any(between % rows):  # out of step: a clock of its own, and no grid of rows
        return 1
    sizes = np.abs(np.diff(signal.values)[changes - 1])
    distinct = np.unique(np.round(sizes / float(np.max(sizes)), 6)).size
    return rows if distinct >= _STEPS else 1


def at_updates(signal: Signal) -> tuple[Signal, str]:
    """Return a signal at its updates alone, and a note; the signal itself and nothing where none is held."""
    rows = held_rows(signal)
    if rows == 1:
        return signal, ""
    first = int(np.flatnonzero(np.diff(signal.values) != 0.0)[0] + 1) % rows
    kept = slice(first, None, rows)
    every = f"{rows} rows, {rows * signal.step * 1e3:.6g} ms"
    note = f"{signal.name} is updated every {every}: held samples of a slow bus; read at its updates"
    return replace(signal, time=signal.time[kept], values=signal.values[kept]), note


_FAMILIES = (
    ("table_position", "motor_angle", MOTOR_SIDE, "motor_speed", "table_velocity"),
    ("motor_torque", "motor_current", "motor_torque_share"),
)
"""Channels of which a recording needs one: what moved, and what drove it."""

_SAMPLED = frozenset(channel for family in _FAMILIES for channel in family)
"""Channels whose samples a slow bus may hold; a set-point may rightly stand still."""


@dataclass(frozen=True)
class Wishes:
    """What a person says about a trace file.

    Attributes:
        axis: that is read, as the file names it; None to take the file's.
        lead: travel per motor revolution [m]; makes a motor angle of a motor encoder counted in the unit of the axis.
        channels: canonical channel -> name of its signal and its unit; the unit is empty where the file holds it.
        rate: samples per second; None for that of the slowest channel.
        part: stretch between gaps, 1 for the first; None for the longest.
        sample_time: [s], where the file holds none.
        columns: names of columns that the file does not name.
    """

    axis: str | None = None
    lead: float | None = None
    channels: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    rate: float | None = None
    part: int | None = None
    sample_time: float | None = None
    columns: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Pick:
    """A signal taken for a channel: SI value = factor * value + offset.

    Attributes:
        channel: canonical channel.
        signal: taken for it.
        unit: of its values.
        factor: to SI, the lead and a sign included.
        offset: to SI.
        reason: why, and how the unit is known.
    """

    channel: str
    signal: Signal
    unit: str
    factor: float
    offset: float
    reason: str

    @property
    def series(self) -> Series:
        """Its samples in SI."""
        exact = self.signal.values if self.factor == 1.0 else self.signal.values * self.factor
        inverse = 1.0 / self.factor
        if inverse.is_integer():  # 20 / 1e6 is the double nearest to 2e-5, 20 * 1e-6 is not
            exact = self.signal.values / inverse
        return Series(self.signal.time, exact + self.offset if self.offset else exact)


@dataclass(frozen=True, eq=False)
class Choice:
    """What a trace was understood as.

    Attributes:
        axis: that was read; empty where the file names none.
        picks: the channels.
        questions: what cannot be settled, each with the option that settles it.
        findings: what the signals say about each other.
        blocking: first question without whose answer there is no recording; empty if there is none.
    """

    axis: str
    picks: tuple[Pick, ...]
    questions: tuple[str, ...]
    findings: tuple[Finding, ...]
    blocking: str = ""


def choose(trace: Trace, wishes: Wishes, where: str) -> Choice:
    """Choose signals for channels.

    Raises:
        InputError: an axis, a signal or a unit that the person names and the file does not have.
    """
    axis, question = _axis(trace, wishes, where)
    measured = [signal for signal in trace.signals if signal.kind != "time"]
    signals = [signal for signal in measured if signal.axis in ("", axis)] if not question else []
    named = _wished(trace, wishes, where)
    open_: dict[str, list[tuple[Signal, Candidate]]] = {}
    for signal in signals:
        found = candidate(signal)
        if found is not None and found.channel not in named and not _of_rotary(found, axis):
            open_.setdefault(found.channel, []).append((signal, found))
    questions = [question] if question else []
    taken: dict[str, tuple[Signal, Candidate]] = dict(named)
    undecided: dict[str, str] = {}
    for channel, among in open_.items():
        best = min(found.rank for _, found in among)
        first = [pair for pair in among if pair[1].rank == best]
        if len(first) > 1:
            names = " and ".join(f'"{signal.name}"' for signal, _ in first[:3]) + (" ..." if len(first) > 3 else "")
            undecided[channel] = f"{names} may be {channel}: say which by --channel '{channel}={first[0][0].name}'"
            continue
        taken[channel] = first[0]
    held: list[str] = []
    for channel in set(taken) & _SAMPLED:
        signal, chosen = taken[channel]
        plain, note = at_updates(signal)
        taken[channel] = plain, chosen
        held += [note] if note else []
    findings, taken = _inferred(taken, signals, set(named), wishes.part, where)
    picks: list[Pick] = []
    for channel, (signal, found) in taken.items():
        pick, asked = _pick(channel, signal, found, wishes.lead)
        if pick is not None:
            picks.append(pick)
        else:
            undecided[channel] = asked
    questions += undecided.values()
    if wishes.sample_time is None and any(not pick.signal.timed for pick in picks):
        lacks = next((pick.signal.lacks for pick in picks if pick.signal.lacks), "the file holds no time")
        questions.insert(0, f"{lacks}: say the distance of its samples by --sample-time '1 ms'")
        return Choice(axis, tuple(picks), tuple(questions), findings, questions[0])
    findings = (*(Finding("held", note, 1.0, "", 0.0) for note in sorted(held)), *findings)
    return Choice(axis, tuple(picks), tuple(questions), findings, _blocking(picks, undecided, questions, signals))


def _inferred(
    taken: dict[str, tuple[Signal, Candidate]], signals: Sequence[Signal], fixed: set[str], part: int | None, where: str
) -> tuple[tuple[Finding, ...], dict[str, tuple[Signal, Candidate]]]:
    """Infer from the stretch that is read: across a lost one nothing holds."""
    series = {channel: Series(signal.time, signal.values) for channel, (signal, _) in taken.items()}
    if not series:
        return (), taken
    parts = parts_of(series, where)
    one = part_read(parts, part, where)[1]
    whole = {signal.name: signal for signal in signals} | {signal.name: signal for signal, _ in taken.values()}
    inside = {name: cut(signal, one) for name, signal in whole.items()}
    findings, found = infer(
        {channel: (inside[signal.name], chosen) for channel, (signal, chosen) in taken.items()},
        [inside[signal.name] for signal in signals],
        fixed,
    )
    return findings, {channel: (whole[signal.name], chosen) for channel, (signal, chosen) in found.items()}


def cut(signal: Signal, part: Part) -> Signal:
    """Return the samples of a signal within a part."""
    inside = (signal.time >= part.start) & (signal.time <= part.stop)
    return signal if inside.all() else replace(signal, time=signal.time[inside], values=signal.values[inside])


def _axis(trace: Trace, wishes: Wishes, where: str) -> tuple[str, str]:
    """Return the axis that is read and, where it is not known, the question."""
    axes = trace.axes
    if wishes.axis is not None:
        by_name = {axis.upper(): axis for axis in axes}
        if wishes.axis.upper() not in by_name:
            raise InputError(f"there is no axis {wishes.axis}", where, f"it has {', '.join(axes) or 'no named axes'}")
        return by_name[wishes.axis.upper()], ""
    wished = {name for name, _ in wishes.channels.values()}
    of_wished = {signal.axis for signal in trace.signals if signal.name in wished and signal.axis}
    if len(of_wished) == 1:
        return of_wished.pop(), ""
    useful = [axis for axis in axes if any(s.axis == axis and _useful(s, axis) for s in trace.signals)]
    if len(useful) > 1 and not wishes.channels:
        return "", f"it holds the axes {', '.join(useful)}: say which by --axis {useful[0]}"
    return (useful[0] if len(useful) == 1 else ""), ""


def _useful(signal: Signal, axis: str) -> bool:
    found = candidate(signal)
    return found is not None and not _of_rotary(found, axis)


def _of_rotary(found: Candidate, axis: str) -> bool:
    """A position or set-point of a rotary axis is an angle, and there is no channel for it."""
    if not is_rotary(axis) or found.stated:
        return False
    return found.channel in ("table_position", "setpoint", "table_velocity", MOTOR_SIDE)


def _wished(trace: Trace, wishes: Wishes, where: str) -> dict[str, tuple[Signal, Candidate]]:
    by_name = {signal.name: signal for signal in trace.signals}
    found = {}
    for channel, (name, unit) in wishes.channels.items():
        needed = channel_unit(channel, "--channel")
        if name not in by_name:
            near = difflib.get_close_matches(name, by_name, n=1, cutoff=0.5)
            mend = f'did you mean "{near[0]}"?' if near else "feeddrive read FILE shows their names"
            raise InputError(f'there is no signal "{name}"', where, mend)
        signal = by_name[name]
        given = unit or known_unit(signal.unit)
        if given and conversion(given, needed) is None:
            what = f'"{name}" is in {given}, which is no unit of {channel}'
            raise InputError(what, where, f"give its unit by --channel '{channel}={name} [{needed}]'")
        guess = candidate(signal)
        unit_of = given or (guess.unit if guess is not None and guess.channel == channel else "")
        found[channel] = signal, Candidate(channel, unit_of, "as told", -2, bool(given))
    return found


def _pick(channel: str, signal: Signal, found: Candidate, lead: float | None) -> tuple[Pick | None, str]:
    """Return a pick, or the question that has to be answered first."""
    if channel == MOTOR_SIDE:
        if lead is None:
            return None, f'"{signal.name}" is the {found.reason}: its motor_angle needs the lead, --lead "10 mm"'
        if not found.unit:
            what = f'is in "{found.foreign}", which is not known' if found.foreign else "has no unit"
            return None, f"\"{signal.name}\" {what}: say it by --channel 'table_position={signal.name} [mm]'"
        length = conversion(found.unit, "m")
        assert length is not None
        reason = f"{found.reason}, times 2 pi by the lead of {format_quantity(lead, 'm')}"
        return Pick("motor_angle", signal, found.unit, length.factor * 2.0 * math.pi / lead, 0.0, reason), ""
    needed = channel_unit(channel, "")
    if not found.unit:
        usual = {"m": "mm", "rad": "deg", "rad/s": "rev/min", "m/s": "mm/min"}.get(needed, needed)
        what = f'is in "{found.foreign}", which is not known' if found.foreign else "has no unit"
        return None, f"\"{signal.name}\" {what}: say it by --channel '{channel}={signal.name} [{usual}]'"
    to_si = conversion(found.unit, needed)
    assert to_si is not None  # candidates are checked against their units
    how = "" if found.stated or found.rank == -2 else f"; {found.unit} assumed, the file does not say"
    factor, offset = found.sign * to_si.factor, found.sign * to_si.offset
    return Pick(channel, signal, found.unit, factor, offset, found.reason + how), ""


def _blocking(picks: list[Pick], undecided: Mapping[str, str], questions: list[str], signals: list[Signal]) -> str:
    if not signals and questions:
        return questions[0]
    have = {pick.channel for pick in picks}
    for family in _FAMILIES:
        if not have & set(family):
            for channel in family:
                if channel in undecided:
                    return undecided[channel]
    return questions[0] if questions and not picks else ""
