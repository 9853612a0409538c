"""Looking into a file of a drive, control or logger: how it is understood, and the recording made of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from feeddrive.errors import InputError
from feeddrive.interface.measured.inspected import Inspected
from feeddrive.interface.quantities import Quantity, positive
from feeddrive.recording.channels import channel_unit
from feeddrive.recording.files.channel_mapping import read_mapping
from feeddrive.recording.files.opening import FileContent, first_bytes, open_file
from feeddrive.recording.files.reading import checked_trace, mapped_by_variables, read_recording
from feeddrive.recording.frequency_response import FrequencyResponse
from feeddrive.recording.recording import Recording
from feeddrive.recording.traces.channel_choice import Wishes
from feeddrive.recording.traces.mapping_text import mapping_text
from feeddrive.recording.traces.opened import Understood, could_be_trace, mapped, read_trace, understand


def inspect(
    path: str | Path,
    map: str | Path | None = None,
    *,
    axis: str = "",
    lead: Quantity | None = None,
    channels: Mapping[str, str] | None = None,
    rate: Quantity | None = None,
    part: int | None = None,
    sample_time: Quantity | None = None,
    columns: Sequence[str] = (),
    decimal: str | None = None,
) -> Inspected:
    """What a file holds: format, signals, which channel each is taken for and why, and the recording made of it.

    Args:
        path: trace of a drive, control or logger, recording, or frequency response.
        map: mapping file, in place of the names.
        axis: of a file that holds several, such as "X1".
        lead: makes angles of motor encoders in mm.
        channels: channel to the signal that it is, and its unit, {"motor_torque": "NAME [N m]"}.
        rate: to resample to; that of the slowest channel if left out.
        part: stretch between gaps, 1 for the first; the longest if left out.
        sample_time: distance of samples where the file has no time.
        columns: names of columns without any.
        decimal: "." or "," of a CSV file, where the file leaves it open.

    Raises:
        InputError: a file or a wish that cannot be used.

    >>> import feeddrive as fd
    >>> found = fd.inspect("scenarios/recordings/demo.csv.gz")
    >>> found.kind, "motor_torque" in found.recording
    ('recording', True)
    """
    where = str(path)
    wishes = Wishes(
        axis or None,
        None if lead is None else positive(lead, "m", "lead", "10 mm"),
        _chosen(channels or {}),
        None if rate is None else positive(rate, "Hz", "rate", "1 kHz"),
        _part(part),
        None if sample_time is None else positive(sample_time, "s", "sample_time", "1 ms"),
        tuple(columns),
    )
    start = first_bytes(Path(path))
    known = None if map is None else read_mapping(Path(map))
    is_trace = could_be_trace(start) and not mapped_by_variables(Path(path), start, known)
    if known is not None and known.sample_time is not None and wishes.sample_time is None:
        wishes = Wishes(sample_time=known.sample_time, columns=wishes.columns)
    found = read_trace(content := open_file(Path(path)), wishes) if is_trace else None
    if isinstance(found, FrequencyResponse):
        return Inspected(Path(path), found.sha256, response=found)
    if found is None:
        given = {
            "axis": axis, "lead": lead, "channel": channels, "rate": rate, "part": part, "sample time": sample_time,
            "columns": columns,
        }  # fmt: skip
        if unused := [name for name, value in given.items() if value]:
            what = "has canonical headings, which say what is which" if known is None else "is read by a mapping"
            raise InputError(what, where, f"leave out {', '.join(unused)}, and correct the headings or the mapping")
        recording = read_recording(Path(path), None if map is None else Path(map), decimal=decimal)
        return Inspected(Path(path), recording.sha256, recording)
    understood = mapped(found, known, where) if known is not None else understand(found, wishes, where)
    made, fault = _recording_of(content, understood)
    text = ""
    if made is not None and known is None:
        text = mapping_text(understood.choice, wishes, made.sample_time, f"{found.format}: {Path(path).name}")
    return Inspected(Path(path), content.sha256, made, None, found, understood, fault, text)


def _recording_of(content: FileContent, understood: Understood) -> tuple[Recording | None, str]:
    """The recording, or why there is none."""
    try:
        return checked_trace(content, understood), ""
    except InputError as error:
        return None, str(error)


def _chosen(channels: Mapping[str, str]) -> dict[str, tuple[str, str]]:
    """Channel to signal and unit."""
    found = {}
    for channel, written in channels.items():
        text = written.strip()
        if not text:
            raise InputError(f'"{channel}" names no signal', "channel", "write 'motor_torque=NAME [N m]'")
        channel_unit(channel, "channel")
        found[channel] = text, ""
        if text.endswith("]") and "[" in text:
            name, _, unit = text[:-1].rpartition("[")
            if "," not in unit:  # else the name itself ends so
                found[channel] = name.strip(), unit.strip()
    return found


def _part(part: int | None) -> int | None:
    if part is not None and part < 1:
        raise InputError(f"there is no part {part}", "part", "1 is the first")
    return part
