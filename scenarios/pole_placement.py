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
import matplotlib.pyplot as plt
import numpy as np

import feeddrive as fd

RATE = 4000.0  # of the controller; one tick of dead time, current loop of 1 kHz [Hz]
AXIS, AXIAL, TORSIONAL = (60.0, 0.8), (240.0, 0.08), (512.5, 0.0152)  # frequency [Hz], damping
OBSERVER, LOAD = ((600.0, 0.7), (240.0, 0.3), (404.0, 0.04)), 15.0
FORCE, FORCE_AT, START = -500.0, 0.3, 0.1  # [N, s, m]


def poles(pairs: tuple[tuple[float, float], ...], real: tuple[float, ...], fast: float) -> np.ndarray:
    """Poles in z of pairs (frequency [Hz], damping) and real ones [Hz]; `fast` is that of the dead time."""
    rates = [2 * math.pi * f * complex(-d, sign * math.sqrt(1 - d * d)) for f, d in pairs for sign in (1.0, -1.0)] + [
        complex(-2 * math.pi * f) for f in real
    ]
    return np.append(np.exp(np.array(rates) / RATE), fast)


def designed(machine: control.StateSpace, angle: float) -> tuple[np.ndarray, np.ndarray]:
    """Gains of feedback and observer.

    States and readings are counted in table travel, with the motor's angle per travel: in rad beside m placing poles is
    badly conditioned.
    """
    size = np.array([angle, angle, 1.0, 600 * angle, 600 * angle, 600.0, 200.0, 200.0])
    placed = poles((AXIS, AXIAL, TORSIONAL), (1000.0,), 1e-3)
    gain = np.asarray(control.place(machine.A * size / size[:, None], machine.B[:, :1] / size[:, None], placed)) / size
    loaded = fd.with_load(machine)
    whole, outputs = np.append(size, 1e4), np.array([1 / angle, 1.0])
    dual = (loaded.A * whole / whole[:, None]).T, (outputs[:, None] * loaded.C * whole).T
    with warnings.catch_warnings():
        # With two outputs the poles leave freedom that is spent on conditioning; the poles are exact before it ends.
        warnings.filterwarnings("ignore", "Convergence was not reached", UserWarning)
        found = np.asarray(control.place(*dual, poles(OBSERVER, (1200.0, LOAD), 2e-3))).T
    return gain, whole[:, None] * found * outputs


def main(folder: Path) -> None:
    """Print poles, margins and how the machine gives way; write the figure."""
    axis = fd.load("bench_axis")
    machine = fd.sampled(axis, RATE)
    gain, observer = designed(machine, 2 * math.pi / axis.travel_per_turn)
    loop = fd.state_feedback(axis, gain, observer, RATE)
    reached = np.linalg.eigvals(machine.A - machine.B[:, :1] @ gain)
    print(f"{axis.name}: state feedback at {RATE:g} Hz\n\n  poles of the feedback")
    for pole in sorted(np.log(reached[np.abs(reached) > 0.01]) * RATE, key=abs):
        if pole.imag >= 0:
            print(f"    {abs(pole) / (2 * math.pi):7.1f} Hz, damping {-pole.real / abs(pole):.3f}")
    found = loop.margins()
    print(
        f"  margins at the torque: {found.phase:.1f}°, {found.gain:.1f} dB, sensitivity peak {found.sensitivity:.2f}\n"
    )
    figure, panels = plt.subplots(2, 1, sharex=True, figsize=(8.6, 4.6), layout="constrained")
    for velocity, label in ((0.0, "standing"), (0.05, "moving at 3 m/min")):
        run = fd.move(axis, loop, duration="0.6 s", start=START, moving=velocity, velocity=velocity,
                      position=lambda t, v=velocity: START + v * t,
                      force=lambda t: np.where(t < FORCE_AT, 0.0, FORCE))  # fmt: skip
        error = 1e6 * (START + velocity * run.time - run["table_position"])
        print(f"  {label:18} gives way by {np.max(np.abs(error[run.time > FORCE_AT])):.2f} µm, "
              f"stays {abs(error[-400:].mean()):.3f} µm off, swings {np.ptp(error[-400:]):.3f} µm")  # fmt: skip
        shown = (run.time > FORCE_AT - 0.02) & (run.time < FORCE_AT + 0.1)
        panels[0].plot(1e3 * (run.time[shown] - FORCE_AT), error[shown], label=label)
        panels[1].plot(1e3 * (run.time[shown] - FORCE_AT), run["load"][shown])
    print(
        "\nMoving, the drag of nut and bearings acts on the screw; taken for a force on the table it leaves an offset."
    )
    panels[0].set(ylabel="following error [µm]", title=f"force of {FORCE:g} N on the table")
    panels[1].set(xlabel="time after the force [ms]", ylabel="load as estimated [N]", title="friction included")
    panels[0].legend()
    folder.mkdir(parents=True, exist_ok=True)
    figure.savefig(folder / "pole_placement.png", dpi=150)
    print(f"Figure: {folder / 'pole_placement.png'}")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out"))
