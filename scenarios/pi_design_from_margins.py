"""A velocity controller from a phase margin: by the formula for a rigid axis, and by the loop of the real one.

The textbook takes the axis as one inertia J behind the delay T_d of drive and sampling:

    w_c T_d = 90° - phase margin - atan(1/a),   K_p = J w_c,   T_n = a / w_c      (a = 4)

The script puts that design, and one from `feeddrive.tuning` with its notch, around the elastic machine, reads the
margins, and lets the nonlinear machine follow a step of the speed set-point.

    python scenarios/pi_design_from_margins.py [FOLDER]
"""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from feeddrive.files import find_plant, write_bytes_atomically
from feeddrive.metrology.response import step_response
from feeddrive.plant.files import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.report.drawing import AFTER, BEFORE, ReportFigure, dress, legend_above, new_figure, render
from feeddrive.servo.cascade import Cascade
from feeddrive.servo.cascade_function import cascade_controller, velocity_loop_of
from feeddrive.servo.frequency_response import Case
from feeddrive.servo.linear_loop import open_velocity_loop
from feeddrive.servo.margins import Margins, margins
from feeddrive.simulate.controlled import ControlledRun, TorqueLoop, resting_state, simulate_controlled
from feeddrive.simulate.scenario_controller import inertia_at_motor
from feeddrive.tuning.demand import Demand
from feeddrive.tuning.velocity_loop import velocity_gains

PHASE, SLOWER = 45.0, 4.0  # asked phase margin [deg], a
BEFORE_STEP, AFTER_STEP, STEP_AT, DURATION = 0.05, 0.06, 0.25, 0.5  # table velocities [m/s], times [s]


def drive(plant: Plant) -> Cascade:
    """8 kHz velocity loop, 1 kHz current loop, one tick of dead time; no gains yet."""
    tick = 125e-6
    return Cascade(plant.chain.motor_radius, tick, 4, 0.0, 0.0, math.inf, 1.0, current_lag=1 / (2 * math.pi * 1000),
                   dead_time=tick, torque_limit=plant.torque_limit)  # fmt: skip


def by_the_formula(plant: Plant, servo: Cascade) -> Cascade:
    """Gains for a rigid axis; half a tick each for the hold and for the speed as a difference of angles."""
    delay = servo.sample_time + servo.dead_time + servo.current_lag
    crossover = math.radians(90 - PHASE - math.degrees(math.atan(1 / SLOWER))) / delay
    reset = SLOWER / crossover
    return replace(servo, velocity_gain=inertia_at_motor(plant) * crossover, reset_time=reset, tracking_time=reset)


def by_the_loop(plant: Plant, servo: Cascade) -> Cascade:
    """Gains and notch that keep the margins of the elastic axis."""
    found = velocity_gains(plant, servo, [Case()], Demand(phase=PHASE))
    notches = tuple(choice.filter for choice in found.notches)
    return replace(servo, velocity_gain=found.gain, reset_time=found.reset_time, tracking_time=found.reset_time,
                   torque_filters=notches)  # fmt: skip


def stepped(plant: Plant, servo: Cascade) -> ControlledRun:
    """The machine under a step of the speed set-point, from one velocity to another."""
    loop, controller = TorqueLoop(servo.current_lag, servo.dead_time), cascade_controller(velocity_loop_of(servo))
    time = np.arange(round(DURATION / servo.sample_time)) * servo.sample_time
    reference = np.zeros((len(time), len(controller.references)))
    reference[:, 1] = np.where(time < STEP_AT, BEFORE_STEP, AFTER_STEP)
    start = resting_state(plant, controller, loop, velocity=BEFORE_STEP)
    return simulate_controlled(plant, controller, reference, torque_loop=loop, start=start)


def line(name: str, servo: Cascade, found: Margins, run: ControlledRun) -> str:
    """A row of the table."""
    gains = f"{servo.velocity_gain:6.2f} N m s/rad {1e3 * servo.reset_time:6.2f} ms"
    if not found.stable:
        tail = np.ptp(run.motor_speed[-800:]) * 30 / math.pi
        return f"  {name:16} {gains}   unstable: the machine rings with {tail:.0f} rev/min peak to peak"
    figures = step_response(run.time, run.motor_speed, STEP_AT)
    return (f"  {name:16} {gains}   {found.phase:5.1f}°  {found.gain:5.1f} dB   rise {1e3 * figures.rise:.2f} ms, "
            f"overshoot {100 * figures.overshoot:.0f} %")  # fmt: skip


def main(folder: Path) -> None:
    """Print the table, check it by the nonlinear machine, write the figure."""
    plant = read_plant(find_plant("bench_axis"))
    designs = {
        "formula, rigid": by_the_formula(plant, drive(plant)),
        "loop, with notch": by_the_loop(plant, drive(plant)),
    }
    figure = new_figure(3.6)
    axes = figure.subplots()
    print(f"{plant.name}: velocity loop for a phase margin of {PHASE:g}°\n")
    for (name, servo), colour in zip(designs.items(), (BEFORE, AFTER), strict=True):
        found, run = margins(open_velocity_loop(plant, servo)), stepped(plant, servo)
        print(line(name, servo, found, run))
        shown = np.abs(run.time - STEP_AT - 0.01) < 0.02
        axes.plot(1e3 * (run.time[shown] - STEP_AT), run.motor_speed[shown] * 30 / math.pi, color=colour, label=name)
    target = AFTER_STEP / plant.chain.motor_radius * 30 / math.pi
    axes.set_ylim(target - 90, target + 60)
    dress(axes, "time after the step [ms]", "motor speed [rev/min]", "step of the speed set-point")
    legend_above(axes, 2)
    print("\nThe rigid formula does not see the torsional mode at 512 Hz, whose peak stands above 0 dB at that gain.")
    path = folder / "pi_design_from_margins.png"
    write_bytes_atomically(path, render(ReportFigure("step", "Velocity step", "", figure)).png)
    print(f"Figure: {path}")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out"))
