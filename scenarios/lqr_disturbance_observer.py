"""Optimal state feedback with a Kalman filter that observes the disturbance, beside the usual cascade.

    feedback    python-control's dlqr: table position against torque
    observer    stationary Kalman filter with the force on the table as a further, wandering state
    cascade     as `fd.tune` recommends it for the same drive

Both hold the moving table against a step of the force, on the nonlinear machine; the observer's estimate of that force
is shown beside the true one. Standing still is told too: there the friction is steeper than either design knows.

    python scenarios/lqr_disturbance_observer.py [FOLDER]
"""

from __future__ import annotations

import sys
from pathlib import Path

import control
import matplotlib.pyplot as plt
import numpy as np

import feeddrive as fd

RATE = 4000.0  # of the controller; one tick of dead time, current loop of 1 kHz [Hz]
ERROR, TORQUE = 3e-6, 1.0  # of equal weight [m, N m]
ENCODER, SCALE = 3e-6, 50e-9  # noise that the filter assumes [rad, m]
ACTING, PUSHING, WANDERING = 1.0, 20.0, 4e3  # unknown torque [N m] and force [N] per tick, drift of the load [N/s]
FORCE, FORCE_AT, START, MOVING = -500.0, 0.3, 0.1, 0.05  # [N, s, m, m/s]


def feedback(machine: control.StateSpace) -> np.ndarray:
    """Gain of least weighted error and torque."""
    row = machine.C[2:3]
    gain, _, _ = control.dlqr(machine.A, machine.B[:, :1], row.T @ row / ERROR**2, np.array([[1 / TORQUE**2]]))
    return np.asarray(gain)


def observer(machine: control.StateSpace) -> np.ndarray:
    """Gain of the stationary Kalman filter in predicting form, by the Riccati equation of the dual system."""
    loaded = fd.with_load(machine)
    torque, force = loaded.B[:, :1], loaded.B[:, 1:2]
    drift = np.zeros(loaded.A.shape)
    drift[-1, -1] = (WANDERING / RATE) ** 2
    process = torque @ torque.T * ACTING**2 + force @ force.T * PUSHING**2 + drift
    found, _, _ = control.dlqr(loaded.A.T, loaded.C.T, process, np.diag([ENCODER**2, SCALE**2]))
    return np.asarray(found).T


def pushed(axis: fd.Axis, loop: fd.Controller, velocity: float) -> fd.Motion:
    """The nonlinear machine, the table moving or standing, under a step of the force."""
    return fd.move(axis, loop, duration="0.6 s", start=START, moving=velocity, velocity=velocity,
                   position=lambda t: START + velocity * t,
                   force=lambda t: np.where(t < FORCE_AT, 0.0, FORCE))  # fmt: skip


def row(name: str, run: fd.Motion, velocity: float) -> np.ndarray:
    """Print what a run shows; the following error [µm]."""
    error: np.ndarray = 1e6 * (START + velocity * run.time - run["table_position"])
    pressed = error[run.time > FORCE_AT] - error[run.time <= FORCE_AT][-1]
    left, swing = abs(error[-400:].mean()), np.ptp(error[-400:])
    print(f"  {name:8} {'moving' if velocity else 'standing':9} gives way by {np.max(np.abs(pressed)):5.2f} µm, "
          f"is {left:.3f} µm off at the end, swings {swing:.3f} µm")  # fmt: skip
    return error


def main(folder: Path) -> None:
    """Design both, push both, print and draw."""
    axis = fd.load("bench_axis")
    machine = fd.sampled(axis, RATE)
    optimal = fd.state_feedback(axis, feedback(machine), observer(machine), RATE)
    tuned = fd.tune(axis, velocity_rate=RATE, position_rate=RATE, dead_time=1 / RATE, feedback="table")
    designs = {"cascade": fd.cascade(axis, tuned), "optimal": optimal}
    print(f"{axis.name}: step of {FORCE:g} N on the table, {RATE:g} Hz\n")
    for name, loop in designs.items():
        found = loop.margins()
        print(f"  {name:10} margins at the torque {found.phase:.1f}°, {found.gain:.1f} dB")
    figure, panels = plt.subplots(2, 1, sharex=True, figsize=(8.6, 4.8), layout="constrained")
    print()
    for name, loop in designs.items():
        run = pushed(axis, loop, MOVING)
        error = row(name, run, MOVING)
        row(name, pushed(axis, loop, 0.0), 0.0)
        shown = (run.time > FORCE_AT - 0.02) & (run.time < FORCE_AT + 0.12)
        time = 1e3 * (run.time[shown] - FORCE_AT)
        panels[0].plot(time, error[shown], label=name)
        if "load" in run.series:
            before = run["load"][run.time < FORCE_AT][-1]
            panels[1].plot(time, run["load"][shown] - before, label="as estimated, less friction")
            panels[1].plot(time, np.where(time < 0, 0.0, FORCE), color="0.2", linestyle="--", label="acting")
            print(f"  estimated force {run['load'][-400:].mean() - before:.1f} N, acting {FORCE:g} N")
    print(
        "\nMoving, the drag of nut and bearings acts on the screw; taken for a force on the table it leaves the optimal"
    )
    print("controller its small offset, which the integrator of the cascade does not have.")
    panels[0].set(ylabel="following error [µm]", title="moving at 3 m/min")
    panels[1].set(xlabel="time after the force [ms]", ylabel="force on the table [N]")
    for panel in panels:
        panel.legend()
        panel.grid(alpha=0.3)
    folder.mkdir(parents=True, exist_ok=True)
    figure.savefig(folder / "lqr_disturbance_observer.png", dpi=150)
    print(f"\nFigure: {folder / 'lqr_disturbance_observer.png'}")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out"))
