"""State feedback by pole placement, with an observer that also estimates the load, on the nonlinear machine.

Measured are motor angle and table position; the observer gives the other states and the force on the table. Poles:

    axis as a whole     4 times as fast as a usual position loop, well damped
    axial, torsional    where they are, the first one damped more (moving poles far costs robustness, not placing them)
    observer            faster; one slow pole for the load

The script prints poles and margins, and how the table gives way to a force of 500 N, standing and moving.

    python scenarios/pole_placement.py [FOLDER]
"""

from __future__ import annotations

import math
import sys
import warnings
from pathlib import Path

import control
import numpy as np

from feeddrive.files import find_plant, write_bytes_atomically
from feeddrive.plant.files import read_plant
from feeddrive.plant.linear import MOVING
from feeddrive.plant.plant import Plant
from feeddrive.report.drawing import AFTER, BEFORE, ReportFigure, dress, legend_above, new_figure, render
from feeddrive.servo.cascade import Cascade
from feeddrive.servo.margins import margins
from feeddrive.servo.sampled import SampledController
from feeddrive.servo.sampled_plant import Matrices, sampled_plant
from feeddrive.servo.state_feedback import open_loop, state_feedback, with_load
from feeddrive.simulate.controlled import ControlledRun, TorqueLoop, resting_state, simulate_controlled
from feeddrive.typing import FloatArray

TICK, LAG = 1 / 4000, 1 / (2 * math.pi * 1000)  # one tick of dead time, current loop of 1 kHz [s]
AXIS, AXIAL, TORSIONAL = (60.0, 0.8), (240.0, 0.08), (512.5, 0.0152)  # frequency [Hz], damping
OBSERVER, LOAD = ((600.0, 0.7), (240.0, 0.3), (404.0, 0.04)), 15.0
FORCE, FORCE_AT, DURATION, START = -500.0, 0.3, 0.6, 0.1  # [N, s, s, m]


def sampled_poles(pairs: tuple[tuple[float, float], ...], real: tuple[float, ...], fast: float) -> FloatArray:
    """Poles in z of pairs (frequency [Hz], damping) and real ones [Hz]; `fast` is that of the dead time."""
    rates = [2 * math.pi * f * complex(-d, sign * math.sqrt(1 - d * d)) for f, d in pairs for sign in (1.0, -1.0)] + [
        complex(-2 * math.pi * f) for f in real
    ]
    return np.append(np.exp(np.array(rates) * TICK), fast)


def scales(plant: Plant) -> FloatArray:
    """Sizes of the states when all are counted in table travel: placing poles is badly conditioned in rad beside m."""
    angle = 1 / plant.chain.motor_radius
    return np.array([angle, angle, 1.0, 600 * angle, 600 * angle, 600.0, 200.0, 200.0])


def designed(plant: Plant, machine: Matrices) -> tuple[FloatArray, FloatArray]:
    """Gains of feedback and observer."""
    size = scales(plant)
    poles = sampled_poles((AXIS, AXIAL, TORSIONAL), (1000.0,), 1e-3)
    gain = np.asarray(control.place(machine.a * size / size[:, None], machine.b[:, :1] / size[:, None], poles)) / size
    a, c = with_load(machine)
    whole, outputs = np.append(size, 1e4), np.array([plant.chain.motor_radius, 1.0])
    dual = (a * whole / whole[:, None]).T, (outputs[:, None] * c * whole).T
    with warnings.catch_warnings():
        # With two outputs the poles leave freedom that is spent on conditioning; the poles are exact before it ends.
        warnings.filterwarnings("ignore", "Convergence was not reached", UserWarning)
        found = np.asarray(control.place(*dual, sampled_poles(OBSERVER, (1200.0, LOAD), 2e-3))).T
    return gain, whole[:, None] * found * outputs


def pushed(plant: Plant, controller: SampledController, velocity: float) -> ControlledRun:
    """The nonlinear machine under the force, standing or moving at constant velocity."""
    loop, time = TorqueLoop(LAG, TICK), TICK * np.arange(round(DURATION / TICK))
    reference = np.column_stack([START + velocity * time, np.full(time.size, velocity), np.zeros(time.size)])
    load = np.where(time < FORCE_AT, 0.0, FORCE)
    start = resting_state(plant, controller, loop, START, velocity)
    return simulate_controlled(plant, controller, reference, load, loop, start)


def main(folder: Path) -> None:
    """Print poles, margins and how the machine gives way; write the figure."""
    plant = read_plant(find_plant("bench_axis"))
    drive = Cascade(plant.chain.motor_radius, TICK, 1, 0.0, 0.0, math.inf, 1.0, current_lag=LAG, dead_time=TICK)
    machine = sampled_plant(plant, drive)
    gain, observer = designed(plant, machine)
    reached = np.linalg.eigvals(machine.a - machine.b[:, :1] @ gain)
    print(f"{plant.name}: state feedback at {1 / TICK:g} Hz\n\n  poles of the feedback")
    for pole in sorted(np.log(reached[np.abs(reached) > 0.01]) / TICK, key=abs):
        if pole.imag >= 0:
            print(f"    {abs(pole) / (2 * math.pi):7.1f} Hz, damping {-pole.real / abs(pole):.3f}")
    found = margins(open_loop(machine, TICK, gain, observer))
    print(
        f"  margins at the torque: {found.phase:.1f}°, {found.gain:.1f} dB, sensitivity peak {found.sensitivity:.2f}\n"
    )
    controller = state_feedback(machine, TICK, gain, observer, plant.torque_limit, START)
    figure = new_figure(4.6)
    panels = figure.subplots(2, 1, sharex=True)
    for velocity, colour, label in ((0.0, BEFORE, "standing"), (MOVING, AFTER, "moving at 3 m/min")):
        run = pushed(plant, controller, velocity)
        error = 1e6 * (START + velocity * run.time - run.table_position)
        pressed = run.time > FORCE_AT
        print(f"  {label:18} gives way by {np.max(np.abs(error[pressed])):.2f} µm, "
              f"stays {abs(error[-400:].mean()):.3f} µm off, swings {np.ptp(error[-400:]):.3f} µm")  # fmt: skip
        shown = (run.time > FORCE_AT - 0.02) & (run.time < FORCE_AT + 0.1)
        panels[0].plot(1e3 * (run.time[shown] - FORCE_AT), error[shown], color=colour, label=label)
        panels[1].plot(1e3 * (run.time[shown] - FORCE_AT), run.signals["load"][shown], color=colour)
    print(
        "\nMoving, the drag of nut and bearings acts on the screw; taken for a force on the table it leaves an offset."
    )
    dress(panels[0], "", "following error [µm]", f"force of {FORCE:g} N on the table")
    dress(panels[1], "time after the force [ms]", "load as estimated [N]", "friction included")
    legend_above(panels[0], 2)
    path = folder / "pole_placement.png"
    write_bytes_atomically(path, render(ReportFigure("force", "Force on the table", "", figure)).png)
    print(f"Figure: {path}")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out"))
