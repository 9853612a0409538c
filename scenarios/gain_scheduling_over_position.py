"""Gains that follow the table along its stroke, beside one set of gains that must hold everywhere.

The first resonance of the drive falls as the nut goes away from the fixed bearing, and with it the position gain that
the margins allow. The script tunes a cascade for the whole stroke and one for each of three positions, joins these to a
controller whose gains follow the measured position, and lets the nonlinear machine make a small step at both ends.

    python scenarios/gain_scheduling_over_position.py [FOLDER]
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import feeddrive as fd

POSITIONS = (0.0, 0.5, 1.0)  # of the table [m]
STEP, STEP_AT = 0.2e-3, 0.02  # [m, s]
METRES_PER_MINUTE_AND_MILLIMETRE = 60e-3  # K_v in (m/min)/mm per 1/s


def main(folder: Path) -> None:
    """Tune, print, step the nonlinear machine at both ends, draw."""
    axis = fd.load("kimm_testbed")
    servo = fd.tune(axis, positions=POSITIONS, feedback="table")
    everywhere = fd.cascade(axis, servo, feed_forward=False)
    following, gains = fd.schedule(axis, servo, POSITIONS)
    print(f"{axis.name}: K_p {servo.velocity_gain:.3g} N m s/rad, T_n {1e3 * servo.reset_time:.3g} ms\n")
    print("  table at    K_v for the stroke                    K_v for the place")
    for place, own in gains.items():
        cells = []
        for gain, loop in ((servo.position_gain, everywhere), (own, following)):
            margin = loop.margins("position", at=f"x={1e3 * place} mm").gain
            cells.append(f"{gain * METRES_PER_MINUTE_AND_MILLIMETRE:5.2f} (m/min)/mm, {margin:4.1f} dB")
        print(f"  {1e3 * place:5.0f} mm    {cells[0]:36}  {cells[1]}")
    figure, panels = plt.subplots(1, 2, sharey=True, figsize=(8.6, 3.4), layout="constrained")
    print(f"\n  step of {1e3 * STEP:g} mm, nonlinear machine")
    for place, panel in zip((0.01, 0.99), panels, strict=True):
        for name, loop in (("one K_v", everywhere), ("K_v follows", following)):
            run = fd.move(axis, loop, duration="0.12 s", start=place,
                          position=lambda t, x=place: x + np.where(t < STEP_AT, 0.0, STEP))  # fmt: skip
            found = run.step("table_position", at=STEP_AT)
            print(f"  {1e3 * place:5.0f} mm    {name:12} rise {1e3 * found.rise:5.1f} ms, overshoot "
                  f"{100 * found.overshoot:4.1f} %, settled to 2 % in {1e3 * found.settling:5.1f} ms")  # fmt: skip
            panel.plot(1e3 * (run.time - STEP_AT), 1e6 * (run["table_position"] - place), label=name)
        panel.set(xlabel="time after the step [ms]", title=f"table at {1e3 * place:.0f} mm")
        panel.legend()
        panel.grid(alpha=0.3)
    panels[0].set_ylabel("table [µm]")
    folder.mkdir(parents=True, exist_ok=True)
    figure.savefig(folder / "gain_scheduling_over_position.png", dpi=150)
    print(f"Figure: {folder / 'gain_scheduling_over_position.png'}")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out"))
