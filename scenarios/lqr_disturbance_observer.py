"""Optimal state feedback with a Kalman filter that observes the disturbance, beside the usual cascade.

    feedback    python-control's dlqr: table position against torque
    observer    stationary Kalman filter with the force on the table as a further, wandering state
    cascade     as `feeddrive tune` recommends it for the same drive

Both hold the moving table against a step of the force, on the nonlinear machine; the observer's estimate of that force
is shown beside the true one. Standing still is told too: there the friction is steeper than either design knows.

    python scenarios/lqr_disturbance_observer.py [FOLDER]
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import control
import numpy as np

from feeddrive.files import find_plant, write_bytes_atomically
from feeddrive.plant.files import read_plant
from feeddrive.plant.linear import MOVING
from feeddrive.plant.plant import Plant
from feeddrive.report.drawing import AFTER, BEFORE, MEASURED, ReportFigure, dress, legend_above, new_figure, render
from feeddrive.servo.cascade import Cascade, Feedback
from feeddrive.servo.cascade_function import cascade_controller
from feeddrive.servo.frequency_response import Case
from feeddrive.servo.linear_loop import open_velocity_loop
from feeddrive.servo.margins import margins
from feeddrive.servo.sampled import SampledController
from feeddrive.servo.sampled_plant import Matrices, sampled_plant
from feeddrive.servo.state_feedback import open_loop, state_feedback, with_load
from feeddrive.simulate.controlled import ControlledRun, TorqueLoop, resting_state, simulate_controlled
from feeddrive.tuning.demand import Demand
from feeddrive.tuning.recommendation import recommend
from feeddrive.typing import FloatArray

TICK, LAG = 1 / 4000, 1 / (2 * math.pi * 1000)  # one tick of dead time, current loop of 1 kHz [s]
ERROR, TORQUE = 3e-6, 1.0  # of equal weight [m, N m]
ENCODER, SCALE = 3e-6, 50e-9  # noise that the filter assumes [rad, m]
ACTING, PUSHING, WANDERING = 1.0, 20.0, 4e3  # unknown torque [N m] and force [N] per tick, drift of the load [N/s]
FORCE, FORCE_AT, DURATION, START = -500.0, 0.3, 0.6, 0.1  # [N, s, s, m]


def feedback(machine: Matrices) -> FloatArray:
    """Gain of least weighted error and torque."""
    row = machine.c[2:3]
    gain, _, _ = control.dlqr(machine.a, machine.b[:, :1], row.T @ row / ERROR**2, np.array([[1 / TORQUE**2]]))
    return np.asarray(gain)


def observer(machine: Matrices) -> FloatArray:
    """Gain of the stationary Kalman filter in predicting form, by the Riccati equation of the dual system."""
    a, c = with_load(machine)
    torque, force = (np.append(machine.b[:, i], 0.0)[:, None] for i in (0, 1))
    drift = np.zeros((len(a), len(a)))
    drift[-1, -1] = (WANDERING * TICK) ** 2
    process = torque @ torque.T * ACTING**2 + force @ force.T * PUSHING**2 + drift
    found, _, _ = control.dlqr(a.T, c.T, process, np.diag([ENCODER**2, SCALE**2]))
    return np.asarray(found).T


def pushed(plant: Plant, controller: SampledController, velocity: float) -> ControlledRun:
    """The nonlinear machine, the table moving or standing, under a step of the force."""
    loop, time = TorqueLoop(LAG, TICK), TICK * np.arange(round(DURATION / TICK))
    reference = np.zeros((time.size, len(controller.references)))
    reference[:, 0], reference[:, 1] = START + velocity * time, velocity
    load = np.where(time < FORCE_AT, 0.0, FORCE)
    start = resting_state(plant, controller, loop, START, velocity)
    return simulate_controlled(plant, controller, reference, load, loop, start)


def row(name: str, run: ControlledRun, velocity: float) -> FloatArray:
    """Print what a run shows; the following error [µm]."""
    error = 1e6 * (START + velocity * run.time - run.table_position)
    pressed = error[run.time > FORCE_AT] - error[run.time <= FORCE_AT][-1]
    motion = "moving" if velocity else "standing"
    left, swing = abs(error[-400:].mean()), np.ptp(error[-400:])
    print(f"  {name:8} {motion:9} gives way by {np.max(np.abs(pressed)):5.2f} µm, is {left:.3f} µm off at the end, "
          f"swings {swing:.3f} µm")  # fmt: skip
    return error


def main(folder: Path) -> None:
    """Design both, push both, print and draw."""
    plant = read_plant(find_plant("bench_axis"))
    bare = Cascade(plant.chain.motor_radius, TICK, 1, 0.0, 0.0, math.inf, 1.0, current_lag=LAG, dead_time=TICK,
                   feedback=Feedback.TABLE, torque_limit=plant.torque_limit)  # fmt: skip
    machine = sampled_plant(plant, bare)
    gains = feedback(machine), observer(machine)
    cascade = recommend(plant, bare, [Case()], Demand()).cascade
    print(f"{plant.name}: step of {FORCE:g} N on the table, {1 / TICK:g} Hz\n")
    for name, loop in (("optimal", open_loop(machine, TICK, *gains)), ("cascade", open_velocity_loop(plant, cascade))):
        found = margins(loop)
        print(f"  {name:10} margins at the torque {found.phase:.1f}°, {found.gain:.1f} dB")
    optimal = state_feedback(machine, TICK, *gains, torque_limit=plant.torque_limit, position=START)
    figure = new_figure(4.8)
    panels = figure.subplots(2, 1, sharex=True)
    print()
    for name, controller, colour in (("cascade", cascade_controller(cascade), BEFORE), ("optimal", optimal, AFTER)):
        run = pushed(plant, controller, MOVING)
        error = row(name, run, MOVING)
        row(name, pushed(plant, controller, 0.0), 0.0)
        shown = (run.time > FORCE_AT - 0.02) & (run.time < FORCE_AT + 0.12)
        time = 1e3 * (run.time[shown] - FORCE_AT)
        panels[0].plot(time, error[shown], color=colour, label=name)
        if "load" in run.signals:
            before = run.signals["load"][run.time < FORCE_AT][-1]
            panels[1].plot(time, run.signals["load"][shown] - before, color=colour, label="as estimated, less friction")
            panels[1].plot(time, np.where(time < 0, 0.0, FORCE), color=MEASURED, linestyle="--", label="acting")
            print(f"  estimated force {run.signals['load'][-400:].mean() - before:.1f} N, acting {FORCE:g} N")
    dress(panels[0], "", "following error [µm]", "moving at 3 m/min")
    dress(panels[1], "time after the force [ms]", "force on the table [N]")
    print(
        "\nMoving, the drag of nut and bearings acts on the screw; taken for a force on the table it leaves the optimal"
    )
    print("controller its small offset, which the integrator of the cascade does not have.")
    for panel in panels:
        legend_above(panel, 2)
    path = folder / "lqr_disturbance_observer.png"
    write_bytes_atomically(path, render(ReportFigure("force", "Force on the table", "", figure)).png)
    print(f"\nFigure: {path}")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out"))
