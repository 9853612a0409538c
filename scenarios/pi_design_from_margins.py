"""A velocity controller from a phase margin: by the formula for a rigid axis, and by the loop of the real one.

The textbook takes the axis as one inertia J behind the delay T_d of drive and sampling:

    w_c T_d = 90° - phase margin - atan(1/a),   K_p = J w_c,   T_n = a / w_c      (a = 4)

The script puts that design, and the one of `fd.tune` with its notch, around the elastic machine, reads the margins, and
lets the nonlinear machine follow a step of the speed set-point.

    python scenarios/pi_design_from_margins.py [FOLDER]
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import feeddrive as fd

PHASE, SLOWER = 45.0, 4.0  # asked phase margin [deg], a
TICK, LAG = 125e-6, 1 / (2 * math.pi * 1000)  # of the velocity loop, of the current loop [s]; dead time of one tick
BEFORE_STEP, AFTER_STEP, STEP_AT = 0.05, 0.06, 0.25  # table velocities [m/s], time [s]
REV_PER_MIN = 30 / math.pi


def by_the_formula(axis: fd.Axis) -> fd.Controller:
    """Gains for a rigid axis; half a tick each for the hold and for the speed as a difference of angles."""
    delay = TICK + TICK + LAG
    crossover = math.radians(90 - PHASE - math.degrees(math.atan(1 / SLOWER))) / delay
    return fd.cascade(axis, velocity_gain=axis.inertia_at_motor * crossover, reset_time=SLOWER / crossover)


def by_the_loop(axis: fd.Axis) -> fd.Controller:
    """Gains and notch that keep the margins of the elastic axis; the position loop stays open."""
    return fd.cascade(axis, fd.tune(axis, phase=f"{PHASE} deg"), position_gain=0.0)


def main(folder: Path) -> None:
    """Print the table, check it by the nonlinear machine, write the figure."""
    axis = fd.load("bench_axis")
    print(f"{axis.name}: velocity loop for a phase margin of {PHASE:g}°\n")
    figure, panel = plt.subplots(figsize=(8.6, 3.6), layout="constrained")
    for name, loop in (("formula, rigid", by_the_formula(axis)), ("loop, with notch", by_the_loop(axis))):
        run = fd.move(axis, loop, duration="0.5 s", moving=BEFORE_STEP,
                          velocity=lambda t: np.where(t < STEP_AT, BEFORE_STEP, AFTER_STEP))  # fmt: skip
        found, speed = loop.margins(), run["motor_speed"] * REV_PER_MIN
        if found.stable:
            step = run.step("motor_speed", at=STEP_AT)
            print(f"  {name:16} {found.phase:5.1f}°  {found.gain:5.1f} dB   rise {1e3 * step.rise:.2f} ms, "
                  f"overshoot {100 * step.overshoot:.0f} %")  # fmt: skip
        else:
            print(f"  {name:16} unstable: the machine rings with {np.ptp(speed[-800:]):.0f} rev/min peak to peak")
        panel.plot(1e3 * (run.time - STEP_AT), speed, label=name)
    target = np.median(speed[-800:])
    panel.set(xlim=(-10, 30), ylim=(target - 90, target + 60), xlabel="time after the step [ms]",
              ylabel="motor speed [rev/min]", title="step of the speed set-point")  # fmt: skip
    panel.legend()
    panel.grid(alpha=0.3)
    print("\nThe rigid formula does not see the torsional mode at 512 Hz, whose peak stands above 0 dB at that gain.")
    folder.mkdir(parents=True, exist_ok=True)
    figure.savefig(folder / "pi_design_from_margins.png", dpi=150)
    print(f"Figure: {folder / 'pi_design_from_margins.png'}")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out"))
