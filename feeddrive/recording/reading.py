"""Reading a recording: open, understand, convert, check, and say what was found."""

from __future__ import annotations

from pathlib import Path

from feeddrive.errors import InputError, printable
from feeddrive.recording.channels import Heading, read_heading
from feeddrive.recording.checks import check_alive, check_finite, check_length, check_sample_time, check_size
from feeddrive.recording.copies import refuse_copied_setpoint
from feeddrive.recording.csv_faults import is_number
from feeddrive.recording.csv_file import Layout, TextTable, find_table
from feeddrive.recording.derived import with_angle
from feeddrive.recording.find_flaws import find_flaws
from feeddrive.recording.findings import sample_notes
from feeddrive.recording.flaws import filled, sentence
from feeddrive.recording.foreign import mapped_columns, table_variables
from feeddrive.recording.formats.choosing import Wishes
from feeddrive.recording.formats.opened import Understood, columns_of, mapped, read_trace, understand
from feeddrive.recording.formats.trace import Trace
from feeddrive.recording.frequency_response import FrequencyResponse
from feeddrive.recording.mapping import FileMapping, read_mapping
from feeddrive.recording.mat_file import read_variables
from feeddrive.recording.opening import FileContent, decode, open_file
from feeddrive.recording.recording import Recording
from feeddrive.recording.time_checks import check_time, clock_notes, mean_sample_time
from feeddrive.typing import FloatArray


def read_recording(path: Path, mapping: Path | None = None, *, decimal: str | None = None) -> Recording:
    """Read and check a recording.

    Args:
        path: .csv or .csv.gz with headings `name [unit]`, a trace file of a drive or control, or with a mapping a .mat
            or foreign text file.
        mapping: mapping file; None for files with canonical headings.
        decimal: "." or ","; None to let the file tell.

    Raises:
        InputError: the file cannot be used; one line with file, row, column, reason and mend.
    """
    path = Path(path)
    if decimal not in (None, ".", ","):
        raise InputError(f"{decimal!r} is not a decimal sign", "--decimal", "write . or ,")
    known = read_mapping(Path(mapping)) if mapping is not None else None
    content = open_file(path)
    trace = read_trace(content, Wishes(sample_time=known.sample_time if known else None))
    if trace is not None:
        columns, first_row, notes = _traced(content, trace, known)
    elif known is not None:
        columns, first_row, notes = _foreign(content, known, decimal)
    else:
        columns, first_row, notes = _canonical(content, decimal)
    return _checked(content, columns, first_row, notes)


def _traced(
    content: FileContent, trace: Trace | FrequencyResponse, mapping: FileMapping | None
) -> tuple[dict[str, FloatArray], int, tuple[str, ...]]:
    """Return the columns of a trace file, the row they begin in (its own has no meaning any more), and notes."""
    where = str(content.path)
    if isinstance(trace, FrequencyResponse):
        mend = "lay it over the machine's by feeddrive bode PLANT --recording FILE"
        raise InputError("is a frequency response, not a recording over time", where, mend)
    understood = mapped(trace, mapping, where) if mapping is not None else understand(trace, Wishes(), where)
    return columns_of(understood, where), 1, (trace.format, *understood.notes)


def checked_trace(content: FileContent, understood: Understood) -> Recording:
    """Check the channels of a trace file and make the recording.

    Raises:
        InputError: a question about the file has to be answered first, or as `read_recording`.
    """
    columns = columns_of(understood, str(content.path))
    return _checked(content, columns, 1, (understood.trace.format, *understood.notes))


def _canonical(content: FileContent, decimal: str | None) -> tuple[dict[str, FloatArray], int, tuple[str, ...]]:
    """Return the columns of a file with canonical headings, the row they begin in, and notes."""
    where = str(content.path)
    if content.path.suffix == ".mat":
        held = ", ".join(list(read_variables(content))[:12])
        raise InputError(f"a .mat file has no units (it holds {held})", where, "name its mapping file by --map")
    text_table, said = _table(content, Layout())
    headings = _headings(text_table, where)
    table = text_table.numbers(decimal)
    columns = {}
    for index, heading in enumerate(headings):
        column = table.values[:, index].copy()
        columns[heading.channel] = heading.conversion.apply(column)
    return columns, table.first_row, (*said, *table.notes)


def _headings(table: TextTable, where: str) -> list[Heading]:
    """Return the headings of a file with canonical channels."""
    if all(is_number(name) for name in table.names):
        mend = f'put one above the numbers, e.g. "time [s]{table.separator}motor_torque [N m]"'
        raise InputError("there is no header row", where, mend)
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
    content: FileContent, mapping: FileMapping, decimal: str | None
) -> tuple[dict[str, FloatArray], int, tuple[str, ...]]:
    """Return the columns of a foreign file, the row they begin in (1 in a .mat file), and notes."""
    where = str(content.path)
    said = f"read through the mapping {mapping.name}"
    if content.path.suffix == ".mat":
        return mapped_columns(read_variables(content), mapping, where), 1, (said,)
    text_table, encoding = _table(content, mapping.layout)
    table = text_table.numbers(decimal or mapping.layout.decimal)
    notes = (said, *encoding, *table.notes)
    return mapped_columns(table_variables(table), mapping, where), table.first_row, notes


def _table(content: FileContent, layout: Layout) -> tuple[TextTable, tuple[str, ...]]:
    """Find the table of a text file; the second result are notes on its encoding."""
    text, said = decode(content)
    return find_table(text, layout, str(content.path)), said


def _checked(content: FileContent, columns: dict[str, FloatArray], first_row: int, notes: tuple[str, ...]) -> Recording:
    """Check the columns and make the recording."""
    where = str(content.path)
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
    refuse_copied_setpoint(columns, where)
    flaws = find_flaws(columns, sample_time, first_row, where)
    columns = filled(columns, flaws)
    found = (
        *notes,
        *derived,
        *clock_notes(time, sample_time),
        *sample_notes(columns),
        *(sentence(one, first_row) for one in flaws),
    )
    name = printable(content.path.name)
    return Recording(name, time, columns, sample_time, where, content.sha256, found, tuple(flaws))
