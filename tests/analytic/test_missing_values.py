"""A value that is not there is a figure of nothing: metrology and tables of compensation refuse it in one line."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from feeddrive.compensation.heat.thermal_line import line_table, straight_line
from feeddrive.compensation.table import Deviations
from feeddrive.errors import InputError
from feeddrive.metrology.axis_heating import axis_heating
from feeddrive.metrology.circular import circular, circular_path
from feeddrive.metrology.following import following
from feeddrive.metrology.loops import force_loop, friction_map, torque_loop
from feeddrive.metrology.positioning import positioning
from feeddrive.metrology.response import measured_response, periodic_response, step_response
from feeddrive.typing import FloatArray

TURN = np.linspace(0.0, 2 * np.pi, 2000)
TARGETS = np.linspace(0.0, 0.5, 11)
NOISE = np.random.default_rng(1).standard_normal(2000)
DEVIATIONS = 1e-6 * NOISE[:55].reshape(11, 5)
GROWN = np.outer(np.linspace(0.0, 1e-5, 20), TARGETS)
SPEEDS = np.repeat([0.1, -0.1, 0.2, -0.2], 500)


def held(values: FloatArray) -> FloatArray:
    """The values, each there."""
    return values


def missing(values: FloatArray) -> FloatArray:
    """The values without one a third behind the first."""
    found = values.astype(float)
    found.flat[found.size // 3] = np.nan
    return found


EVALUATED: dict[str, Callable[[Callable[[FloatArray], FloatArray]], object]] = {
    "positioning": lambda of: positioning(TARGETS, of(DEVIATIONS), DEVIATIONS),
    "targets": lambda of: positioning(of(TARGETS), DEVIATIONS, DEVIATIONS),
    "circular": lambda of: circular(2 * TURN, of(0.1 * np.sin(2 * TURN)), 0.1),
    "circular_path": lambda of: circular_path(of(0.1 * np.cos(2 * TURN)), 0.1 * np.sin(2 * TURN), 0.1),
    "force_loop": lambda of: force_loop(100 * np.sin(TURN), of(1e-6 * np.sin(TURN - 0.1))),
    "torque_loop": lambda of: torque_loop(np.sin(TURN), of(np.cos(TURN)), 0.01),
    "friction_map": lambda of: friction_map(SPEEDS, of(np.sign(SPEEDS)), 0.01),
    "following": lambda of: following(of(TURN), TURN),
    "axis_heating": lambda of: axis_heating(np.linspace(300.0, 6000.0, 20), of(GROWN[:, 1:3]), TARGETS[1:3], 3600.0),
    "measured_response": lambda of: measured_response(NOISE, of(NOISE), 1e-3, 256),
    "periodic_response": lambda of: periodic_response(of(NOISE), NOISE, 1e-3, 500, np.array([10.0, 20.0])),
    "step_response": lambda of: step_response(TURN, of(np.where(TURN > 1.0, 1.0, 0.0)), 1.0),
    "deviations": lambda of: Deviations(TARGETS, of(DEVIATIONS[:, 0]), DEVIATIONS[:, 1]),
    "straight_line": lambda of: straight_line(of(GROWN), TARGETS, 0.0),
    "line_table": lambda of: line_table(of(np.linspace(20.0, 30.0, 20)), GROWN, TARGETS, 0.0),
}


@pytest.mark.parametrize("name", EVALUATED)
def test_a_missing_value_is_refused(name: str) -> None:
    EVALUATED[name](held)
    with pytest.raises(InputError, match="no number, the first at place"):
        EVALUATED[name](missing)
