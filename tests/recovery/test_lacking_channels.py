"""Recordings as real drives give them: without a torque, with a current of unknown constant, coarse, slow or fast."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.errors import InputError
from feeddrive.recording import Recording
from tests.generator.axis import AXES
from tests.generator.effects import Effect, FrictionDeviation, TorqueRipple
from tests.generator.pair import Channels, recording_pair
from tests.recovery.planted import axis_plant

PLANT = axis_plant("light")
STRONGER = FrictionDeviation(port="table", coulomb_factor=1.25, viscous_factor=0.8)
RIPPLE = TorqueRipple(amplitude=0.06, order=6.0, phase=0.7)
CONSTANT = 0.61
"""Torque per current of the recordings below [N m/A]."""


@cache
def channels(effect: Effect | None) -> tuple[Channels, Channels]:
    """What a planted axis records, to fit and to judge."""
    return recording_pair(AXES["light"], (effect,) if effect else (), (71, 72), (6.8, 6.0))


def recording(name: str, rows: Channels, **other: np.ndarray | None) -> Recording:
    """A recording with some channels replaced, or left out where None."""
    kept = {key: value for key, value in {**rows, **other}.items() if value is not None}
    time = kept.pop("time")
    return Recording(name, time, kept, float(time[-1] - time[0]) / (len(time) - 1))


def by_current(effect: Effect | None) -> list[Recording]:
    """With the current in place of the torque."""
    return [
        recording(name, rows, motor_torque=None, motor_current=rows["motor_torque"] / CONSTANT)
        for name, rows in zip(("fitted", "judged"), channels(effect), strict=True)
    ]


def without_torque(effect: Effect | None) -> list[Recording]:
    """Encoder and scale alone."""
    pairs = zip(("fitted", "judged"), channels(effect), strict=True)
    return [recording(name, rows, motor_torque=None) for name, rows in pairs]


def diagnosed(pair: list[Recording]) -> Diagnosis:
    """The diagnosis of one to fit and one to judge."""
    return diagnose(PLANT, pair[:1], pair[1:])[0]


def names(result: Diagnosis) -> list[str]:
    """Effects in the order found."""
    return [effect.name for effect in result.effects]


def test_current_of_unknown_constant_gives_its_constant_and_the_effect() -> None:
    result = diagnosed(by_current(STRONGER))
    assert names(result) == ["friction_deviation"]
    found = result.effects[0].parameters
    # the inertia sets the scale: what is free beside the two factors widens their scatter a little
    assert found["coulomb_factor"].value == pytest.approx(1.25, rel=0.02)
    assert found["viscous_factor"].value == pytest.approx(0.8, rel=0.02)
    sentence = next(note for note in result.notes if note.startswith("motor_current"))
    # 0.61 N m/A as written: three digits, a unit in the last of which is 0.2 %
    constant = float(sentence.split(";")[1].split("N m/A")[0])
    assert constant == pytest.approx(CONSTANT, rel=0.01)


def test_wrong_scale_alone_is_no_effect() -> None:
    assert names(diagnosed(by_current(None))) == []


def test_declared_constant_makes_a_torque() -> None:
    plant = replace(PLANT, torque_constant=CONSTANT)
    pair = by_current(None)
    result = diagnose(plant, pair[:1], pair[1:])[0]
    assert names(result) == []
    assert any("0.61 N m/A, as declared" in note for note in result.notes)
    wrong = diagnose(replace(PLANT, torque_constant=0.8 * CONSTANT), pair[:1], pair[1:])[0]
    assert wrong.channels[0].before.relative > 0.1  # of a torque that is a fifth too small


def test_current_of_the_other_sign_is_refused() -> None:
    pair = [recording(one.name, {"time": one.time, **one.channels}, motor_current=-one["motor_current"])
            for one in by_current(None)]  # fmt: skip
    with pytest.raises(InputError, match="does not follow the torque"):
        diagnosed(pair)


def test_encoder_and_scale_alone_show_friction_through_the_spring() -> None:
    result = diagnosed(without_torque(STRONGER))
    assert names(result) == ["friction_deviation"]
    assert result.effects[0].parameters["coulomb_factor"].value == pytest.approx(1.25, rel=0.02)  # 15 nm of 2 um
    assert [channel.name for channel in result.channels] == ["table_position"]


def test_encoder_and_scale_alone_say_what_they_cannot_show() -> None:
    result = diagnosed(without_torque(RIPPLE))
    assert names(result) == []
    reasons = {refused.name: refused.reason for refused in result.refused}
    assert reasons["torque_ripple"] == "the recordings hold no torque or current"
    assert any("nothing can be said of" in note and "torque_ripple" in note for note in result.notes)


def test_encoder_alone_is_refused() -> None:
    rows = channels(None)[0]
    with pytest.raises(InputError, match="nothing that the motor's motion predicts"):
        diagnosed([recording("alone", rows, motor_torque=None, table_position=None)] * 2)


@pytest.mark.parametrize("effect", [None, STRONGER])
def test_scale_of_one_micrometre(effect: Effect | None) -> None:
    pairs = zip(("fitted", "judged"), channels(effect), strict=True)
    steps = [recording(name, rows, table_position=1e-6 * np.round(rows["table_position"] / 1e-6))
             for name, rows in pairs]  # fmt: skip
    result = diagnosed(steps)
    assert names(result) == ([effect.name] if effect else [])
    assert result.channels[1].noise_rms == pytest.approx(1e-6 / np.sqrt(12), rel=0.01)  # steps, not dithered
    assert result.channels[1].after.rms < result.channels[1].noise_rms  # some of it is above the band


def test_motor_torque_share_is_read_from_a_file(tmp_path: Path) -> None:
    from feeddrive.recording import read_recording

    rows = channels(None)[0]
    heading = "time [s],motor_angle [rad],motor_torque_share [%]"
    table = np.column_stack([rows["time"], rows["motor_angle"], 10.0 * rows["motor_torque"]])
    np.savetxt(tmp_path / "share.csv", table, delimiter=",", header=heading, comments="")
    read = read_recording(tmp_path / "share.csv")
    assert np.allclose(read["motor_torque_share"], 0.1 * rows["motor_torque"])
    result = diagnose(PLANT, [read])[0]
    assert any(note.startswith("motor_torque_share: its torque per unit") for note in result.notes)
    assert names(result) == []
