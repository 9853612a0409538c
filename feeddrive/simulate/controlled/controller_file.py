"""The controller of a file, for a plant: a controller file, or what a scenario names or holds as its controller."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from feeddrive.errors import InputError
from feeddrive.plant.file.entries import Origins, Table, read_toml
from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import Cascade
from feeddrive.servo.vendor_names import with_own_names
from feeddrive.simulate.scenario.scenario_controller import FORMAT as CONTROLLER_FORMAT
from feeddrive.simulate.scenario.scenario_controller import read_cascade

SCENARIO_FORMAT = "feeddrive-scenario/1"


def read_controller(path: Path, plant: Plant) -> Cascade:
    """The controller of a file, for a plant; of a scenario nothing else is read.

    Args:
        path: of a controller file or of a scenario.
        plant: gives the lead, the torque limit and the inertia for the feed-forward.

    Raises:
        InputError: neither kind of file, or a controller that cannot be read.
    """
    entries = read_toml(path, "scenario or controller file")
    written = entries.get("format")
    if written == CONTROLLER_FORMAT:
        return read_cascade(Table(entries, str(path), Origins()), plant)[0]
    if written != SCENARIO_FORMAT:
        mend = f'its first line is format = "{SCENARIO_FORMAT}" or "{CONTROLLER_FORMAT}"'
        raise InputError("is neither a scenario nor a controller file of this version", str(path), mend)
    where = insert_controller(entries, path)
    held = Table(entries, str(path), Origins()).table("controller")
    return read_cascade(Table(held.entries, where, held.origins), plant)[0]


def insert_controller(entries: dict[str, Any], path: Path) -> str:
    """Put the controller of another file in the place of its name; where it stands, for messages."""
    named = entries.get("controller")
    if named is None:
        raise InputError("controller is missing", str(path), "write a table [controller] or the name of a file")
    changes = dict(named) if isinstance(named, dict) else {"file": named}
    if "file" not in changes:
        return f"{path}, controller"
    file = path.parent / str(changes.pop("file"))
    read = read_toml(file, "controller file")
    if read.get("format") != CONTROLLER_FORMAT:
        what = "is not a controller file of this version"
        raise InputError(what, str(file), f'write format = "{CONTROLLER_FORMAT}" in its first line')
    own = with_own_names(read, str(file))
    entries["controller"] = own | with_own_names(changes, f"{path}, controller")
    return str(file) if not changes else f"{path}, controller"
