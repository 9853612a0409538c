"""Plant files as the commands read them: a machine with masses and drives, its heat, or both."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from feeddrive.interface.axis import load
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.thermal.plant import ThermalPlant
from feeddrive.thermal.warm_plant import WarmPlant


def read_machine(path: Path, recordings: Sequence[Recording] = ()) -> Plant | ThermalPlant | WarmPlant:
    """The machine of a plant file.

    Args:
        path: of the file.
        recordings: of it; where a file declares motion and heat, temperatures without a motion mean the heat, and a
            log of hours with both means both.

    Raises:
        InputError: as `feeddrive.interface.axis.load`.
    """
    return load(path).machine(recordings)
