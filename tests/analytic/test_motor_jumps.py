"""A motor angle that no torque can make: rows written twice or lost, told by the motor's limit where no scale does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from feeddrive.diagnosis.preparation import prepared
from feeddrive.diagnosis.suspicion.motor_jumps import HARDER, refuse_motor_jumps
from feeddrive.errors import InputError
from feeddrive.files import find_plant
from feeddrive.plant.analysis.modes import inertia_at_motor
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import Recording
from feeddrive.recording.checks.flaws import JOINED, flaw
from tests.recovery.planted import axis_plant, pair

BENCH = axis_plant("bench")


def moving(rows: int = 4000, sample_time: float = 0.001) -> Recording:
    """A sine of the motor, 200 rad to either side within 2 s."""
    time = sample_time * np.arange(rows)
    angle = 2e-4 * np.round(200.0 * np.sin(np.pi * time) / 2e-4)
    return Recording("moving", time, {"motor_angle": angle, "motor_torque": np.sin(np.pi * time)}, sample_time)


def limit_of(jump: float, sample_time: float = 0.001) -> float:
    """Torque limit at which the motor's rotor could just be turned by so much more in one row [N m]."""
    return jump / sample_time**2 * BENCH.chain_values()["motor_inertia"] / HARDER


@pytest.mark.parametrize(("share", "refused"), [(0.9, True), (1.1, False)])
def test_rows_written_twice_are_refused_where_no_torque_makes_them(share: float, refused: bool) -> None:
    one = moving()
    angle = one["motor_angle"].copy()
    angle[700:] = np.concatenate([angle[670:700], angle[700:-30]])  # the thirty rows before 700 come again
    steps = np.diff(angle)
    jump = abs(steps[699] - np.median(np.r_[steps[679:699], steps[700:720]])) - 4 * 2e-4
    plant = replace(BENCH, torque_limit=share * limit_of(jump))
    there = one.with_channels({"motor_angle": angle})
    if not refused:
        refuse_motor_jumps(there, plant)
        return
    with pytest.raises(InputError, match=r"moving: motor_angle jumps by .* at 0\.699 s, 5\.56 times"):
        refuse_motor_jumps(there, plant)
    refuse_motor_jumps(replace(there, flaws=(flaw("motor_angle", JOINED, np.array([699]), angle),)), plant)
    refuse_motor_jumps(there, replace(BENCH, torque_limit=float("inf")))


def test_a_rigid_machine_has_no_rotor_of_its_own() -> None:
    """Its inertia may stand in the mass alone: the motor turns that, and one without a rotor is no division by none."""
    emps = read_plant(find_plant("emps"))
    assert emps.chain_values()["motor_inertia"] == 0.0
    one = moving()
    angle = one["motor_angle"].copy()
    angle[700:] = np.concatenate([angle[670:700], angle[700:-30]])
    jumping, hard = (
        one.with_channels({"motor_angle": angle}),
        10.0 / one.sample_time**2 * inertia_at_motor(emps) / HARDER,
    )
    refuse_motor_jumps(jumping, replace(emps, torque_limit=2 * hard))  # it jumps by some 12 rad
    refuse_motor_jumps(one, replace(emps, torque_limit=hard))
    with pytest.raises(InputError, match="motor_angle jumps by"):
        refuse_motor_jumps(jumping, replace(emps, torque_limit=hard))


@pytest.mark.parametrize("effect", ["null", "backlash", "presliding"])
def test_motion_that_a_drive_makes_is_none(effect: str) -> None:
    assert np.isfinite(BENCH.torque_limit)
    for one in pair("bench", effect):
        refuse_motor_jumps(one, BENCH)


def test_a_diagnosis_is_refused_by_it() -> None:
    one = pair("bench", "null")[0]
    angle = one["motor_angle"].copy()
    start = int(np.argmax(np.abs(np.diff(angle)))) + 1
    angle[start:] = np.concatenate([angle[start - 60 : start], angle[start:-60]])
    channels = {"motor_angle": angle, "motor_torque": one["motor_torque"]}
    there = Recording(one.name, one.time, channels, one.sample_time)
    with pytest.raises(InputError, match="rows are lost or written twice there"):
        prepared(BENCH, [there], [], 0.75)
