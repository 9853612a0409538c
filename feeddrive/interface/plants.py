"""The plant of an axis, or of the file or shipped machine that is named in its place."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from feeddrive.errors import InputError
from feeddrive.files import find_plant
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant

if TYPE_CHECKING:
    from feeddrive.interface.axis import Axis


def plant_of(axis: Axis | str | Path) -> Plant:
    """The plant.

    Raises:
        InputError: neither an axis, nor a file, nor the name of a shipped machine; or a file that cannot be used.
    """
    if isinstance(axis, str | Path):
        return read_plant(find_plant(str(axis)))
    plant = getattr(axis, "plant", None)
    if not isinstance(plant, Plant):
        raise InputError(f"{axis!r} is no axis", "axis", 'give fd.load("bench_axis"), or the path of a plant file')
    return plant
