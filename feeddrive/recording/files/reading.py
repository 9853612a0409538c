"""Reading a recording: open, understand, convert, check, and say what was found."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from feeddrive.errors import InputError, printable, quoted
from feeddrive.recording.channels import Heading, read_heading
from feeddrive.recording.checks.find_flaws import find_flaws
from feeddrive.recording.checks.flaws import filled, sample_notes, sentence
from feeddrive.recording.checks.unusable_samples import (
    check_alive,
    check_finite,
    check_length,
    check_sample_time,
    check_size,
    check_time,
    clock_notes,
    mean_sample_time,
)
from feeddrive.recording.files.cells import with_dates
from feeddrive.recording.files.channel_mapping import FileMapping, read_mapping
from feeddrive.recording.files.csv_file import Layout, TextTable, find_table, is_number
from feeddrive.recording.files.foreign import mapped_columns, read_variables, table_variables
from feeddrive.recording.files.opening import FileContent, TextFile, first_bytes, open_file
from feeddrive.recording.formats import matlab5
from feeddrive.recording.frequency_response import FrequencyResponse
from feeddrive.recording.recording import Recording
from feeddrive.recording.traces.channel_choice import Wishes
from feeddrive.recording.traces.opened import Understood, columns_of, could_be_trace, mapped, read_trace, understand
from feeddrive.recording.traces.trace import Trace
from feeddrive.typing import FloatArray

OF_READ = " of feeddrive read, whose --out is a recording that every command takes"
"""Other commands have no options for what a trace file leaves open; one of them even has another --axis."""


def read_recording(path: Path, mapping: Path | None = None, *, decimal: str | None = None) -> Recording:
    """Read and check a recording.

    Args:
        path: .csv or .csv.gz with headings `name [unit]`, a trace file of a drive or control, or with a mapping a .mat
            or foreign text file.
        mapping: mapping file; None for files with canonical headings.
        decimal: "." or ","; None to find it in the file.

    Raises:
        InputError: the file cannot be used; one line with file, row, column, reason and mend.
    """
    path = Path(path)
    if decimal not in (None, ".", ","):
        raise InputError(f"{decimal!r} is not a decimal sign", "--decimal", "write . or ,")
    known = read_mapping(Path(mapping)) if mapping is not None else None
    start = first_bytes(path)
    if could_be_trace(start) and not mapped_by_variables(path, start, known):
        content = open_file(path)
        trace = read_trace(content, Wishes(sample_time=known.sample_time if known else None))
        if trace is not None:
            return _checked(content, *_traced(content, trace, known))
    source = TextFile(path) if path.suffix != ".mat" else open_file(path)
    if known is not None:
        columns, first_row, notes = _foreign(source, known, decimal)
    else:
        columns, first_row, notes = _canonical(source, decimal)
    return _checked(source, columns, first_row, notes)


def mapped_by_variables(path: Path, start: bytes, mapping: FileMapping | None) -> bool:
    """Tell whether a mapping names variables of a .mat file, single numbers and a time among them, and not its signals.

    `start` are the first bytes of the file. Raises InputError for a damaged one.
    """
    if mapping is None or not matlab5.recognises(start):
        return False
    if mapping.time is not None:
        return True
    held = {signal.name for signal in matlab5.read(open_file(path), mapping.sample_time).signals}
    return not all(name in held for variable in mapping.channels.values() for name in variable.names)


def _traced(
    content: FileContent, trace: Trace | FrequencyResponse, mapping: FileMapping | None
) -> tuple[dict[str, FloatArray], int, tuple[str, ...]]:
    """Return the columns of a trace file, the row they begin in (its own has no meaning any more), and notes."""
    where = str(content.path)
    if isinstance(trace, FrequencyResponse):
        mend = "lay it over the machine's by feeddrive bode PLANT --recording FILE"
        raise InputError("is a frequency response, not a recording over time", where, mend)
    understood = mapped(trace, mapping, where) if mapping is not None else understand(trace, Wishes(), where)
    return columns_of(understood, where, OF_READ), 1, (trace.format, *understood.notes)


def checked_trace(content: FileContent, understood: Understood) -> Recording:
    """Check the channels of a trace file and make the recording.

    Raises:
        InputError: a question about the file has to be answered first, or as `read_recording`.
    """
    columns = columns_of(understood, str(content.path))
    return _checked(content, columns, 1, (understood.trace.format, *understood.notes))


def _canonical(
    source: TextFile | FileContent, decimal: str | None
) -> tuple[dict[str, FloatArray], int, tuple[str, ...]]:
    """Return the columns of a file with canonical headings, the row they begin in, and notes."""
    where = str(source.path)
    if isinstance(source, FileContent):
        held = ", ".join(quoted(name, 40) for name in list(read_variables(source))[:12])
        raise InputError(f"a .mat file has no units (it holds {held})", where, "name its mapping file by --map")
    text_table, dated = with_dates(find_table(source.blocks(), Layout(), where))
    headings = _headings(text_table, where)
    table = text_table.numbers(decimal)
    columns = dict(zip((heading.channel for heading in headings), table.columns, strict=True))
    with np.errstate(all="ignore"):  # a number beyond all bounds is refused where its row is known
        for heading in headings:
            columns[heading.channel] = heading.conversion.apply(columns[heading.channel])
    return columns, table.first_row, (*source.notes, *dated, *table.notes)


def _headings(table: TextTable, where: str) -> list[Heading]:
    """Return the headings of a file with canonical channels."""
    if all(is_number(name) for name in table.names):
        mend = f'put one above the numbers, e.g. "time [s]{table.separator}motor_torque [N m]"'
        raise InputError("there is no header row", where, mend)
    if len(table.names) == 1 and " " in table.names[0].split("[")[0].strip():  # a line of text, as loggers write above
        mend = "put # before the lines above the headings, or name their row by a mapping: [file] header_row"
        raise InputError(f'"{quoted(table.names[0], 40)}" is no row of headings', where, mend)
    headings = [read_heading(name, where) for name in table.names]
    seen: set[str] = set()
    for heading in headings:
        if heading.channel in seen:
            raise InputError(f'two columns "{heading.channel}"', where, "keep one of them")
        seen.add(heading.channel)
    if "time" not in seen:
        raise InputError("there is no time column", where, 'add "time [s]", or name a mapping with sample_time')
    return headings


def _foreign(
    source: TextFile | FileContent, mapping: FileMapping, decimal: str | None
) -> tuple[dict[str, FloatArray], int, tuple[str, ...]]:
    """Return the columns of a foreign file, the row they begin in (1 in a .mat file), and notes."""
    where = str(source.path)
    note = f"read through the mapping {printable(mapping.name)}"
    if isinstance(source, FileContent):
        return mapped_columns(read_variables(source), mapping, where), 1, (note,)
    table = find_table(source.blocks(), mapping.layout, where).numbers(decimal or mapping.layout.decimal)
    notes = (note, *source.notes, *table.notes)
    return mapped_columns(table_variables(table), mapping, where), table.first_row, notes


def _checked(
    source: TextFile | FileContent, columns: dict[str, FloatArray], first_row: int, notes: tuple[str, ...]
) -> Recording:
    """Check the columns and make the recording."""
    where = str(source.path)
    check_length(columns["time"].size, where)
    for name, samples in columns.items():
        check_finite(samples, name, first_row, where)
        check_size(samples, name, first_row, where)
    time = columns.pop("time")
    if not columns:
        raise InputError("there is no channel beside the time", where, 'add e.g. "motor_torque [N m]"')
    check_time(time, first_row, where)
    sample_time = mean_sample_time(time)
    check_sample_time(sample_time, where)
    check_alive(columns, where)
    columns, derived = with_angle(columns, time)
    flaws = find_flaws(columns, sample_time, first_row, where)
    columns = filled(columns, flaws)
    found = (
        *notes,
        *derived,
        *clock_notes(time, sample_time),
        *sample_notes(columns),
        *(sentence(one, first_row) for one in flaws),
    )
    name = printable(source.path.name)
    return Recording(name, time, columns, sample_time, where, source.sha256, found, tuple(flaws))


def with_angle(columns: dict[str, FloatArray], time: FloatArray) -> tuple[dict[str, FloatArray], tuple[str, ...]]:
    """Return columns, SI, (n,) each, with the motor angle where only its speed was recorded, and a note on it.

    The angle is the integral by the trapezoidal rule, zero at the first sample: it has no relation to a position on the
    screw from one recording to the next, and an offset of the speed makes it drift.
    """
    if "motor_speed" not in columns or "motor_angle" in columns or "table_position" in columns:
        return columns, ()
    speed = columns["motor_speed"]
    angle = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))))
    note = "motor_angle is the integral of motor_speed: its zero is that of the recording, an offset makes it drift"
    return {**columns, "motor_angle": angle}, (note,)
