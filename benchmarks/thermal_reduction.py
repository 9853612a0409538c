"""The thermal model's reductions beside the full model and the explicit moving nut: errors, times, ratios.

    OPENBLAS_NUM_THREADS=1 python -m benchmarks.thermal_reduction

About four minutes on one core.
"""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from feeddrive.plant.file.plant_file import read_plant
from feeddrive.thermal.full.full_model import discretise, full_model, model_of
from feeddrive.thermal.full.grid import Cells
from feeddrive.thermal.full.moving import moving_system, ripple_number
from feeddrive.thermal.reduced.network import network
from feeddrive.thermal.reduced.reduction import Sizes, compressed_basis, reduce_model
from feeddrive.thermal.reduced.system import HeatSystem
from feeddrive.thermal.rig import Travel
from feeddrive.thermal.run.warm_up import simulate
from tests.heat_oracle.explicit import ExplicitRun, paper_cells, run_explicitly
from tests.heat_oracle.moving_family import moving_family
from tests.heat_oracle.reduction_error import reduced_system, reduction_error

ROOT = Path(__file__).resolve().parents[1]
SHIPPED = ROOT / "plants" / "thermal_bench.toml"
BENCH = read_plant(SHIPPED).heat
RPM = math.pi / 30
WORKING = Sizes(heats=(("nut", 1.3), ("front", 1.0), ("rear", 0.17)))
HOURS = 3 * 3600.0


def main() -> None:
    """Print the tables."""
    _orders()
    _parametric()
    _every_speed()
    _moving()
    _paper_grid()


def _orders() -> None:
    full = full_model(BENCH.rig).at(BENCH.at_speed(500 * RPM))
    print(f"full model: {full.order} states; 500 rev/min; steps of 1.3 W nut, 1 W front, 0.17 W rear, 2 K ambient")
    alone = replace(WORKING, other_heat=1e-9, surroundings=1e-9, heats=(("nut", 1.3),))
    print("order | nut heat alone: mK, nm | all inputs: mK, nm")
    for order in (2, 3, 4, 5, 6, 8, 10, 12, 15):
        one = reduction_error(full, reduced_system(full, order, alone), alone)
        every = reduction_error(full, reduced_system(full, order, WORKING), WORKING)
        cells = [one.largest(growth=g, inputs=("nut",)) for g in (False, True)]
        cells += [every.largest(growth=g) for g in (False, True)]
        print(f"{order:5d} | {cells[0] * 1e3:8.3f} {cells[1] * 1e9:8.3f} | {cells[2] * 1e3:8.3f} {cells[3] * 1e9:8.3f}")
    print(reduction_error(full, reduced_system(full, 10, WORKING), WORKING).text())
    lumped = network(BENCH.rig, BENCH.at_speed(500 * RPM), 10).system()
    worst = reduction_error(full, lumped, WORKING)
    print(f"network of 11 lumps: {worst.largest(growth=False) * 1e3:.0f} mK, {worst.largest(growth=True) * 1e9:.0f} nm")


def _parametric() -> None:
    full = full_model(BENCH.rig)
    began = time.perf_counter()
    small = reduce_model([full], BENCH.limits())[0]
    built = time.perf_counter() - began
    speeds = np.repeat([500.0, 0.0, 750.0, 250.0, 0.0], [180, 120, 180, 60, 180]) * RPM
    ambient = np.full(720, 23.0)
    took = []
    for model in (full, small):
        began = time.perf_counter()
        simulate(BENCH, model, 30.0, speeds, ambient)
        took.append(time.perf_counter() - began)
    print(f"parametric, order {small.order}: built in {built:.2f} s; 6 h in rows of 30 s: {took[1] * 1e3:.1f} ms, "
          f"full model {took[0] * 1e3:.0f} ms")  # fmt: skip
    for speed in (30, 400, 1400):
        g = BENCH.at_speed(speed * RPM, 900.0)
        error = reduction_error(full.at(g), small.at(g), WORKING)
        print(f"  {speed:5d} rev/min, 900 N: {error.largest(growth=False) * 1e3:.2f} mK, "
              f"{error.largest(growth=True) * 1e9:.2f} nm")  # fmt: skip


def _every_speed() -> None:
    """One reduced model for all speeds beside the full one in compiled C, 180 min reported once a minute."""
    full = full_model(BENCH.rig)
    small = reduce_model([full], BENCH.limits())[0]
    grids = [discretise(BENCH.rig, cells) for cells in (Cells(), paper_cells(BENCH.rig))]
    print(f"parametric, order {small.order}; full: {' and '.join(str(parts.nodes) for parts in grids)} nodes (the "
          "default grid and the paper's), processor time")  # fmt: skip
    print("rev/min | mK | nm | full s | reduced ms | times faster")
    for speed in (20, 50, 100, 250, 500, 1000, 1500):
        ω = speed * RPM
        g, heat = BENCH.at_speed(ω), float(BENCH.heats(np.array([ω]))["nut"][0])
        error = reduction_error(full.at(g), small.at(g), WORKING)
        took = []
        for parts in grids:
            began = time.process_time()
            run_explicitly(parts, g, {"nut": heat}, BENCH.feed(ω), HOURS)
            took.append(time.process_time() - began)
        ran = min(_once(lambda g=g, heat=heat: small.at(g).step_response("nut", heat, 180, 60.0)) for _ in range(30))
        print(f"{speed:5d} | {error.largest(growth=False) * 1e3:.2f} | {error.largest(growth=True) * 1e9:.2f} | "
              f"{took[0]:.2f}, {took[1]:.2f} | {ran * 1e3:.3f} | {took[0] / ran:.0f}, {took[1] / ran:.0f}")  # fmt: skip


def _once(call: Callable[[], object]) -> float:
    began = time.perf_counter()
    call()
    return time.perf_counter() - began


def _moving() -> None:
    cells = Cells(200, 4, 40, 6)
    parts = discretise(BENCH.rig, cells)
    print("against the explicit scheme with moving nut, 180 min; errors of period means: nut mK, shaft mK, growth nm")
    head = ("rev/min", "travel mm", "explicit s", "imbalance", "ripple", "averaged", "order 10", "family", "build s",
            "run ms", "ratio")  # fmt: skip
    print(" | ".join(head))
    for low, high in ((0.22, 0.28), (0.15, 0.35), (0.05, 0.45)):
        travel = Travel(low, high)
        family = moving_family(BENCH, np.array([100, 200, 400, 800, 1200]) * RPM, travel, cells=cells)
        for speed in (150, 500, 900):
            g, feed = BENCH.at_speed(speed * RPM), BENCH.feed(speed * RPM)
            heat = float(BENCH.heats(np.array([speed * RPM]))["nut"][0])
            began = time.perf_counter()
            run = run_explicitly(parts, g, {"nut": heat}, feed, HOURS, travel=travel)
            explicit = time.perf_counter() - began
            began = time.perf_counter()
            full = model_of(parts, travel).at(g)
            basis = compressed_basis(full, WORKING)
            small = reduced_system(moving_system(parts, g, feed, basis, travel), 10, WORKING)
            built = time.perf_counter() - began
            began = time.perf_counter()
            small.step_response("nut", heat, 180, 60.0)
            ran = time.perf_counter() - began
            number = ripple_number(parts, g, feed, travel)
            shown = [_errors(run, system, heat) for system in (full, small, family.at(g, feed))]
            cells_of_row = (
                f"{speed}", f"{low * 1e3:.0f}-{high * 1e3:.0f}", f"{explicit:.1f}", f"{run.imbalance:.1e}",
                f"{number:.2f}", *shown, f"{built:.2f}", f"{ran * 1e3:.2f}", f"{explicit / ran:.0f}",
            )  # fmt: skip
            print(" | ".join(cells_of_row))


def _paper_grid() -> None:
    """The explicit scheme on the paper's own grid, wall and processor time beside the load of the machine."""
    parts, speed = discretise(BENCH.rig, paper_cells(BENCH.rig)), 500 * RPM
    heat = float(BENCH.heats(np.array([speed]))["nut"][0])
    began, used = time.perf_counter(), time.process_time()
    run = run_explicitly(parts, BENCH.at_speed(speed), {"nut": heat}, BENCH.feed(speed), HOURS)
    took, used = time.perf_counter() - began, time.process_time() - used
    load = ", ".join(f"{one:.1f}" for one in os.getloadavg())
    print(f"the paper's grid, {parts.nodes} nodes, {run.steps} steps, 180 min: {took:.1f} s, {used:.1f} s of processor "
          f"time; imbalance {run.imbalance:.1e}; {os.cpu_count()} processors, load {load}")  # fmt: skip


def _errors(run: ExplicitRun, system: HeatSystem, heat: float) -> str:
    shown = system.step_response("nut", heat, 1080, 10.0)
    grid = np.arange(1081) * 10.0
    own = np.column_stack([np.interp(run.times, grid, np.append(0.0, column)) for column in shown.T])
    error = np.abs(own - run.outputs).max(axis=0)
    return f"{error[0] * 1e3:5.1f} {error[3] * 1e3:5.1f} {error[4:].max() * 1e9:5.0f}"


if __name__ == "__main__":
    main()
