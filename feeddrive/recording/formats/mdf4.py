"""ASAM MDF, version 3 and 4: every numeric channel with its unit and the master of its group as its time."""

from __future__ import annotations

import importlib.util
import io
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

import feeddrive
from feeddrive.errors import InputError
from feeddrive.recording.files.opening import FileContent
from feeddrive.recording.formats import mdf4_worker
from feeddrive.recording.traces.container import not_installed
from feeddrive.recording.traces.naming import axis_in
from feeddrive.recording.traces.trace import Signal, Trace, clean, unique_names
from feeddrive.typing import FloatArray

NAME = "MDF file"
_LONGEST = 600.0  # s; a gigabyte takes ten, so more is a damaged file whose blocks run in a circle


def recognises(data: bytes) -> bool:
    """Tell by its first bytes whether a file is MDF, also one that was not closed."""
    return data.startswith((b"MDF     ", b"UnFinMF "))


def read(content: FileContent) -> Trace:
    """Read all numeric channels.

    Raises:
        InputError: asammdf is not installed, a damaged file, nothing numeric.
    """
    where = str(content.path)
    if importlib.util.find_spec("asammdf") is None:
        raise not_installed("asammdf", "MDF files", where)
    archive = _read_apart(content, where)
    rows = json.loads(archive["names"].tobytes())
    if not rows:
        raise InputError(f"this {NAME} holds no numeric channel", where, "record again")
    signals: list[Signal] = []
    times: list[FloatArray] = []
    notes: list[str] = []
    names = unique_names([row[0] for row in rows])
    for number, (name, (_, unit, about)) in enumerate(zip(names, rows, strict=True)):
        time, values = archive[f"t{number}"], archive[f"v{number}"]
        if time.size != values.size or not np.all(np.diff(time) > 0.0):
            notes.append(f"the time of {name} does not increase; it is left out")
            continue
        time = next((other for other in times if np.array_equal(other, time)), time)
        times.append(time)
        signals.append(Signal(name, time, values, clean(unit), axis_in(name), clean(about)))
    if not signals:
        raise InputError(notes[0], where, "record again")
    return Trace(NAME, tuple(signals), tuple(notes))


def _read_apart(content: FileContent, where: str) -> dict[str, FloatArray]:
    """Return the arrays that the worker read.

    Raises:
        InputError: it found damage, crashed or did not end.
    """
    path = os.pathsep.join((str(Path(feeddrive.__file__).parents[1]), os.environ.get("PYTHONPATH", "")))
    try:
        done = subprocess.run(
            [sys.executable, "-m", mdf4_worker.__name__],
            input=content.data,
            capture_output=True,
            timeout=_LONGEST,
            check=False,
            env={**os.environ, "PYTHONPATH": path.rstrip(os.pathsep)},
        )
    except subprocess.TimeoutExpired:
        raise InputError(f"is a damaged {NAME}: reading does not end", where, "copy or save it again") from None
    if done.returncode == mdf4_worker.ABSENT:
        raise not_installed("asammdf", "MDF files", where)
    if done.returncode != mdf4_worker.FINISHED:
        raise InputError(f"is a damaged {NAME}", where, "copy or save it again")
    with np.load(io.BytesIO(done.stdout), allow_pickle=False) as archive:
        return {name: archive[name] for name in archive.files}
