"""The bench with its compensation, and the machines on which it is tried."""

from __future__ import annotations

from functools import cache
from itertools import product

import numpy as np

from feeddrive.compensation.heat.thermal_error import compensation_model, table_error
from feeddrive.compensation.heat.thermal_trial import TriedMachine, random_duty, tried_machine
from feeddrive.files import find_plant
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.thermal.full.full_model import full_model
from feeddrive.thermal.full.grid import Cells

BENCH = read_plant(find_plant("thermal_bench")).heat
RPM = np.pi / 30
STEP, ROWS = 30.0, 720
SIGNS = tuple(product((0.9, 1.1), (0.9, 1.1)))
"""Factors on heat and films."""
STILL = np.full(ROWS, BENCH.ambient)
WARMING = STILL + 2.0 * np.linspace(0.0, 1.0, ROWS)
"""2 K within the 6 h."""
# No choice of the compensation was made with this duty.
DUTY = random_duty(np.random.default_rng(2077), ROWS, np.array([180.0, 450, 800, 1200]) * RPM, 80)
MODEL = compensation_model(BENCH)
ERROR = table_error(BENCH, MODEL)
OTHER_MESH = full_model(BENCH.rig, Cells(130, 5, 16, 5))


@cache
def machine(heat: float, film: float, *, warming: bool) -> TriedMachine:
    """The deviating bench on the duty, in still air or in air that warms by 2 K."""
    ambient = WARMING if warming else STILL
    return tried_machine(BENCH, OTHER_MESH, STEP, DUTY, ambient, heat=heat, film=film)
