"""The thermal bench, shared by the tests of the thermal model."""

from __future__ import annotations

import math

import numpy as np

from feeddrive.effects.base import Effect
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.thermal.full.full_model import Discretisation, discretise
from feeddrive.thermal.full.grid import Cells
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.parametric_model import Path

BENCH_FILE = plants_folder() / "thermal_bench.toml"
PLANT = read_plant(BENCH_FILE)
BENCH = PLANT.heat
RPM = math.pi / 30
QUICK = Cells(100, 4, 20, 6)
"""Half as many cells along the shaft as by default: enough for what is compared on one grid."""


def with_effects(*effects: Effect) -> Heat:
    """The bench with effects on its heat."""
    return PLANT.with_effects(*effects).heat


def conductances(speed: float) -> dict[Path, float]:
    """Of the bench at a speed [rev/min]."""
    return BENCH.at_speed(speed * RPM)


def bench_parts(cells: Cells | None = None) -> Discretisation:
    """The bench in finite volumes."""
    return discretise(BENCH.rig, cells or QUICK)


def nut_heat(speed: float) -> float:
    """Of the bench at a speed [rev/min], [W]."""
    return float(BENCH.nut.heats(np.array([speed * RPM]))[0])
