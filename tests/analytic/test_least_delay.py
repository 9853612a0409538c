"""The least delay that is named: a torque by a thousandth of its swing, a position by the noise of its sensor.

The table moves as x = A sin(w t). Without friction the torque is a sine as well, so that a delay d moves it by w d of
itself, and the scale by A w d at most. Nothing of the package takes part in these two.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from feeddrive.diagnosis.finding.materiality import is_material_here
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.preparation import prepared
from feeddrive.effects.base import Effect
from feeddrive.effects.timing.channel_delay import ChannelDelay
from feeddrive.effects.timing.drive_delay import DriveDelay
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import Recording
from tests.recovery.rigid_runs import LEAD, MASS, PLANT, STEP

AMPLITUDE, RATE, SCALE_NOISE = 0.05, 2 * math.pi * 2.0, 2e-6
LEAST = 1e-3 / RATE
"""Delay [s] by which a torque of this rate moves by a thousandth."""
LEAST_OF_SCALE = SCALE_NOISE * math.sqrt(2 * STEP * 50.0) / (AMPLITUDE * RATE)
"""Delay [s] that moves the table by the noise of the scale in the band, a tenth of the sample rate."""


@pytest.fixture(scope="module")
def problem(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """A frictionless rigid axis that swings for 20 s, with a scale."""
    path = tmp_path_factory.mktemp("plant") / "rigid.toml"
    path.write_text(PLANT.split("[[effect]]")[0], encoding="utf-8")
    time, chance = np.arange(round(20.0 / STEP)) * STEP, np.random.default_rng(3)
    r = LEAD / (2 * math.pi)
    position = AMPLITUDE * np.sin(RATE * time)
    torque = -r * MASS * AMPLITUDE * RATE**2 * np.sin(RATE * (time + 0.5 * STEP))
    channels = {
        "motor_torque": torque + 1e-4 * chance.standard_normal(len(time)),
        "motor_angle": position / r,
        "table_position": position + SCALE_NOISE * chance.standard_normal(len(time)),
    }
    return prepared(read_plant(path), [Recording("swing", time, channels, STEP)], [], 0.75)[0]


@pytest.mark.parametrize("effect", [DriveDelay.of(delay=1e-3), ChannelDelay.of(place="motor_torque", delay=1e-3)])
def test_torque_moves_by_a_thousandth(problem: Problem, effect: Effect) -> None:
    """Within 5 %: the torque is held over a row, and its rate is taken by differences."""
    for share, named in ((0.95, False), (1.05, True)):
        assert is_material_here(effect.with_values(delay=share * LEAST), problem) == named


def test_scale_moves_by_its_noise(problem: Problem) -> None:
    """Within a third: the noise is read off the quietest tenth of the recording, and a filter's edge is no step."""
    for share, named in ((0.67, False), (1.5, True)):
        effect = ChannelDelay.of(place="table_position", delay=share * LEAST_OF_SCALE)
        assert is_material_here(effect, problem) == named


def test_late_motor_angle_moves_both(problem: Problem) -> None:
    """The scale shows it long before the torque does."""
    assert LEAST_OF_SCALE < 0.1 * LEAST
    for share, named in ((0.5, False), (2.0, True)):
        effect = ChannelDelay.of(place="motor_angle", delay=share * LEAST_OF_SCALE)
        assert is_material_here(effect, problem) == named
