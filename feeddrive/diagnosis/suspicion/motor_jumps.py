"""A motor angle that jumps further than the motor can turn its own rotor: rows that are lost or written twice.

    |x_(k+1) - x_k - s| - 4 q  >  `HARDER` T / J h²

| symbol | meaning | unit |
|---|---|---|
| x | motor angle where a step from row to row is odd (`recording.checks.bad_cells`) | rad |
| s | usual step beside it | rad |
| q | resolution | rad |
| T, J | torque limit and inertia of the rotor, of a rigid machine of all that it turns, as declared | N m, kg m² |
| h | sample time | s |

A file alone is asked for accelerations that no drive reaches; that of this motor is known beside its plant.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import maximum_filter1d

from feeddrive.errors import InputError
from feeddrive.plant.analysis.modes import inertia_at_motor
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.recording.checks.bad_cells import AROUND, odd_steps, rows_per_change
from feeddrive.recording.checks.flaws import resolution
from feeddrive.typing import BoolArray
from feeddrive.units.quantity import format_quantity

HARDER = 5.0
"""Torque on a rotor over its motor's limit, at most: that itself, the twice that a step of it winds the shaft up by,
and half as much again, as limit and inertia are declared to no better."""


def refuse_motor_jumps(recording: Recording, plant: Plant) -> None:
    """Refuse a motor angle that jumps as no torque can make the motor.

    Args:
        recording: of motion; one without a motor angle is not asked.
        plant: one without a torque limit does not tell.

    Raises:
        InputError: names the row.
    """
    if "motor_angle" not in recording or not np.isfinite(plant.torque_limit):
        return
    angle, step = recording["motor_angle"], resolution(recording["motor_angle"])
    hold = recording.sample_time * rows_per_change(angle)
    # of a rigid machine the motor turns all that moves
    inertia = plant.chain_values()["motor_inertia"] if plant.chain.elastic else inertia_at_motor(plant)
    hardest = HARDER * plant.torque_limit / inertia * hold**2
    steps, known = np.diff(angle), _known(recording)
    for row in odd_steps(angle, step).tolist():
        beside = np.r_[steps[max(0, row - AROUND) : row], steps[row + 1 : row + 1 + AROUND]]
        jump = float(steps[row] - np.median(beside))
        if known[row] and abs(jump) - 4 * step > hardest:
            what = (
                f"motor_angle jumps by {format_quantity(jump, 'rad')} at {recording.time[row]:.6g} s, "
                f"{abs(jump) / hardest * HARDER:.3g} times as far as the motor's torque limit turns its rotor in a row"
            )
            mend = (
                "rows are lost or written twice there: cut the file there, or record again; "
                "else correct torque_limit or inertia of the motor"
            )
            raise InputError(what, recording.name, mend)


def _known(recording: Recording) -> BoolArray:
    """Samples with no flaw and no end of the recording within `AROUND` rows, (n,)."""
    flawed = np.zeros(len(recording), dtype=bool)
    flawed[0], flawed[-1] = True, True
    for flaw in recording.flaws:
        flawed[flaw.rows] = True
    known: BoolArray = ~maximum_filter1d(flawed, 2 * AROUND + 1)
    return known
