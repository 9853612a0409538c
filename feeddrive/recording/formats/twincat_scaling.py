"""Scaling of a TwinCAT Scope export: raw, or as the Scope showed it; no line of the file says which."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from feeddrive.recording.formats.twincat_header import Header
from feeddrive.recording.traces.trace import Signal
from feeddrive.typing import FloatArray


@dataclass(frozen=True)
class _Scaling:
    """What the Scope shows of a raw value: (raw factor + offset) unit_factor + unit_offset."""

    factor: float
    offset: float
    unit_factor: float
    unit_offset: float

    def apply(self, raw: FloatArray) -> FloatArray:
        """Return what is shown of raw values, (n,)."""
        return (raw * self.factor + self.offset) * self.unit_factor + self.unit_offset

    @property
    def neutral(self) -> bool:
        return self == _Scaling(1.0, 0.0, 1.0, 0.0)


def _scalings(header: Header, count: int) -> list[_Scaling]:
    columns = []
    for key, neutral in (("ScaleFactor", "1"), ("Offset", "0"), ("Unit ScaleFactor", "1"), ("Unit Offset", "0")):
        cells = header.attributes.get(key, [neutral] * count)
        columns.append([_float(cell or neutral) for cell in cells])
    return [_Scaling(*row) for row in zip(*columns, strict=True)]


def scaled(signals: list[Signal], header: Header) -> tuple[list[Signal], tuple[str, ...]]:
    """Apply the scaling of the header if the export left it out, which no line of the file says.

    The option `Scale values before export` decides it. Two channels of one symbol tell: raw they are equal, scaled they
    are as their scalings. Without such a pair the scaling is taken as applied, which is the usual export, and stated.
    """
    scalings = _scalings(header, len(signals))
    shown = ", ".join(s.name for s, scaling in zip(signals, scalings, strict=True) if not scaling.neutral)
    if not shown:
        return signals, ()
    votes = set()
    for i, j in combinations(range(len(signals)), 2):
        first, second = signals[i], signals[j]
        same = first.about and first.about == second.about and np.array_equal(first.time, second.time)
        if not same or scalings[i] == scalings[j]:
            continue
        # Times a scaling that has an inverse, only where one of the two is neutral: nothing is divided by zero.
        if scalings[i].neutral or scalings[j].neutral:
            plain, other = (i, j) if scalings[i].neutral else (j, i)
            expected = scalings[other].apply(signals[plain].values)
            if np.array_equal(first.values, second.values):
                votes.add(False)
            elif np.allclose(signals[other].values, expected, rtol=1e-6, atol=0.0):  # REAL32 has seven digits
                votes.add(True)
    if votes == {False}:
        made = [replace(s, values=scaling.apply(s.values)) for s, scaling in zip(signals, scalings, strict=True)]
        return made, (f"exported without scaling, as channels of one symbol show; applied by the header to {shown}",)
    how = (
        "applied in the export, as channels of one symbol show"
        if votes == {True}
        else (
            "taken as applied (the option Scale values before export); "
            "if it was off, give factor and offset in a mapping"
        )
    )
    return signals, (f"scale factors or offsets stand in the header for {shown}: {how}",)


def _float(cell: str) -> float:
    try:
        return float(cell.replace(",", "."))
    except ValueError:
        return float("nan")
