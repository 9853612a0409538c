"""Slopes of a prediction that goes from cell to cell: long enough steps where little is left of what a value does."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.slopes import jacobian_of
from feeddrive.effects.base import Effect, number
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.files import find_plant
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.typing import FloatArray

ROWS = 400
CELLS = 0.02
"""What the cells leave of all rows together, in deviations: as measured on a machine of parts."""


class Stepped(Problem):
    """A stiffness that moves the rows by `SLOPE` for each unit of its factor, and the cells by chance with it."""

    slope = 0.0

    def predicted(self, effects: Sequence[Effect]) -> FloatArray:
        """One row's way along all rows, and what depends on where the cells end."""
        factor = number(effects[0].values["factor"])
        chance = np.random.default_rng(abs(hash(factor)) % 2**32).standard_normal(ROWS)
        row = np.zeros(ROWS)
        row[0] = self.slope * factor
        return row + CELLS / np.sqrt(2 * ROWS) * chance


def slope_of(slope: float) -> float:
    """Length of the Jacobian's column, per unit of the factor."""
    plant = read_plant(find_plant("kimm_testbed"))
    problem = Stepped(plant, (), cast(Any, SimpleNamespace(smooth=lambda plant: False)))
    object.__setattr__(problem, "slope", slope)
    effect = EFFECTS["stiffness_deviation"].of(place="nut", factor=0.9)
    column = jacobian_of(problem, [effect], [True], problem.predicted([effect]))[:, 0]
    return float(np.linalg.norm(column)) / 0.05


@pytest.mark.parametrize("slope", [9.0, 60.0, 2000.0])
def test_cells_are_not_taken_for_what_a_value_does(slope: float) -> None:
    # The step is half the size, 0.025, or moves the rows by half a deviation: cells of 0.02 make 0.8 of a slope, or a
    # thousandth of a large one. A step of a hundredth of the size would make 40 of any.
    assert slope_of(slope) == pytest.approx(slope, abs=1.5 if slope < 100 else 45.0)
