"""The units that results are shown in, by size: a simple table keyed by SI unit."""

from __future__ import annotations

import math

_SCALES: dict[str, tuple[tuple[float, float, str], ...]] = {
    "m": ((0.0, 1e9, "nm"), (1e-7, 1e6, "µm"), (1e-4, 1e3, "mm"), (10.0, 1.0, "m")),
    "s": ((0.0, 1e6, "µs"), (1e-4, 1e3, "ms"), (1.0, 1.0, "s"), (600.0, 1 / 60, "min"), (7200.0, 1 / 3600, "h")),
    "N": ((0.0, 1.0, "N"), (1e4, 1e-3, "kN")),
    "N m": ((0.0, 1e3, "mN m"), (1e-2, 1.0, "N m")),
    "N/m": ((0.0, 1.0, "N/m"), (1e5, 1e-6, "N/µm")),
    "m/s": ((0.0, 1e6, "µm/s"), (1e-5, 1e3, "mm/s"), (1e-3, 60.0, "m/min")),
    "rad": ((0.0, 180 / math.pi, "°"),),
    "rad/s": ((0.0, 30 / math.pi, "rev/min"),),
    "m rad/s": ((0.0, 3e4 / math.pi, "mm rev/min"),),
    "Hz": ((0.0, 1.0, "Hz"), (1e4, 1e-3, "kHz")),
    "W": ((0.0, 1.0, "W"), (1e4, 1e-3, "kW")),
    "Pa": ((0.0, 1.0, "Pa"), (1e5, 1e-6, "MPa"), (1e9, 1e-9, "GPa")),
    "degC": ((0.0, 1.0, "°C"),),
    "m/m": ((0.0, 1e6, "µm/m"),),
    "1": ((0.0, 1.0, ""),),
}
"""SI unit -> rows (from this absolute size on, factor, label), smallest size first."""


def shown_unit(value_si: float, unit: str) -> tuple[float, float, str]:
    """Return factor, offset and label to show an SI value in; units that are not in the table stay SI."""
    scales = _SCALES.get(unit)
    if scales is None:
        return 1.0, 0.0, unit.replace("^2", "²").replace("^3", "³")
    if value_si == 0.0:
        return 1.0, 0.0, _label_at_zero(unit)
    chosen = [row for row in scales if abs(value_si) >= row[0]] or [scales[0]]
    return chosen[-1][1], 0.0, chosen[-1][2]


def _label_at_zero(unit: str) -> str:
    """Return the label of zero: the unit in which most values of the kind are shown."""
    usual = {"m": "mm", "s": "s", "N m": "N m", "N/m": "N/µm", "m/s": "m/min"}
    return usual.get(unit, _SCALES[unit][0][2])
