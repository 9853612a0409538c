"""ISO 230-3: a linear axis heats itself by moving, then cools down; what each thermal compensation leaves of the error.

The axis of plants/thermal_bench.toml with motor, bearing housings and bed (their values are assumed, for an axis of
this size) goes to and fro at 750 rev/min for 4 h and rests for 4 h. The machine that is tried is not as declared: 10 %
more heat, 10 % less film, a motor that heats the front bearing by an undeclared 10 W, air that warms by 2 K. The script
prints the numbers of the test, the best places for one, two, three sensors and the error that each compensation leaves;
it writes figures and the table for a CNC.

    python scenarios/iso230_3_warm_up.py [FOLDER]
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from feeddrive.compensation.heat.thermal_error import LeftOver, TableError, left_over, table_error
from feeddrive.compensation.heat.thermal_line import Convention, LineTable, line_table, straight_line
from feeddrive.compensation.heat.thermal_observer import thermal_observer
from feeddrive.compensation.heat.thermal_open_loop import compensation_model, model_alone
from feeddrive.compensation.heat.thermal_placement import Placement, placements
from feeddrive.compensation.heat.thermal_sensors import Sensor
from feeddrive.compensation.heat.thermal_trial import TriedMachine, tried_machine
from feeddrive.compensation.heat.thermal_unknowns import Unknowns
from feeddrive.files import find_plant, write_bytes_atomically, write_text_atomically
from feeddrive.metrology.axis_heating import AxisHeating, axis_heating
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.report.figures.drawing import render
from feeddrive.report.figures.figure_thermal_compensation import axis_heating_figure, compensation_figure, stroke_figure
from feeddrive.thermal.full.grid import Cells
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.parametric_model import HeatModel
from feeddrive.thermal.rig import Body
from feeddrive.typing import FloatArray

RPM = math.pi / 30
STEP, HEATING, COOLING = 30.0, 4 * 3600.0, 4 * 3600.0  # [s]
SPEED = 750 * RPM
ROWS = round((HEATING + COOLING) / STEP)
MOTOR_HEAT = 10.0  # while the axis moves; not declared [W]
REFERENCE = 0.200  # P0 of the straight line [m]
BODIES = (
    Body("motor_flange", "front", capacity=900.0, conductance=0.5, to_air=0.4),
    Body("front_housing", "front", capacity=1500.0, conductance=3.0, to_air=0.4),
    Body("rear_housing", "rear", capacity=1000.0, conductance=3.0, to_air=0.3),
    Body("bed", "front", capacity=60e3, conductance=0.2, to_air=4.0),
)
UNKNOWNS = Unknowns(heats=(("motor_flange", MOTOR_HEAT),))


def moving_machine(plant: Heat) -> TriedMachine:
    """The machine that is tried: another mesh, 10 % more heat, 10 % less film, a warm motor, air that warms by 2 K."""
    speeds = np.repeat([SPEED, 0.0], [round(HEATING / STEP), round(COOLING / STEP)])
    ambient = plant.ambient + np.linspace(0.0, 2.0, ROWS)
    model = replace(plant, cells=Cells(130, 5, 16, 5)).full_model()
    motor = {"motor_flange": np.where(speeds > 0, MOTOR_HEAT, 0.0)}
    return tried_machine(plant, model, STEP, speeds, ambient, heat=1.1, film=0.9, others=motor)


def observed(plant: Heat, model: HeatModel, error: TableError, machine: TriedMachine, places: tuple[str, ...]
             ) -> FloatArray:  # fmt: skip
    """What the observer makes of sensors at some places; it is not told that the air warms."""
    sensors = [Sensor(place) for place in places]
    observer = thermal_observer(plant, model, error, sensors, UNKNOWNS, STEP)
    readings = machine.readings(sensors, np.random.default_rng(1))
    return observer.observe(machine.speeds, np.full(ROWS, plant.ambient), readings).error


def nut_table(plant: Heat, model: HeatModel) -> LineTable:
    """The straight line over the nut's temperature, from warm-ups and cool-downs of the declared machine's model."""
    still = np.full(ROWS, plant.ambient)
    runs = [
        tried_machine(plant, model, STEP, np.repeat([speed * RPM, 0.0], ROWS // 2), still)
        for speed in (250.0, 500.0, 1000.0)
    ]
    readings = np.concatenate([plant.ambient + one.rises["nut"] for one in runs])
    return line_table(readings, np.vstack([one.error for one in runs]), runs[0].positions, REFERENCE)


def print_test(found: AxisHeating) -> None:
    """The numbers of the test."""
    print("nut at   first 60 min   heating   whole test   largest   steady after   [µm, min]")
    for one in found.targets:
        ranges = [value * 1e6 for value in (one.first_hour, one.heating, one.whole, one.largest)]
        print(f"{one.position * 1e3:4.0f} mm {ranges[0]:14.1f} {ranges[1]:9.1f} {ranges[2]:12.1f} {ranges[3]:9.1f} "
              f"{one.settling / 60:14.0f}")  # fmt: skip
    print(f"slope within the travel when the axis stops: {found.slope * 1e6:.0f} µm/m\n")


def print_places(best: Mapping[int, tuple[Placement, ...]]) -> None:
    """The three best sets of each number of sensors."""
    print("expected error left, one standard deviation over stroke and speeds: rms, largest [µm]")
    for count, found in best.items():
        for one in found[:3]:
            print(f"  {count}  {', '.join(one.places) or 'no sensor':44} {one.rms * 1e6:6.2f} {one.largest * 1e6:6.2f}")


def print_left(name: str, found: LeftOver) -> None:
    """A line of what is left."""
    print(f"  {name:44} {found.rms_after * 1e6:6.2f} {found.largest_after * 1e6:7.2f}   "
          f"{found.rms_factor:5.1f} {found.largest_factor:7.1f}")  # fmt: skip


def main(folder: Path) -> None:
    """Print the tables and write the files."""
    plant = replace(read_plant(find_plant("thermal_bench")).heat, bodies=BODIES)
    model = compensation_model(plant)
    error = table_error(plant, model)
    machine = moving_machine(plant)
    ends = [0, len(error.positions) // 2, -1]
    print_test(axis_heating(machine.times, machine.error[:, ends], error.positions[ends], HEATING))
    speeds = [0.0, 250 * RPM, SPEED, 1500 * RPM]
    best = {count: placements(plant, model, error, count, speeds, UNKNOWNS) for count in range(4)}
    print_places(best)
    table = nut_table(plant, model)
    nut = plant.ambient + machine.readings([Sensor("nut")], np.random.default_rng(1))[:, 0]
    by_count = {count: observed(plant, model, error, machine, best[count][0].places) for count in (1, 2, 3)}
    compensations = {
        "line over the nut's temperature": table.line(nut).at(error.positions),
        "model alone, air recorded": model_alone(plant, model, error, STEP, machine.speeds, machine.ambient),
        "observer, 1 sensor": by_count[1],
        "observer, 2 sensors": by_count[2],
        "observer, 3 sensors": by_count[3],
        "line through that of 2 sensors": straight_line(by_count[2], error.positions, REFERENCE).at(error.positions),
    }
    print("\nerror left over stroke and time: rms, largest [µm]; times smaller than without: rms, largest")
    print_left("no compensation", left_over(machine.error, np.zeros_like(machine.error)))
    for name, estimate in compensations.items():
        print_left(name, left_over(machine.error, estimate))
    print("One run; what is expected above is the spread over all that the unknowns may be.\n")
    write_files(folder, plant, machine, compensations, table)


def write_files(folder: Path, plant: Heat, machine: TriedMachine, compensations: Mapping[str, FloatArray],
                table: LineTable) -> None:  # fmt: skip
    """Figures and the table for a CNC."""
    temperatures = {name.replace("_", " "): plant.ambient + rise for name, rise in machine.rises.items()}
    times, positions = machine.times, machine.positions
    shown = {name: one for name, one in compensations.items() if not name.startswith("line through")}
    figures = (
        axis_heating_figure(times, positions, machine.error, {**temperatures, "air": machine.ambient}, HEATING),
        compensation_figure(times, positions, machine.error, shown, HEATING),
        stroke_figure(times, positions, machine.error, compensations["observer, 2 sensors"],
                      [0.25 * 3600, 3600, HEATING, HEATING + 900, HEATING + 3600]),
    )  # fmt: skip
    for figure in figures:
        path = folder / f"{figure.stem}.png"
        write_bytes_atomically(path, render(figure).png)
        print(f"Figure: {path}")
    path = folder / "thermal_line.csv"
    write_text_atomically(path, table.text(Convention.MEASURED_ERROR))
    print(f"Table for a CNC: {path}")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out"))
