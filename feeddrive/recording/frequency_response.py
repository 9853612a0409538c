"""A measured frequency response, and its file.

    # from = motor_torque, to = motor_speed
    frequency [Hz],magnitude [(rad/s)/(N m)],phase [deg],coherence [1]

Phases are written as they are; magnitudes are factors, not decibels.
"""

from __future__ import annotations

import gzip
import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from feeddrive.errors import InputError
from feeddrive.files import write_bytes_atomically
from feeddrive.recording.files.csv_file import Layout, find_table
from feeddrive.recording.files.opening import FileContent, decode
from feeddrive.typing import ComplexArray, FloatArray

_FIRST_COLUMN = re.compile(r'\s*"?frequency\s*\[', re.IGNORECASE)
_COLUMN = re.compile(r"\s*([a-z]+)\s*\[([^\]]*)\]\s*")
_SIDES = re.compile(r"#\s*from\s*=\s*([^,\n]+?)\s*,\s*to\s*=\s*([^,\n]+?)\s*$", re.MULTILINE)
FEWEST_LINES = 3


@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """Output per input over frequency.

    Attributes:
        name: file name, or what a person calls it.
        given, output: channels, such as motor_torque and motor_speed.
        unit: of the magnitude; empty if the file does not say.
        frequency: ascending, not negative [Hz], (n,).
        values: complex, (n,).
        coherence: 0 to 1, (n,); NaN where it is not known.
        notes: what was found and assumed on reading.
        source: where it was read from.
        sha256: checksum of the file as it was read; empty if there is none.

    Raises:
        InputError: arrays of different lengths, frequencies that do not ascend, values that are not finite or zero, a
            coherence outside of 0 to 1.
    """

    name: str
    given: str
    output: str
    unit: str
    frequency: FloatArray
    values: ComplexArray
    coherence: FloatArray
    notes: tuple[str, ...] = ()
    source: str = ""
    sha256: str = ""

    def __post_init__(self) -> None:
        where = self.source or self.name
        if not self.frequency.shape == self.values.shape == self.coherence.shape or self.frequency.ndim != 1:
            raise InputError("frequencies and values differ in number", where, "measure or export it again")
        if self.frequency.size < FEWEST_LINES:
            raise InputError(f"only {self.frequency.size} frequencies", where, "measure or export it again")
        if not (np.all(np.isfinite(self.frequency)) and np.all(np.isfinite(self.values))):
            raise InputError("a frequency or value is not finite", where, "measure or export it again")
        if self.frequency[0] < 0.0 or not np.all(np.diff(self.frequency) > 0.0):
            raise InputError("the frequencies do not ascend from zero or above", where, "sort the rows by frequency")
        if not np.all((self.values != 0) | (self.frequency == 0)):
            raise InputError("a magnitude is zero", where, "leave the line out, or measure or export it again")
        known = self.coherence[np.isfinite(self.coherence)]
        if np.any((known < 0) | (known > 1 + 1e-6)):
            raise InputError("a coherence is outside of 0 to 1", where, "correct it, or leave the column out")

    @property
    def positive(self) -> FrequencyResponse:
        """The response without the line at frequency zero, which no logarithmic axis has."""
        kept = self.frequency > 0.0
        return replace(self, frequency=self.frequency[kept], values=self.values[kept], coherence=self.coherence[kept])


def recognises_response(head: str) -> bool:
    """Tell by its first letters whether a text is a frequency response."""
    first = next((line for line in head.split("\n") if line.strip() and not line.lstrip().startswith("#")), "")
    return _FIRST_COLUMN.match(first) is not None


def read_response(content: FileContent) -> FrequencyResponse:
    """Read the CSV file of a frequency response.

    Raises:
        InputError: a column that is missing or has another unit, or as `FrequencyResponse`.
    """
    text, remarks = decode(content)
    where = str(content.path)
    table = find_table(iter((text,)), Layout(), where).numbers(None)
    columns: dict[str, tuple[str, FloatArray]] = {}
    for index, heading in enumerate(table.names):
        match = _COLUMN.fullmatch(heading)
        if match is None or match[1] not in ("frequency", "magnitude", "phase", "coherence"):
            known = "frequency [Hz],magnitude [...],phase [deg],coherence [1]"
            raise InputError(f'"{heading}" is not a column of a frequency response', where, f"write {known}")
        columns[match[1]] = match[2].strip(), table.columns[index]
    for name, unit in (("frequency", "Hz"), ("magnitude", ""), ("phase", "deg")):
        if name not in columns or (unit and columns[name][0] != unit):
            raise InputError(f"there is no column {name} [{unit or '...'}]", where, "add it, or correct its unit")
    sides = _SIDES.search(text)
    if sides is None:
        raise InputError(
            "the file does not say from which channel to which",
            where,
            "write above the header: # from = motor_torque, to = motor_speed",
        )
    frequency, (unit, magnitude), phase = columns["frequency"][1], columns["magnitude"], columns["phase"][1]
    if np.any(magnitude < 0):
        line = int(np.argmax(magnitude < 0))
        what = f"a magnitude is below zero, {magnitude[line]:.6g} at {frequency[line]:.6g} Hz"
        raise InputError(what, where, "write factors, not decibels, and the sign as a phase of 180 deg")
    coherence = columns["coherence"][1] if "coherence" in columns else np.full_like(frequency, np.nan)
    values = (magnitude * np.exp(1j * np.radians(phase))).astype(np.complex128)
    return FrequencyResponse(
        content.path.name,
        sides[1],
        sides[2],
        unit,
        frequency.copy(),
        values,
        coherence.copy(),
        (*remarks, *table.notes),
        where,
        content.sha256,
    )


def write_response(response: FrequencyResponse, path: Path) -> None:
    """Write a frequency response as .csv or .csv.gz, with every digit that a double needs.

    Raises InputError: another ending, or a place where nothing can be written.
    """
    if not path.name.endswith((".csv", ".csv.gz")):
        mend = "give the file one of these endings"
        raise InputError("frequency responses are written as .csv or .csv.gz", str(path), mend)
    columns = {
        "frequency [Hz]": response.frequency,
        f"magnitude [{response.unit}]": np.abs(response.values),
        "phase [deg]": np.degrees(np.angle(response.values)),
    }
    if not np.all(np.isnan(response.coherence)):
        columns["coherence [1]"] = response.coherence
    texts = [map(repr, samples.tolist()) for samples in columns.values()]
    rows = (f"# from = {response.given}, to = {response.output}", ",".join(columns))
    data = "\n".join((*rows, *map(",".join, zip(*texts, strict=True)), "")).encode("utf-8")
    write_bytes_atomically(path, gzip.compress(data, mtime=0) if path.suffix == ".gz" else data)
