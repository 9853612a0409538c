"""How many times smaller each thermal compensation makes the error of the table: rms and maximum, over stroke and time.

The machine is the full model on another mesh than the compensation's, with films and heats off by 10 %, all four signs,
on three duties of 6 h with rests. Sensors: noise 0.03 K, lag 60 s. The compensation starts from the declared values.

    OPENBLAS_NUM_THREADS=1 python -m benchmarks.thermal_compensation
"""

from __future__ import annotations

import math
import time
from dataclasses import replace
from itertools import product

import numpy as np

from feeddrive.compensation.heat.thermal_error import (
    LeftOver,
    TableError,
    compensation_model,
    left_over,
    model_alone,
    table_error,
)
from feeddrive.compensation.heat.thermal_line import LineTable, line_table, straight_line
from feeddrive.compensation.heat.thermal_observer import thermal_observer
from feeddrive.compensation.heat.thermal_placement import placements
from feeddrive.compensation.heat.thermal_sensors import Sensor, mountable_places
from feeddrive.compensation.heat.thermal_trial import TriedMachine, random_duty, tried_machine
from feeddrive.compensation.heat.thermal_unknowns import Unknowns, deviating
from feeddrive.files import find_plant
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.thermal.full.full_model import full_model
from feeddrive.thermal.full.grid import Cells
from feeddrive.thermal.reduced.parametric_model import HeatModel
from feeddrive.thermal.reduced.stepping import Stepper
from feeddrive.thermal.run.warm_up import declared_rows
from feeddrive.typing import FloatArray
from tests.heat_oracle.moving_family import moving_family

PLANT = read_plant(find_plant("thermal_bench")).heat
OTHER_MESH = full_model(PLANT.rig, Cells(330, 5, 36, 7))
RPM, STEP, ROWS = math.pi / 30, 30.0, 720
STILL = np.full(ROWS, PLANT.ambient)
HOURS = STEP * np.arange(ROWS) / 3600
DRIFTS = {
    "ramp": 2.0 * HOURS / 6,
    "wave": 2.0 * np.sin(2 * np.pi * HOURS / 8),
    "step": np.where(HOURS < 2.5, 0.0, 2.0),
}
DUTIES = {
    "one shift": np.repeat([750.0, 0, 500, 0, 1000, 250, 0], [150, 60, 120, 120, 90, 120, 60]) * RPM,
    "random 11": random_duty(np.random.default_rng(11), ROWS, np.array([200.0, 400, 600, 900]) * RPM, 90),
    "random 12": random_duty(np.random.default_rng(12), ROWS, np.array([150.0, 700, 1100, 1400]) * RPM, 40, 0.4),
}
SIGNS = tuple(product((0.9, 1.1), (0.9, 1.1)))


def main() -> None:
    """Print the tables."""
    began = time.perf_counter()
    model = compensation_model(PLANT)
    print(f"reduced to {model.order} states in {time.perf_counter() - began:.2f} s")
    error = table_error(PLANT, model)
    _placements(model, error)
    _signs(model, error)
    _orders()
    _beyond(model, error)


def _placements(model: HeatModel, error: TableError) -> None:
    print("\nplaces | expected error, one standard deviation over stroke and speeds: rms, largest [um] | "
          "left on random 11, ramp unseen, four signs: rms")  # fmt: skip
    duty, ambient = DUTIES["random 11"], STILL + DRIFTS["ramp"]
    tried = [tried_machine(PLANT, OTHER_MESH, STEP, duty, ambient, heat=heat, film=film) for heat, film in SIGNS]
    for count in range(4):
        for one in placements(PLANT, model, error, count, np.array([0.0, 250, 750, 1500]) * RPM):
            left = [left_over(machine.error, _observed(model, error, machine, *one.places)) for machine in tried]
            shown = ", ".join(f"{each.rms_after * 1e6:.2f}" for each in left)
            print(f"{', '.join(one.places) or 'none':20} | {one.rms * 1e6:6.2f} {one.largest * 1e6:6.2f} | {shown}")


def _signs(model: HeatModel, error: TableError) -> None:
    table = _table(error)
    print("\nfactor of the error, rms / maximum; in brackets what is left, rms / maximum [um]")
    print("duty, heat, film, drift | model alone, still air | model, air recorded | one sensor (front), drift unseen | "
          "two sensors, drift unseen | line through two sensors' | table over nut, still air")  # fmt: skip
    worst: dict[str, float] = {}
    for (name, speeds), (heat, film), drift in product(DUTIES.items(), SIGNS, DRIFTS):
        ambient = STILL + DRIFTS[drift]
        still = tried_machine(PLANT, OTHER_MESH, STEP, speeds, STILL, heat=heat, film=film)
        warm = tried_machine(PLANT, OTHER_MESH, STEP, speeds, ambient, heat=heat, film=film)
        found = {
            "model": left_over(still.error, model_alone(PLANT, model, error, STEP, speeds, STILL)),
            "recorded": left_over(warm.error, model_alone(PLANT, model, error, STEP, speeds, ambient)),
            "one": left_over(warm.error, _observed(model, error, warm, "front")),
        }
        two = _observed(model, error, warm, "nut", "front")
        found["two"] = left_over(warm.error, two)
        found["line"] = left_over(warm.error, straight_line(two, error.positions, 0.25).at(error.positions))
        reading = PLANT.ambient + still.readings([Sensor("nut")], np.random.default_rng(5))[:, 0]
        found["table"] = left_over(still.error, table.line(reading).at(error.positions))
        print(f"{name:10} {heat} {film} {drift} | " + " | ".join(map(_shown, found.values())))
        for key, value in found.items():
            worst[key] = min(worst.get(key, math.inf), value.rms_factor, value.largest_factor)
    print("worst of both factors: " + ", ".join(f"{key} {value:.1f}" for key, value in worst.items()))


def _observed(
    model: HeatModel, error: TableError, machine: TriedMachine, *places: str, unknowns: Unknowns | None = None
) -> FloatArray:
    sensors = [Sensor(place) for place in places]
    observer = thermal_observer(PLANT, model, error, sensors, unknowns, STEP)
    return observer.observe(machine.speeds, STILL, machine.readings(sensors, np.random.default_rng(5))).error


def _table(error: TableError) -> LineTable:
    """Straight lines over the nut's temperature, from warm-ups and cool-downs of the declared machine."""
    full = full_model(PLANT.rig)
    runs = [tried_machine(PLANT, full, STEP, np.repeat([speed * RPM, 0.0], 480), np.full(960, PLANT.ambient))
            for speed in (250.0, 500.0, 1000.0)]  # fmt: skip
    readings = np.concatenate([PLANT.ambient + one.rises["nut"] for one in runs])
    return line_table(readings, np.vstack([one.error for one in runs]), error.positions, 0.25)


def _orders() -> None:
    print("\norder of the model: states of the filter, factor with two sensors, ms for 6 h (worst sign, ramp)")
    ambient, speeds = STILL + DRIFTS["ramp"], DUTIES["random 11"]
    machine = tried_machine(PLANT, OTHER_MESH, STEP, speeds, ambient, heat=0.9, film=1.1)
    for order in (6, 8, 10, 16, 36):
        model = compensation_model(PLANT, order)
        error = table_error(PLANT, model)
        began = time.perf_counter()
        found = left_over(machine.error, _observed(model, error, machine, "nut", "front"))
        print(f"{order:3d}: {order + 7:3d} | {_shown(found)} | {(time.perf_counter() - began) * 1e3:.0f} ms")


def _beyond(model: HeatModel, error: TableError) -> None:
    """What the observer does not carry as an unknown."""
    print("\nbeyond the stated unknowns, two sensors, ramp unseen, heat 0.9, film 1.1")
    ambient, speeds = STILL + DRIFTS["ramp"], DUTIES["random 11"]
    cells = Cells(330, 5, 36, 7)
    others = {
        "contact conductance / 2": replace(PLANT, contact=PLANT.contact / 2),
        "contact conductance x 2": replace(PLANT, contact=PLANT.contact * 2),
        "30 % of the nut's heat on the screw": replace(PLANT, rig=replace(PLANT.rig, nut_heat_share=0.7)),
        "travel 50 mm longer": replace(PLANT, rig=replace(PLANT.rig, travel=replace(PLANT.rig.travel, high=0.35))),
        "heat capacity + 5 %": replace(
            PLANT, rig=replace(PLANT.rig, steel=replace(PLANT.rig.steel, heat_capacity=1.05 * 3.926e6))
        ),
    }
    for name, plant in others.items():
        machine = tried_machine(plant, full_model(plant.rig, cells), STEP, speeds, ambient, heat=0.9, film=1.1)
        true = np.array([np.interp(error.positions, machine.positions, row) for row in machine.error])
        found = left_over(true, _observed(model, error, machine, "nut", "front"))
        print(f"{name:52} | {_shown(found)}")

    motor = {"front": np.where(speeds > 0, 1.8, 0.0)}
    warmed = tried_machine(PLANT, OTHER_MESH, STEP, speeds, ambient, heat=0.9, film=1.1, others=motor)
    for name, unknowns in (("carried", None), ("not carried", Unknowns(heats=()))):
        for places in (("nut", "front"), ("nut", "front", "rear")):
            found = left_over(warmed.error, _observed(model, error, warmed, *places, unknowns=unknowns))
            print(f"{f'1.8 W at the front, {name}, {len(places)} sensors':52} | {_shown(found)}")
    print(f"{'nut moving, its ripple kept':52} | {_shown(_moving_nut(model, error, speeds, ambient))}")


def _moving_nut(model: HeatModel, error: TableError, speeds: FloatArray, ambient: FloatArray) -> LeftOver:
    """The machine as the family of the moving nut, which no average over the travel goes into."""
    family = moving_family(PLANT, np.array([100.0, 200, 400, 800, 1200]) * RPM, cells=Cells(200, 4, 40, 6))
    rows = deviating(declared_rows(PLANT, STEP, speeds, ambient), 0.9, 1.1, 1.1)
    state, states = np.zeros(family.model.order), np.empty((ROWS, family.model.order))
    systems: dict[float, Stepper] = {}
    for i, speed in enumerate(speeds):
        if speed not in systems:
            g = {path: float(values[i]) for path, values in rows.conductances.items()}
            systems[speed] = family.at(g, PLANT.feed(speed)).stepper(STEP)
        given = np.array([rows.inputs[name][i] if name in rows.inputs else 0.0 for name in family.model.input_names])
        state = states[i] = systems[speed](state, given)
    rises = {place: states @ family.model.readings[place] for place in mountable_places(PLANT)}
    true = table_error(PLANT, family.model)
    machine = TriedMachine(STEP, speeds, ambient, true.positions, true.of(states), rises)
    return left_over(machine.error, _observed(model, error, machine, "nut", "front"))


def _shown(one: LeftOver) -> str:
    left = f"({one.rms_after * 1e6:.2f}/{one.largest_after * 1e6:.2f})"
    return f"{one.rms_factor:5.1f}/{one.largest_factor:5.1f} {left:13}"


if __name__ == "__main__":
    main()
