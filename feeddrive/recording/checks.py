"""What makes samples unusable: refused with file, row, column and the mend."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.channels import MOTION_AND_TORQUE
from feeddrive.typing import FloatArray

FEWEST_ROWS = 100
"""A shorter recording holds neither a stroke nor enough samples for a filter."""


def check_length(rows: int, where: str) -> None:
    """Refuse recordings that are too short.

    Raises:
        InputError: fewer than `FEWEST_ROWS` rows.
    """
    if rows < FEWEST_ROWS:
        raise InputError(f"only {rows} rows of numbers", where, f"record at least {FEWEST_ROWS} samples")


def check_finite(samples: FloatArray, column: str, first_row: int, where: str) -> None:
    """Refuse NaN and infinity; samples is (n,), first_row the row in the file of samples[0].

    Raises:
        InputError: a sample is not finite.
    """
    bad = np.flatnonzero(~np.isfinite(samples))
    if bad.size:
        kind = "NaN" if np.isnan(samples[bad[0]]) else "infinite"
        count = f" ({bad.size} such cells in the column)" if bad.size > 1 else ""
        place = f'{where}, row {first_row + int(bad[0])}, column "{column}"'
        raise InputError(f"the value is {kind}{count}", place, "cut the file there, or record again")


def check_alive(channels: Mapping[str, FloatArray], where: str) -> None:
    """Refuse motion and torque channels, (n,) each, that never change.

    Raises:
        InputError: such a channel is constant.
    """
    for name in MOTION_AND_TORQUE:
        samples = channels.get(name)
        if samples is not None and bool(np.all(samples == samples[0])):
            what = f"the channel never changes, it is {samples[0]:g} in every row"
            raise InputError(what, f'{where}, column "{name}"', "check the sensor, or leave the column out")
