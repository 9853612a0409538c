"""A small warm axis and a short cycle, shared by the tests of drive and heat together."""

from __future__ import annotations

from dataclasses import replace

from feeddrive.files import find_plant, find_scenario_file
from feeddrive.simulate.scenario.scenario import Scenario
from feeddrive.simulate.scenario.scenario_file import read_scenario
from feeddrive.thermal.file.coupling_section import read_coupling
from feeddrive.thermal.file.files import read_thermal_plant
from feeddrive.thermal.full.grid import Cells

PLANT_FILE = find_plant("warm_axis")
THERMAL = replace(read_thermal_plant(PLANT_FILE), cells=Cells(60, 2, 10, 2))
COUPLING = read_coupling(PLANT_FILE)


def short_cycle(**settings: str) -> Scenario:
    """To and fro over 40 mm in 0.6 s; further settings by dotted key, dots written as two underscores."""
    chosen = {"trajectory.targets": '["90 mm", "50 mm"]', "trajectory.dwell": "20 ms"}
    chosen |= {key.replace("__", "."): value for key, value in settings.items()}
    return read_scenario(find_scenario_file("warm_up_cycle.toml"), chosen)
