"""An axis without a linear scale repeats one servo cycle for hours: what its heat does to position and torque.

Milliseconds of the servo and hours of heat are one run: a cycle is simulated tick by tick, its friction heats the
screw, and it is simulated again whenever the temperatures have changed enough. The script prints the course and the
energy balance, and writes one figure.

    python scenarios/warm_up_of_an_axis.py [FOLDER [HOURS]]
"""

from __future__ import annotations

import sys
from pathlib import Path

from feeddrive.files import find_scenario_file, write_bytes_atomically
from feeddrive.report.figures.drawing import render
from feeddrive.report.figures.figure_warm_axis import warm_axis_figure
from feeddrive.simulate.scenario.scenario_file import read_scenario
from feeddrive.simulate.warm.warm_up_result import WarmUpRun
from feeddrive.simulate.warm.warm_up_run import MacroSteps, run_warm_up
from feeddrive.thermal.full.full_model import NUT, SHAFT

HOURS = 4.0
SHOWN = 10  # rows of the table
TOLERANCE = 0.05  # of the coupling in one macro step [K]


def print_course(run: WarmUpRun) -> None:
    """The run in some rows."""
    places = "".join(f"{f'at {1e3 * stop:.4g} mm':>12}" for stop in run.stops)
    print(f"  time        nut      shaft   nut drag   bearings    preload{places}")
    for point in run.points[:: -max(len(run.points) // SHOWN, 1)][::-1]:
        cycle, at = point.cycle, point.temperatures
        errors = "".join(f"{1e6 * error:9.2f} µm" for error in cycle.stop_errors)
        print(
            f"{point.time / 60:6.1f} min {at[NUT]:6.2f} °C {at[SHAFT]:6.2f} °C {cycle.nut_torque:6.3f} N m "
            f"{cycle.bearing_torque:6.3f} N m {cycle.preload:8.0f} N{errors}"
        )


def print_energy(run: WarmUpRun) -> None:
    """Work in, and what became of it."""
    energy = run.energy
    rows = {
        "motor, mechanical": energy.motor, "its winding": energy.winding, "given to the air": energy.to_surroundings,
        "stored as heat": energy.stored, "left in the bed": energy.to_bed, "work out": energy.work_out,
    }  # fmt: skip
    for name, value in rows.items():
        print(f"  {name:20}{value / 1e3:10.1f} kJ")
    print(f"  not accounted for: {100 * energy.imbalance:+.3f} % of the work in")


def main(folder: Path | None, hours: float) -> None:
    """Run, print, and write the figure into a folder, where one is given."""
    scenario = read_scenario(find_scenario_file("warm_up_cycle.toml"))
    run = run_warm_up(scenario, hours * 3600.0, MacroSteps(TOLERANCE))
    repeated = f"{run.time[-1] / run.cycle_duration:.0f} cycles of {run.cycle_duration:.3g} s"
    print(f"{scenario.plant.name}: {repeated}, {run.cycles} of them simulated")
    print_course(run)
    print("Energy")
    print_energy(run)
    if folder is not None:
        drawn = render(warm_axis_figure(run))
        write_bytes_atomically(folder / f"{drawn.stem}.png", drawn.png)
        print(f"{folder / drawn.stem}.png: {drawn.caption}")


if __name__ == "__main__":
    given = sys.argv[1:]
    main(Path(given[0]) if given else None, float(given[1]) if len(given) > 1 else HOURS)
