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

import feeddrive as fd

POSITIONS = (0.10, 0.50, 0.90)  # of the table [m]
VELOCITY = 0.02  # slow, so that the position hardly changes, but no reversal and no stiction [m/s]
DURATION = 2.0  # [s]
AMPLITUDE = 3.0  # of the binary sequence on the torque [N m]


def measured_peak(axis: fd.Axis, position: float, about: float) -> float:
    """Frequency of the largest response within a fifth of `about`, as it is measured on the moving machine [Hz]."""
    sequence = np.random.default_rng(1).integers(0, 2, round(4000 * DURATION)) * 2.0 - 1.0
    run = fd.move(axis, torque=AMPLITUDE * (sequence - sequence.mean()), rate="4 kHz", duration=DURATION,
                  start=position - 0.5 * VELOCITY * DURATION, moving=VELOCITY)  # fmt: skip
    found = run.response("motor_torque", "table_velocity")
    near = np.abs(found.frequency / about - 1) < 0.2
    return float(found.frequency[near][np.argmax(np.abs(found.response[near]))])


def main(folder: Path) -> None:
    """Print the table, check it by the moving machine, write the figure."""
    axis = fd.load("kimm_testbed")
    bode = axis.bode("motor_torque", "table_velocity", at=f"v={VELOCITY} m/s", positions=POSITIONS,
                     frequencies=("10 Hz", "1 kHz"))  # fmt: skip
    modes = axis.modes(POSITIONS)
    print(f"{axis.name}: first natural frequency over the table position\n")
    print("  table at   motor held   motor free   peak of the response   peak of the moving machine")
    for number, (position, curve) in enumerate(zip(POSITIONS, bode.curves, strict=True)):
        peak = next(one.frequency for one in curve.seen if str(one.kind) == "resonance")
        seen = measured_peak(axis, position, peak)
        held, free = modes.held[number, 0], modes.free[number, 0]
        print(f"  {1e3 * position:5.0f} mm   {held:7.1f} Hz   {free:7.1f} Hz   {peak:17.1f} Hz   {seen:15.1f} Hz"
              f"   ({100 * (seen / peak - 1):+.1f} %)")  # fmt: skip
    print("\nThe peak lies beside the natural frequency by damping alone; the machine's spectra resolve 8.5 Hz.")
    folder.mkdir(parents=True, exist_ok=True)
    bode.plot().savefig(folder / "bode_and_natural_frequency.png", dpi=150)
    print(f"Figure: {folder / 'bode_and_natural_frequency.png'}")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out"))
