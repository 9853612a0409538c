"""What is new in a folder of recordings: read once, passed linearly, and kept in the checkpoint."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np

from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.recording import check_against_lead, check_against_stroke
from feeddrive.trend.checkpoint import BROKEN, COPY, UNDATED, USED, WAITING, Checkpoint, Entry, save_checkpoint
from feeddrive.trend.folder import UNFINISHED, Source, opened, sources, stamp_of
from feeddrive.trend.regressors import grid_for, linear_pass

SAVED_EVERY = 60.0
"""Seconds of reading after which what is known is written, so that an interrupted first run goes on where it was."""

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Options:
    """How a folder is to be understood.

    Attributes:
        mapping, decimal: as for reading a recording.
        stamp: pattern of `strptime` in names; empty to take it from content and name.
        first, every: date of the first recording by name, and the distance of recordings; where nothing else does.
        absolute: whether the zero of the table against the motor is kept, so that an offset that moves is growth.
        limits: quantity to what it may move by.
    """

    mapping: Path | None = None
    decimal: str | None = None
    stamp: str = ""
    first: datetime | None = None
    every: timedelta | None = None
    absolute: bool = False
    limits: Mapping[str, str] | None = None


def read_new(
    plant: Plant, folder: Path, out: Path, options: Options, kept: Checkpoint, progress: Progress
) -> tuple[Checkpoint, int, tuple[str, ...]]:
    """The checkpoint with what is new in the folder, and how much of it there was."""
    notes: list[str] = []
    there: dict[str, Source] = {}
    for one in sources(folder, out):
        if isinstance(one, Source):
            there[one.key] = one
        else:
            notes.append(f"{one[0]}: {one[1]}")
    gone = [key for key in kept.entries if key not in there]
    stay = {key: entry for key, entry in kept.entries.items() if key in there or entry.status == USED}
    if gone and any(kept.entries[key].status == USED for key in gone):
        notes.append(f"{len(gone)} files are no longer there; what they said is kept")
    kept = replace(kept, entries=stay)
    new = [one for key, one in there.items() if not _known(kept.entries.get(key), one)]
    saved = time.monotonic()
    for number, source in enumerate(new, 1):
        progress(f"reading {number} of {len(new)}: {source.key}")
        kept = _with_source(plant, source, options, kept)
        if time.monotonic() - saved > SAVED_EVERY and _has_used(kept):
            save_checkpoint(out, kept)
            saved = time.monotonic()
    if (new or gone) and _has_used(kept):
        save_checkpoint(out, kept)
    return kept, len(new), tuple(notes)


def _has_used(kept: Checkpoint) -> bool:
    """Whether any recording counts: where none does there is no result, and nothing is written."""
    return any(entry.status == USED for entry in kept.entries.values())


def _known(entry: Entry | None, source: Source) -> bool:
    """Whether a file was read as it is."""
    if entry is None or entry.status == WAITING:
        return False
    return (entry.size, entry.changed) == (source.size, source.changed)


def _with_source(plant: Plant, source: Source, options: Options, kept: Checkpoint) -> Checkpoint:
    """The checkpoint with what one file says."""

    def ended(status: str, reason: str) -> Checkpoint:
        return kept.with_entry(Entry(source.key, source.size, source.changed, status, reason))

    if Path(source.member or source.path.name).suffix.lower() in UNFINISHED:
        return ended(WAITING, "it is being written under this name")
    try:
        found = opened(source, options.mapping, options.decimal)
        name = Path(source.member or source.path.name).name
        stamp = stamp_of(name, found.head, options.stamp)
    except (InputError, OSError) as error:
        waits = source.young and not source.member
        return ended(WAITING if waits else BROKEN, f"still being written? {error}" if waits else str(error))
    twin = next((one for one in kept.entries.values() if one.digest == found.digest and one.key != source.key), None)
    if twin is not None and twin.status == USED:
        return ended(COPY, f"the same recording as {twin.key}")
    if stamp is None and options.every is None:
        return ended(UNDATED, 'no date: give --stamp "%Y%m%d" for its name, or --every "1 day"')
    means = {
        channel: float(np.mean(samples))
        for channel, samples in found.recording.channels.items()
        if channel.endswith("_temperature") or channel.startswith("table_growth")
    }
    grid = kept.grid
    try:
        recording = replace(found.recording, name=source.key)
        lead = 2 * np.pi * plant.chain.motor_radius
        check_against_lead(recording, lead, source.key)
        check_against_stroke(recording, lead, plant.stroke, source.key)
        grid = kept.grid or grid_for(plant, recording)
        passes = linear_pass(recording, plant, grid)
    except InputError as error:
        if not means:
            return ended(BROKEN, str(error))
        passes = ()
    moment, reason = ("", "by name") if stamp is None else (stamp[0].isoformat(), stamp[1])
    entry = Entry(source.key, source.size, source.changed, USED, reason, moment, found.digest, passes, means)
    return replace(kept, grid=grid).with_entry(entry)
