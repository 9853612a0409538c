"""What is kept of every recording, so that a new one costs what one costs: one file, replaced as a whole.

It holds the triangles of the linear pass (some ten kilobytes a recording), the dates, and what became of every file.
"""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from feeddrive.files import write_bytes_atomically
from feeddrive.trend.regressors import Grid, Pass
from feeddrive.typing import FloatArray

NAME = "watch.npz"
FORMAT = "feeddrive-watch/2"

USED, COPY, BROKEN, WAITING, UNDATED = "used", "copy", "broken", "waiting", "undated"
"""What becomes of a file; one that waits is asked again the next time."""


@dataclass(frozen=True)
class Entry:
    """What is known of one file.

    Attributes:
        key: of its source.
        size, changed: as it was when it was read.
        status: see above.
        reason: why, or where its date stands.
        moment: when it was recorded, ISO; empty where it is not known.
        digest: of its samples.
        passes: of its channels.
        means: channel of temperature or growth to its mean, SI (degC).
    """

    key: str
    size: int
    changed: float
    status: str
    reason: str = ""
    moment: str = ""
    digest: str = ""
    passes: tuple[Pass, ...] = ()
    means: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Checkpoint:
    """All that is kept.

    Attributes:
        plant: checksum of the plant and the options that the passes were taken with.
        grid: of the maps; None before the first recording.
        entries: by key.
        searched: what full searches found, by the digests of their recordings.
    """

    plant: str
    grid: Grid | None = None
    entries: Mapping[str, Entry] = field(default_factory=dict)
    searched: Mapping[str, str] = field(default_factory=dict)

    def with_entry(self, entry: Entry) -> Checkpoint:
        """The checkpoint with one entry put in or in place of the old one."""
        return replace(self, entries={**self.entries, entry.key: entry})


def load_checkpoint(folder: Path, plant: str) -> tuple[Checkpoint, str]:
    """What was kept for this plant, and a remark where it is not used."""
    path = folder / NAME
    if not path.is_file():
        return Checkpoint(plant), ""
    try:
        with np.load(io.BytesIO(path.read_bytes()), allow_pickle=False) as held:
            content = json.loads(bytes(held["index"]).decode())
            numbers: FloatArray = held["numbers"]
        if content["format"] != FORMAT:
            return Checkpoint(plant), "the results kept are of another version of feeddrive: all files are read anew"
        if content["plant"] != plant:
            return Checkpoint(plant), "the plant or the options changed: all files are read anew"
        grid = Grid(**content["grid"]) if content["grid"] else None
        entries = {one["key"]: _entry(one, numbers) for one in content["entries"]}
        return Checkpoint(plant, grid, entries, dict(content["searched"])), ""
    except Exception:  # whatever a damaged file of ours holds: nothing but time is lost
        return Checkpoint(plant), "the results kept are damaged: all files are read anew"


def save_checkpoint(folder: Path, kept: Checkpoint) -> None:
    """Write the checkpoint, an old one is replaced as a whole.

    Raises:
        InputError: it cannot be written.
    """
    parts: list[FloatArray] = []
    at = 0
    entries = []
    for entry in kept.entries.values():
        plain: dict[str, Any] = {key: value for key, value in vars(entry).items() if key != "passes"}
        plain["means"] = dict(entry.means)
        plain["passes"] = []
        for one in entry.passes:
            packed = one.triangle[np.triu_indices(len(one.triangle))]
            parts.append(packed)
            plain["passes"].append({
                "channel": one.channel, "size": len(one.triangle), "at": at, "first": one.first, "hats": one.hats,
                "rows": one.rows, "declared": [float(v) for v in one.declared], "slow_force": one.slow_force,
            })  # fmt: skip
            at += len(packed)
        entries.append(plain)
    content = {
        "format": FORMAT,
        "plant": kept.plant,
        "grid": asdict(kept.grid) if kept.grid else None,
        "entries": entries,
        "searched": dict(kept.searched),
    }
    index = np.frombuffer(json.dumps(content).encode(), dtype=np.uint8)
    file = io.BytesIO()
    np.savez(file, index=index, numbers=np.concatenate(parts) if parts else np.zeros(0))
    write_bytes_atomically(folder / NAME, file.getvalue())


def _entry(plain: dict[str, Any], numbers: FloatArray) -> Entry:
    passes = tuple(_pass(one, numbers) for one in plain.pop("passes"))
    return Entry(passes=passes, **plain)


def _pass(one: dict[str, Any], numbers: FloatArray) -> Pass:
    size, at = int(one["size"]), int(one["at"])
    triangle = np.zeros((size, size))
    triangle[np.triu_indices(size)] = numbers[at : at + size * (size + 1) // 2]
    return Pass(
        one["channel"], triangle, one["first"], one["hats"], one["rows"], np.array(one["declared"]), one["slow_force"]
    )
