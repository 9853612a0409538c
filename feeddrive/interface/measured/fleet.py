"""Following hundreds of axes: a folder with a folder for each axis, on this computer or on a Dask cluster.

Each axis is followed as it is alone, by the same call, and its results are written by whoever follows it: the numbers
are the same wherever that is. A cluster's workers must see the folders under the same path.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from feeddrive.errors import InputError, printable
from feeddrive.files import write_text_atomically
from feeddrive.interface.axis import load
from feeddrive.interface.measured.watching import PLACE, watch
from feeddrive.interface.shown import Listing, Shown
from feeddrive.simulate.sweep.sweep_dask import client_of, refuse_unfit

OWN_PLANT = "plant.toml"
"""Plant file in the folder of an axis that is not like the others."""

OVERVIEW = "fleet.json"


@dataclass(frozen=True)
class AxisFound:
    """What was found of one axis.

    Attributes:
        axis: name of its folder.
        recordings, new: recordings that count, and how many of them were new.
        newest: date of the newest, ISO.
        events: changes that are reported.
        verdict: what changed, or why nothing is known.
        usable: whether the axis could be followed.
        out: folder of its results.
    """

    axis: str
    recordings: int
    new: int
    newest: str
    events: int
    verdict: str
    usable: bool
    out: str


@dataclass(frozen=True, repr=False, eq=False)
class Fleet(Shown):
    """What the folders say of their axes, those that changed first.

    Attributes:
        axes: by number of events, then by name.
        out: folder of the results.
    """

    axes: tuple[AxisFound, ...]
    out: Path

    def listing(self) -> Listing:
        """One row per axis."""
        rows = [[one.axis, str(one.recordings), one.newest[:10], one.verdict] for one in self.axes]
        changed = sum(one.events > 0 for one in self.axes)
        title = f"{len(self.axes)} axes, {changed} changed"
        return Listing(title, ("axis", "recordings", "newest", "verdict"), rows, [asdict(one) for one in self.axes])


@dataclass(frozen=True)
class _Task:
    """One axis: folder, plant file, folder of results, and the options of `watch`."""

    folder: str
    plant: str
    out: str
    options: Mapping[str, Any]


def watch_fleet(
    folder: str | Path, plant: str | Path, *, out: str | Path | None = None, scheduler: str = "",
    progress: Callable[[str], None] | None = None, **options: Any,
) -> Fleet:  # fmt: skip
    """Follow every axis that has a folder in a folder; one that cannot be is reported, and the rest goes on.

    Args:
        folder: with a folder of recordings for each axis; a `plant.toml` in one is the plant of that axis.
        plant: file or name of the plant of all others.
        out: folder of the results, one for each axis in it; beside `folder`, its name and "_watch", if left out.
        scheduler: address of a Dask scheduler, tcp://host:8786; empty to follow the axes one after the other here.
        progress: called with a word for what is being done.
        **options: as for `watch`.

    Raises:
        InputError: no folder in the folder, a plant that cannot be used, or a cluster that cannot.
    """
    report = progress or (lambda _: None)
    top = Path(folder).resolve()
    target = Path(out).resolve() if out is not None else top.parent / f"{top.name}{PLACE}"
    load(plant)
    if not top.is_dir():
        raise InputError("no such folder", str(folder), "name the folder that holds a folder for each axis")
    named = [
        path for path in sorted(top.iterdir()) if path.is_dir() and not path.name.startswith(".") and path != target
    ]
    if not named:
        raise InputError("there is no folder in it", str(folder), "put the recordings of each axis into a folder")
    shared = str(Path(plant).resolve()) if Path(plant).is_file() else str(plant)
    tasks = [
        _Task(str(path), str(own) if (own := path / OWN_PLANT).is_file() else shared, str(target / path.name), options)
        for path in named
    ]
    found: list[AxisFound] = []
    for one in _on_cluster(tasks, scheduler) if scheduler else map(follow_axis, tasks):
        found.append(one)
        report(f"{len(found)} of {len(tasks)} axes: {one.axis}")
    fleet = Fleet(tuple(sorted(found, key=lambda one: (one.usable, -one.events, one.axis))), target)
    overview = {"format": "feeddrive-fleet/1", "axes": [asdict(one) for one in fleet.axes]}
    write_text_atomically(target / OVERVIEW, json.dumps(overview, indent=2, ensure_ascii=False) + "\n")
    return fleet


def follow_axis(task: _Task) -> AxisFound:
    """Follow one axis and write its results; an axis that cannot be followed says why."""
    name = printable(Path(task.folder).name)
    try:
        found = watch(task.folder, load(task.plant), out=task.out, **task.options)
        found.save()
    except InputError as error:
        return AxisFound(name, 0, 0, "", 0, f"not followed: {error}", False, task.out)
    trend = found.trend
    newest = trend.when(float(trend.days[-1])).isoformat()
    return AxisFound(name, len(trend.used), trend.fresh, newest, len(trend.events), found.verdict, True, task.out)


def _on_cluster(tasks: Sequence[_Task], address: str) -> Iterator[AxisFound]:
    """The axes as they are finished; one whose worker was lost is reported."""
    client = client_of(address)
    try:
        refuse_unfit(client, address)
        distributed: Any = import_module("distributed")
        pending = {client.submit(follow_axis, task, pure=False): task for task in tasks}
        for future in distributed.as_completed(list(pending), loop=client.loop):
            task = pending.pop(future)
            try:
                found: AxisFound = future.result()
            except Exception as error:
                why = f"not followed: the cluster lost it ({type(error).__name__}); watch again, what is read is kept"
                found = AxisFound(printable(Path(task.folder).name), 0, 0, "", 0, why, False, task.out)
            yield found
    finally:
        client.close()
