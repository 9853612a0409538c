"""Gains that follow the table along its stroke, beside one set of gains that must hold everywhere.

The first resonance of the drive falls as the nut goes away from the fixed bearing, and with it the position gain that
the margins allow. The script tunes a cascade for the whole stroke and one for each of three positions, joins these to a
controller whose gains follow the measured position, and lets the nonlinear machine make a small step at both ends.

    python scenarios/gain_scheduling_over_position.py [FOLDER]
"""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from feeddrive.files import find_plant, write_bytes_atomically
from feeddrive.metrology.response import StepResponse, step_response
from feeddrive.plant.files import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.report.drawing import AFTER, BEFORE, ReportFigure, dress, legend_above, new_figure, render
from feeddrive.servo.cascade import KV_UNIT, Cascade, Feedback, FeedForward
from feeddrive.servo.cascade_function import cascade_controller
from feeddrive.servo.frequency_response import Case
from feeddrive.servo.linear_loop import open_position_loop
from feeddrive.servo.margins import margins
from feeddrive.servo.sampled import SampledController
from feeddrive.servo.scheduled import scheduled
from feeddrive.simulate.controlled import ControlledRun, TorqueLoop, resting_state, simulate_controlled
from feeddrive.tuning.demand import Demand
from feeddrive.tuning.position_loop import position_gain
from feeddrive.tuning.recommendation import recommend

POSITIONS = (0.0, 0.5, 1.0)  # of the table [m]
ENDS = (0.01, 0.99)
STEP, STEP_AT, DURATION = 0.2e-3, 0.02, 0.12  # [m, s, s]


def drive(plant: Plant) -> Cascade:
    """8 kHz velocity loop, 2 kHz position loop on the scale, 1 kHz current loop, one tick of dead time."""
    tick = 125e-6
    return Cascade(plant.chain.motor_radius, tick, 4, 0.0, 0.0, math.inf, 1.0, current_lag=1 / (2 * math.pi * 1000),
                   dead_time=tick, feedback=Feedback.TABLE, torque_limit=plant.torque_limit)  # fmt: skip


def stepped(plant: Plant, servo: Cascade, controller: SampledController, position: float) -> ControlledRun:
    """The nonlinear machine under a small step of the position set-point."""
    loop = TorqueLoop(servo.current_lag, servo.dead_time)
    time = servo.sample_time * np.arange(round(DURATION / servo.sample_time))
    reference = np.zeros((time.size, len(controller.references)))
    reference[:, 0] = position + np.where(time < STEP_AT, 0.0, STEP)
    start = resting_state(plant, controller, loop, position)
    return simulate_controlled(plant, controller, reference, torque_loop=loop, start=start)


def figures(run: ControlledRun) -> StepResponse:
    """Rise, overshoot and settling of the table."""
    return step_response(run.time, run.table_position, STEP_AT)


def cell(plant: Plant, servo: Cascade, place: float) -> str:
    """K_v and the gain margin of the position loop at a place."""
    found = margins(open_position_loop(plant, servo, position=place))
    return f"{servo.position_gain / KV_UNIT:5.2f} (m/min)/mm, {found.gain:4.1f} dB"


def main(folder: Path) -> None:
    """Tune, print, step the nonlinear machine at both ends, draw."""
    plant, demand = read_plant(find_plant("kimm_testbed")), Demand()
    everywhere = recommend(plant, drive(plant), [Case(place) for place in POSITIONS], demand).cascade
    everywhere = replace(everywhere, feed_forward=FeedForward())
    designs = []
    print(f"{plant.name}: K_p {everywhere.velocity_gain:.3g} N m s/rad, T_n {1e3 * everywhere.reset_time:.3g} ms\n")
    print("  table at    K_v for the stroke                    K_v for the place")
    for place in POSITIONS:
        own = replace(everywhere, position_gain=0.995 * position_gain(plant, everywhere, [Case(place)], demand).gain)
        designs.append(own)
        cells = [cell(plant, one, place) for one in (everywhere, own)]
        print(f"  {1e3 * place:5.0f} mm    {cells[0]:36}  {cells[1]}")
    following = scheduled(np.array(POSITIONS), [cascade_controller(one) for one in designs])
    figure = new_figure(3.4)
    panels = figure.subplots(1, 2, sharey=True)
    print(f"\n  step of {1e3 * STEP:g} mm, nonlinear machine")
    for place, axes in zip(ENDS, panels, strict=True):
        pairs = (("one K_v", cascade_controller(everywhere), BEFORE), ("K_v follows", following, AFTER))
        for name, controller, colour in pairs:
            run = stepped(plant, everywhere, controller, place)
            found = figures(run)
            print(f"  {1e3 * place:5.0f} mm    {name:12} rise {1e3 * found.rise:5.1f} ms, overshoot "
                  f"{100 * found.overshoot:4.1f} %, settled to 2 % in {1e3 * found.settling:5.1f} ms")  # fmt: skip
            axes.plot(1e3 * (run.time - STEP_AT), 1e6 * (run.table_position - place), color=colour, label=name)
        dress(axes, "time after the step [ms]", "table [µm]", f"table at {1e3 * place:.0f} mm")
        legend_above(axes, 2)
    path = folder / "gain_scheduling_over_position.png"
    write_bytes_atomically(path, render(ReportFigure("steps", "Steps at both ends", "", figure)).png)
    print(f"Figure: {path}")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out"))
