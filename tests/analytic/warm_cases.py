"""A small warm axis and a short cycle, shared by the tests of drive and heat together."""

from __future__ import annotations

from dataclasses import replace

from feeddrive.effects.base import Effect
from feeddrive.files import find_plant, find_scenario_file
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.simulate.scenario.scenario import Scenario
from feeddrive.simulate.scenario.scenario_file import read_scenario
from feeddrive.thermal.full.grid import Cells

PLANT_FILE = find_plant("warm_axis")


def coarse(plant: Plant) -> Plant:
    """The plant with a grid for its heat that is soon solved."""
    return replace(plant, network=replace(plant.heat, cells=Cells(60, 2, 10, 2)))


PLANT = coarse(read_plant(PLANT_FILE))
THERMAL, COUPLING = PLANT.heat, PLANT.coupling


def short_cycle(*effects: Effect, **settings: str) -> Scenario:
    """To and fro over 40 mm in 0.6 s; further settings by dotted key, dots written as two underscores."""
    chosen = {"trajectory.targets": '["90 mm", "50 mm"]', "trajectory.dwell": "20 ms"}
    chosen |= {key.replace("__", "."): value for key, value in settings.items()}
    scenario = read_scenario(find_scenario_file("warm_up_cycle.toml"), chosen)
    return replace(scenario, plant=coarse(scenario.plant).with_effects(*effects))
