"""Writing a recording as CSV, whole or not at all."""

from __future__ import annotations

import gzip
from pathlib import Path

from feeddrive.errors import InputError
from feeddrive.files import write_bytes_atomically
from feeddrive.recording.channels import channel_unit
from feeddrive.recording.recording import Recording


def write_recording(recording: Recording, path: Path) -> None:
    """Write a recording as .csv or .csv.gz with headings `name [unit]` in SI, and every digit that a double needs.

    Raises InputError: another ending, a channel that is not canonical, a place where nothing can be written.
    """
    where = str(path)
    if not path.name.endswith((".csv", ".csv.gz")):
        raise InputError("recordings are written as .csv or .csv.gz", where, "give the file one of these endings")
    columns = {"time": recording.time, **recording.channels}
    header = ",".join(f"{name} [{channel_unit(name, where)}]" for name in columns)
    # repr is the shortest text that reads back as the same double.
    texts = [map(repr, samples.tolist()) for samples in columns.values()]
    data = "\n".join((header, *map(",".join, zip(*texts, strict=True)), "")).encode("ascii")
    # No time stamp in the archive: the same recording gives the same file.
    write_bytes_atomically(path, gzip.compress(data, mtime=0) if path.suffix == ".gz" else data)
