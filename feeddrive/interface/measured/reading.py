"""Recordings from files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

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


LARGEST_DIAGNOSIS = 200_000_000
"""Bytes; the numbers of a diagnosis take some hundred thousand."""


def read_response_file(path: Path) -> FrequencyResponse | None:
    """The frequency response of a file; None where it is something else.

    Raises:
        InputError: no such file, or a frequency response that cannot be used.
    """
    if path.is_file() and path.stat().st_size > MOST_BYTES:
        return None
    found = read_trace(open_file(path), Wishes())
    return found if isinstance(found, FrequencyResponse) else None


def diagnosis_content(folder: Path) -> dict[str, Any]:
    """The content of `diagnosis.json` in the folder of a diagnosis.

    Raises:
        InputError: no folder that `feeddrive diagnose` has written.
    """
    where, mend = folder / "diagnosis.json", "name the folder that `feeddrive diagnose --out` has written"
    try:
        if where.stat().st_size > LARGEST_DIAGNOSIS:
            raise InputError("is too large for a diagnosis", str(where), mend)
        content = json.loads(where.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError("is no diagnosis", str(folder), mend) from None
    if not isinstance(content, dict) or not isinstance(content.get("effects", []), list):
        raise InputError("is no diagnosis", str(where), mend)
    found: dict[str, Any] = content
    return found
