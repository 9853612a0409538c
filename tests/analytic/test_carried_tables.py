"""A table of what no name explains, fitted on all channels: what the channels do not see of it runs nowhere."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from feeddrive.diagnosis.likelihood.coordinates import read_coordinates
from feeddrive.diagnosis.unexplained import carry
from feeddrive.effects.base import Effect, Port
from feeddrive.effects.tabulated import TabulatedTorque
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray
from tests.recovery.planted import axis_plant

ROWS, NODES = 4000, 6


class Linear:
    """A problem of which the prediction is a matrix times the coordinates of the tables."""

    def __init__(self, plant: Plant, slopes: FloatArray, measured: FloatArray) -> None:
        self.plant, self.slopes, self.measured = plant, slopes, measured

    def residual(self, effects: Sequence[Effect]) -> FloatArray:
        return self.measured - self.slopes @ read_coordinates(effects, self.plant)


def table(torque: FloatArray) -> TabulatedTorque:
    angle = tuple(np.linspace(0.0, 5.0, len(torque)).tolist())
    return TabulatedTorque.of(Port.MOTOR, "angle", angle=angle, torque=tuple(torque.tolist()))


@pytest.fixture
def white(monkeypatch: pytest.MonkeyPatch) -> None:
    def exact(problem: Any, *_: object) -> FloatArray:
        return np.asarray(problem.slopes)

    def variances(_: object, residual: FloatArray, columns: FloatArray) -> FloatArray:
        return np.asarray(np.mean(residual**2) * np.sum(columns**2, axis=0))

    monkeypatch.setattr(carry, "jacobian_of", exact)
    monkeypatch.setattr(carry, "score_variances", variances)


@pytest.mark.usefixtures("white")
def test_two_breakpoints_that_cancel_stay_as_large_as_the_table_is() -> None:
    """Their sum is seen by 60 deviations, their difference by a thousandth: least squares alone takes it anywhere."""
    plant, random = axis_plant("bench"), np.random.default_rng(20261128)
    true, start = 0.02 * np.cos(np.arange(NODES)), 0.02 * np.cos(np.arange(NODES)) + 0.004 * (-1.0) ** np.arange(NODES)
    at = read_coordinates([table(true)], plant)
    slopes = random.standard_normal((ROWS, NODES)) / np.abs(at).max()
    slopes[:, 1] = slopes[:, 0] + 1e-5 * slopes[:, 1]
    problem = Linear(plant, slopes, slopes @ at + random.standard_normal(ROWS))
    alone = np.linalg.lstsq(slopes, problem.residual([table(start)]), rcond=None)[0]
    assert np.abs(alone[:2]).max() > 100 * np.abs(at).max()
    (found,), error = carry.joint_step(problem, [], [table(start)])  # type: ignore[arg-type]
    torque = np.array(found.table("torque"))
    assert np.abs(torque).max() < 0.03
    # what is seen is as least squares has it: 1 / sqrt(4000) of the largest, four deviations
    assert torque[2:] == pytest.approx(true[2:], abs=4 * 0.02 / np.sqrt(ROWS))
    assert torque[:2].sum() == pytest.approx(true[:2].sum(), abs=4 * 0.02 / np.sqrt(ROWS))
    assert error == pytest.approx(ROWS, rel=4 * np.sqrt(2 / ROWS))


@pytest.mark.usefixtures("white")
def test_a_table_that_a_misfit_hides_moves_by_less_than_it_is_large() -> None:
    """Seen by a third of a deviation of what is left, eight times the noise: least squares makes it three times."""
    plant, random = axis_plant("bench"), np.random.default_rng(20261130)
    start = 0.02 * np.cos(np.arange(NODES))
    at, misfit = read_coordinates([table(start)], plant), 8.0
    size = float(np.sqrt(np.mean(at**2)))
    slopes = random.standard_normal((ROWS, NODES)) * 0.3 * misfit / np.sqrt(ROWS) / size
    problem = Linear(plant, slopes, slopes @ at + misfit * random.standard_normal(ROWS))
    alone = np.linalg.lstsq(slopes, problem.residual([table(start)]), rcond=None)[0]
    (found,), _ = carry.joint_step(problem, [], [table(start)])  # type: ignore[arg-type]
    step = read_coordinates([found], plant) - at
    assert np.sqrt(np.mean(alone**2)) > 2 * size
    # a share 0.09 / 1.09 of the step of least squares, and its values have four digits
    assert step == pytest.approx(alone * 0.09 / 1.09, abs=0.02 * size)


@pytest.mark.usefixtures("white")
def test_a_breakpoint_that_nothing_meets_keeps_its_value() -> None:
    plant, random = axis_plant("bench"), np.random.default_rng(20261129)
    slopes = random.standard_normal((ROWS, NODES))
    slopes[:, 3] = 0.0
    true, start = np.full(NODES, 0.02), np.full(NODES, 0.015)
    problem = Linear(plant, slopes, slopes @ read_coordinates([table(true)], plant))
    (found,), _ = carry.joint_step(problem, [], [table(start)])  # type: ignore[arg-type]
    assert found.table("torque")[3] == 0.015
    assert np.delete(found.table("torque"), 3) == pytest.approx(0.02, rel=1e-3)


def test_values_are_rounded_to_what_people_read() -> None:
    assert carry.rounded(np.array([0.000123456789, -1.1972863198e-06, 0.0]), 0.000123456789) == [
        1.235e-4,
        -1.2e-06,
        0.0,
    ]
    assert carry.rounded(np.zeros(2), 0.0) == [0.0, 0.0]
    # a step: two breakpoints within a row of each other stay two
    assert carry.rounded(np.array([0.0, 4.0997501, 4.1002499]), 4.998e-4) == [0.0, 4.0997501, 4.1002499]
    assert carry.rounded(np.array([0.0, 0.13100627636390616]), 0.131) == [0.0, 0.131]
