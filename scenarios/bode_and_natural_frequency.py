"""Frequency response and natural frequencies of a drive along its stroke, and whether the moving machine shows them.

The chain of the screw makes the first resonance depend on where the table stands. The script lists natural frequencies
(motor free and held) and the peak of the frequency response at some positions, then moves the nonlinear machine slowly
over each, shakes its torque by a binary sequence, and reads the peak from the averaged spectra as on a machine.

    python scenarios/bode_and_natural_frequency.py [FOLDER]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from feeddrive.files import find_plant, write_bytes_atomically
from feeddrive.metrology.recorded_response import recorded_response
from feeddrive.metrology.response import Response
from feeddrive.plant.files import read_plant
from feeddrive.plant.linear import steady_motion
from feeddrive.plant.modes import braked_modes, free_modes
from feeddrive.plant.plant import Plant
from feeddrive.recording.recording import Recording
from feeddrive.report.drawing import render
from feeddrive.report.figure_bode import bode_figure
from feeddrive.servo.frequency_response import Case
from feeddrive.servo.resonances import Kind
from feeddrive.servo.response_family import Curve, mechanics_family
from feeddrive.simulate.held_torque import simulate_torque

POSITIONS = (0.10, 0.50, 0.90)  # of the table [m]
VELOCITY = 0.02  # slow, so that the position hardly changes, but no reversal and no stiction [m/s]
TICK, DURATION = 1 / 4000, 2.0  # [s]
AMPLITUDE = 3.0  # of the binary sequence on the torque [N m]


def shaken(plant: Plant, position: float) -> Response:
    """Frequency response from motor torque to table velocity, as it is measured on the moving machine."""
    count = round(DURATION / TICK)
    steady = steady_motion(plant, VELOCITY, position).torque
    sequence = np.random.default_rng(1).integers(0, 2, count) * 2.0 - 1.0
    time, torque = TICK * np.arange(count), steady + AMPLITUDE * (sequence - sequence.mean())
    run = simulate_torque(plant, time, torque, position - 0.5 * VELOCITY * DURATION, VELOCITY)
    channels = {"motor_torque": torque, "table_velocity": run.velocity}
    return recorded_response(Recording("shaken", time, channels, TICK), "motor_torque", "table_velocity")


def measured_peak(found: Response, about: float) -> float:
    """Frequency of the largest magnitude within a fifth of `about` [Hz]."""
    near = np.abs(found.frequency / about - 1) < 0.2
    return float(found.frequency[near][np.argmax(np.abs(found.response[near]))])


def first_peak(curve: Curve) -> float:
    """Frequency of the first peak of a curve [Hz]."""
    return next(one.frequency for one in curve.seen if one.kind is Kind.RESONANCE)


def main(folder: Path) -> None:
    """Print the table, check it by the moving machine, write the figure."""
    plant = read_plant(find_plant("kimm_testbed"))
    cases = [Case(position, VELOCITY) for position in POSITIONS]
    family = mechanics_family(plant, "motor_torque", "table_velocity", cases, 10.0, 1000.0)
    print(f"{plant.name}: first natural frequency over the table position\n")
    print("  table at   motor held   motor free   peak of the response   peak of the moving machine")
    for curve in family.curves:
        position, peak = curve.case.position, first_peak(curve)
        held, free = (modes(plant, position).frequencies for modes in (braked_modes, free_modes))
        seen = measured_peak(shaken(plant, position), peak)
        print(f"  {1e3 * position:5.0f} mm   {held[0]:7.1f} Hz   {free[1]:7.1f} Hz   {peak:17.1f} Hz   {seen:15.1f} Hz"
              f"   ({100 * (seen / peak - 1):+.1f} %)")  # fmt: skip
    print("\nThe peak lies beside the natural frequency by damping alone; the machine's spectra resolve 8.5 Hz.")
    path = folder / "bode_and_natural_frequency.png"
    write_bytes_atomically(path, render(bode_figure(family)).png)
    print(f"Figure: {path}")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out"))
