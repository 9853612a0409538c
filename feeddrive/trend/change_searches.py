"""The full search, where the state changed alone: the last recording before a change against one after it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.trend.checkpoint import Checkpoint, Entry
from feeddrive.trend.events import Event
from feeddrive.trend.folder import Source, opened, sources
from feeddrive.trend.new_files import Options
from feeddrive.trend.watch import Trend


def searched_events(
    plant: Plant,
    trend: Trend,
    kept: Checkpoint,
    folder: Path,
    own: Path,
    options: Options,
    progress: Callable[[str], None],
) -> tuple[dict[int, str], Checkpoint]:
    """What the full search says at each event, by its number, and the checkpoint that remembers it.

    A recording that is no longer there, or that the search refuses, is named in place of an answer.
    """
    found: dict[int, str] = {}
    there = {one.key: one for one in sources(folder, own) if isinstance(one, Source)}
    for number, event in enumerate(trend.events):
        before, after = beside(trend, event, number)
        if before is None or after is None:
            continue
        name = f"{before.digest}+{after.digest}: {', '.join(event.causes)}"
        if name not in kept.searched:
            progress(f"searching what changed between {before.key} and {after.key}")
            try:
                answer = _answer(plant, _read(before, there, options), _read(after, there, options), event)
            except InputError as error:
                found[number] = f"not searched: {error}"
                continue
            kept = replace(kept, searched={**kept.searched, name: answer})
        found[number] = kept.searched[name]
    return found, kept


def beside(trend: Trend, event: Event, number: int) -> tuple[Entry | None, Entry | None]:
    """The last recording that is surely before a change, and the one at the end of the state that follows it."""
    used = trend.used
    later = [other.dates[0] for other in trend.events[number + 1 :] if other.dates[0] > event.dates[1]]
    before = np.flatnonzero((trend.days < event.dates[0]) & _with_passes(used))
    after = np.flatnonzero(
        (trend.days > event.dates[1]) & (trend.days < min(later, default=np.inf)) & _with_passes(used)
    )
    if event.kind == "jump" and len(after):
        after = after[:1]  # the next one; later ones may have other reasons
    return (used[before[-1]] if len(before) else None), (used[after[-1]] if len(after) else None)


def _with_passes(used: tuple[Entry, ...]) -> np.ndarray:
    return np.array([bool(one.passes) for one in used])


def _read(entry: Entry, there: dict[str, Source], options: Options) -> Recording:
    if entry.key not in there:
        raise InputError("the recording is no longer there", entry.key, "put it back to have the change searched")
    found = opened(there[entry.key], options.mapping, options.decimal).recording
    return replace(found, name=entry.key)


def _answer(plant: Plant, before: Recording, after: Recording, event: Event) -> str:
    """What differs between two recordings, in the words of the search, and whether that is what all of them say.

    Two recordings know less than all: what is the same in all is not taken out of them.
    """
    found, _ = diagnose(plant, [before, after])
    changes = found.changes.changes
    said = "; ".join(dict.fromkeys(change.statement for change in changes))
    if not event.causes or any(change.effect in event.causes for change in changes):
        names = ", ".join(effect.name for effect in found.effects) or "nothing"
        return said or f"{names} beyond the declared plant in both; no parameter that must differ between them"
    wanted = " or ".join(name.replace("_", " ") for name in event.causes[:2])
    length = f"{before.duration:.3g} s and {after.duration:.3g} s"
    beside = f"; they would say {said}, which all recordings together do not" if said else ""
    return (
        f"{before.name} and {after.name} alone ({length}) are too little to tell {wanted}{beside}; "
        "what is said above rests on all recordings"
    )
