"""Recordings of a wrong sign, factor or clock are refused; machines that are other than declared are not."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.preparation import prepared
from feeddrive.diagnosis.suspicion.recording_faults import FAR_LESS, clocks, refuse_faulty, torque_parts
from feeddrive.effects.base import Effect, Port
from feeddrive.effects.catalogue import find_effect
from feeddrive.effects.chain.inertia_deviation import InertiaDeviation
from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.friction.friction_deviation import FrictionDeviation
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.errors import InputError
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from tests.recovery.planted import axis_plant, pair
from tests.recovery.rigid_runs import PLANT, Truth, rigid_run

AXES = ("bench", "light")


@cache
def null(axis: str) -> Recording:
    """A recording in which nothing is lacking."""
    return pair(axis, "null")[0]


def refuse(plant: Plant, recording: Recording) -> None:
    """What a diagnosis does before its search."""
    problem, judged, _ = prepared(plant, [recording], [], 0.75)
    refuse_faulty(problem, judged)


def times(recording: Recording, factor: float, offset: float = 0.0) -> Recording:
    """The recording with its torque times a factor."""
    torque = factor * recording["motor_torque"] + offset
    return replace(recording, channels={**recording.channels, "motor_torque": torque})


def slower(recording: Recording, factor: float) -> Recording:
    """The recording with its time stamps times a factor."""
    return replace(recording, time=factor * recording.time, sample_time=factor * recording.sample_time)


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize(
    ("factor", "said"),
    [
        (-1.0, "negative"),
        (100 / 30, "3.33 times"),
        (1 / 17, "0.0588 times"),
        (-0.4, "-0.4 times"),
        (math.sqrt(0.5), "rms value"),
        (math.sqrt(2.0), "peak value"),
    ],
)
def test_factor_is_refused_with_its_mend(axis: str, factor: float, said: str) -> None:
    with pytest.raises(InputError) as refused:
        refuse(axis_plant(axis), times(null(axis), factor, 0.3))
    line = str(refused.value)
    # the factor is read to three digits: noise of one percent over thousands of samples moves it by less than 0.1 %
    line = re.sub(r"-?\d+\.\d+ times", lambda found: f"{float(found[0].split()[0]):.3g} times", line)
    assert said in line and "\n" not in line


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("clock", [2.0, 0.5])
def test_clock_is_refused_with_the_true_rate(axis: str, clock: float) -> None:
    with pytest.raises(InputError, match=r"0\.0005 s"):
        refuse(axis_plant(axis), slower(null(axis), clock))


@pytest.mark.parametrize("axis", AXES)
def test_torque_without_its_sign_is_refused(axis: str) -> None:
    recording = null(axis)
    size = {**recording.channels, "motor_torque": np.abs(recording["motor_torque"])}
    with pytest.raises(InputError, match="lost its sign"):
        refuse(axis_plant(axis), replace(recording, channels=size))


def test_what_is_no_torque_is_refused() -> None:
    recording = null("bench")
    other = {**recording.channels, "motor_torque": 10 * recording["table_position"]}
    with pytest.raises(InputError, match="does not follow the motion"):
        refuse(axis_plant("bench"), replace(recording, channels=other))


# The machine is as it is, and the plant declares it otherwise: what is found would be the opposite deviation.
DEVIATIONS: dict[str, tuple[Effect, ...]] = {
    "table twice as heavy": (Payload.of(mass=134.0),),
    "table ten times as heavy": (Payload.of(mass=1200.0),),
    "table half as heavy": (Payload.of(mass=-67.0),),
    "rotor three times its inertia": (InertiaDeviation.of(None, "motor", inertia=5.2e-3),),
    "rotor a third of its inertia": (InertiaDeviation.of(None, "motor", inertia=-1.7e-3),),
    "guide friction half as large again": (FrictionDeviation.of(Port.TABLE, coulomb_factor=1.5, viscous_factor=1.5),),
    "all friction four times": tuple(
        FrictionDeviation.of(port, coulomb_factor=4.0, viscous_factor=4.0) for port in (Port.TABLE, Port.SCREW)
    ),
    "all friction a third": tuple(
        FrictionDeviation.of(port, coulomb_factor=0.33, viscous_factor=0.33) for port in (Port.TABLE, Port.SCREW)
    ),
    "heavier, and friction up by half": (
        Payload.of(mass=100.0),
        FrictionDeviation.of(Port.TABLE, coulomb_factor=1.5, viscous_factor=1.5),
    ),
    "vertical": (ConstantForce.of(force=1300.0),),
    "iron that saturates": (find_effect("torque_constant_droop").of(share=0.3, at_torque=5.0),),
    "stiffness a third": (find_effect("stiffness_deviation").of(factor=0.33),),
}


@pytest.mark.parametrize("name", DEVIATIONS)
def test_machine_other_than_declared_is_not_refused(name: str) -> None:
    refuse(axis_plant("bench").with_effects(*DEVIATIONS[name]), null("bench"))


@pytest.mark.parametrize("factor", [0.9, 1.1])
def test_torque_constant_within_its_tolerance_is_not_refused(factor: float) -> None:
    refuse(axis_plant("bench"), times(null("bench"), factor))


def friction_alone(clock: float, folder: Path) -> tuple[Plant, Recording]:
    """A rigid axis that hardly accelerates, in noise: a quarter of its inertia says nearly what another clock says."""
    path = folder / "rigid.toml"
    path.write_text(PLANT, encoding="utf-8")
    recording = rigid_run("slow", Truth(), 20.0, 3.0)
    noise = 4e-3 * np.random.default_rng(7).standard_normal(len(recording.time))
    louder = recording.with_channels({"motor_torque": recording["motor_torque"] + noise})
    return read_plant(path), slower(louder, clock)


def test_a_clock_that_an_inertia_nearly_says_is_refused_by_its_odds(tmp_path: Path) -> None:
    plant, recording = friction_alone(0.5, tmp_path)
    problem, _, _ = prepared(plant, [recording], [], 1.0)
    (evidence,) = problem.evidence
    assert isinstance(evidence, AxisEvidence)
    seen = torque_parts(problem, plant, evidence)
    assert seen is not None
    half = min(clocks(problem, plant, evidence), key=lambda fault: fault.left)
    assert FAR_LESS < half.left / seen.one_cause < half.least  # not by a quarter, but by its odds
    with pytest.raises(InputError, match=r"0\.002 s"):
        refuse(plant, recording)


def test_a_true_clock_is_not_refused_though_friction_is_nearly_all(tmp_path: Path) -> None:
    refuse(*friction_alone(1.0, tmp_path))
