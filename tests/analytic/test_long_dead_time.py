"""A loop of many ticks of dead time: its response is that of a short one, turned by the ticks between, and quick."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from feeddrive.files import find_plant, scenarios_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.servo.linear_loop import open_velocity_loop
from feeddrive.servo.margins import frequency_response, margins
from feeddrive.simulate.scenario.scenario_controller import read_controller

PLANT = read_plant(find_plant("bench_axis"))
CASCADE = read_controller(scenarios_folder() / "step_position.toml", PLANT)


def test_ticks_of_dead_time_turn_the_phase_and_nothing_else() -> None:
    tick = CASCADE.sample_time
    short, long = (open_velocity_loop(PLANT, replace(CASCADE, dead_time=n * tick), 0.05, 0.25) for n in (2, 202))
    frequency = np.geomspace(1.0, 0.49 / tick, 300)
    turned = np.exp(-2j * np.pi * frequency * 200 * tick)
    found, expected = frequency_response(long, frequency), frequency_response(short, frequency) * turned
    # Rounding of 1e-16 in a loop of two integrators at 1 Hz of 8000: (8000 / 2 pi)^2 1e-16 = 2e-10, some of them.
    np.testing.assert_allclose(found, expected, rtol=1e-8)


def test_margins_of_three_hundred_ticks_take_no_minutes() -> None:
    loop = open_velocity_loop(PLANT, replace(CASCADE, dead_time=300 * CASCADE.sample_time), 0.05, 0.25)
    begun = time.process_time()
    margins(loop, points=2000)
    # 1.4 s here; a dense solution for every frequency took 25 s.
    assert time.process_time() - begun < 5
