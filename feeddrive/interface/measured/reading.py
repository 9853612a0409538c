"""Recordings from files."""

from __future__ import annotations

from pathlib import Path

from feeddrive.errors import InputError
from feeddrive.recording import Recording, read_recording
from feeddrive.recording.files.opening import open_file
from feeddrive.recording.frequency_response import FrequencyResponse
from feeddrive.recording.traces.channel_choice import Wishes
from feeddrive.recording.traces.opened import read_trace


def read(path: str | Path, map: str | Path | None = None, decimal: str | None = None) -> Recording:
    """A recording of a file.

    Args:
        path: CSV or CSV.gz with a header `name [unit]`, or with a mapping a `.mat` or foreign text file.
        map: mapping file, channel to column, factor and unit.
        decimal: "." or ","; found in the file if left out.

    Raises:
        InputError: the file cannot be used; one line with file, row, column, reason and the remedy.
    """
    for given, name in ((path, "path"), (map, "map")):
        if given is not None and not isinstance(given, str | Path):
            raise InputError(f"{given!r} is no path", name, "give a string or a pathlib.Path")
    return read_recording(Path(path), None if map is None else Path(map), decimal=decimal)


def as_recording(given: Recording | str | Path, where: str) -> Recording:
    """A recording, read where a path is given.

    Raises:
        InputError: neither a recording nor a path, or as `read`.
    """
    if isinstance(given, Recording):
        return given
    if isinstance(given, str | Path):
        return read(given)
    raise InputError(f"{type(given).__name__} is no recording", where, "give fd.read(...), or the path of a file")


MOST_BYTES = 20_000_000
"""A larger file is no frequency response: a million lines of them are half of that."""


def read_response_file(path: Path) -> FrequencyResponse | None:
    """The frequency response of a file; None where it is something else.

    Raises:
        InputError: no such file, or a frequency response that cannot be used.
    """
    if path.is_file() and path.stat().st_size > MOST_BYTES:
        return None
    found = read_trace(open_file(path), Wishes())
    return found if isinstance(found, FrequencyResponse) else None
