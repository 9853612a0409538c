"""A plant file read whole: where it declares masses and heat, neither part passes with a mistake in the other."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from feeddrive.plant.file.entries import read_toml
from feeddrive.plant.file.files import declares_heat_alone, plant_from_entries, read_plant
from feeddrive.plant.file.plant_schema import plant_table
from feeddrive.plant.plant import Plant
from feeddrive.thermal.file.coupling_section import coupling
from feeddrive.thermal.file.files import SECTION, read_thermal_plant, thermal_plant
from feeddrive.thermal.plant import ThermalPlant


def read_drive_plant(path: Path) -> Plant:
    """Masses and drive of a plant file, whose heat is checked where it declares any.

    Args:
        path: of the file.

    Raises:
        InputError: as `feeddrive.plant.file.files.read_plant`, and as `read_thermal_plant` and `read_coupling`.

    Warns:
        ValidityWarning: as `read_plant`.
    """
    return drive_plant(read_toml(path, "plant file"), path)


def drive_plant(entries: Mapping[str, Any], path: Path) -> Plant:
    """The plant of a file that is parsed already, values perhaps put in; else as `read_drive_plant`.

    Args:
        entries: of the file.
        path: of the file, for messages and the name.
    """
    plant = plant_from_entries(entries, path)
    _refuse_bad_heat(entries, path)
    return plant


def read_heat_plant(path: Path) -> ThermalPlant:
    """Heat of a plant file, whose masses and drive are checked where it declares any.

    Args:
        path: of the file.

    Raises:
        InputError: as `read_drive_plant`, and a file without a thermal section.

    Warns:
        ValidityWarning: as `feeddrive.plant.file.files.read_plant`.
    """
    entries = read_toml(path, "plant file")
    if SECTION in entries and not declares_heat_alone(entries):
        read_plant(path)
        _refuse_bad_heat(entries, path)
    return read_thermal_plant(path)


def _refuse_bad_heat(entries: Mapping[str, Any], path: Path) -> None:
    """Refuse what the thermal section and its coupling to the drive cannot be made of."""
    if SECTION not in entries:
        return
    top = plant_table(entries, str(path))
    thermal_plant(top, path.stem)
    if "coupling" in top.table(SECTION).entries:
        coupling(top)
