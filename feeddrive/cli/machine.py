"""Plant files as the commands read them: a machine with masses and drives, or one that declares heat alone."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from feeddrive.plant.entries import read_toml
from feeddrive.plant.files import declares_heat_alone
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.thermal.plant import ThermalPlant
from feeddrive.thermal.whole_file import read_drive_plant, read_heat_plant


def read_machine(path: Path, recordings: Sequence[Recording] = ()) -> Plant | ThermalPlant:
    """The machine of a plant file.

    Args:
        path: of the file.
        recordings: of it; where a file declares motion and heat, temperatures without a motion mean the heat.

    Raises:
        InputError: as `read_drive_plant` and `read_heat_plant`.
    """
    entries = read_toml(path, "plant file")
    slow = bool(recordings) and all("screw_speed" in one and "motor_torque" not in one for one in recordings)
    if declares_heat_alone(entries) or ("thermal" in entries and slow):
        return read_heat_plant(path)
    return read_drive_plant(path)
