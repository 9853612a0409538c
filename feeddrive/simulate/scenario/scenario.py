"""A scenario: which plant moves how under which controller, and what is written down of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.recording.channels import CHANNEL_UNITS, INJECTED
from feeddrive.recording.recording import Recording
from feeddrive.servo.cascade import Cascade
from feeddrive.simulate.setpoints.cutting_force import Force
from feeddrive.simulate.setpoints.setpoint_motion import Trajectory
from feeddrive.simulate.setpoints.waveforms import Waveform
from feeddrive.typing import FloatArray


class Place(StrEnum):
    """Where an excitation is added: to the speed set-point or to the torque command."""

    SPEED = "speed"
    TORQUE = "torque"


@dataclass(frozen=True)
class Excitation:
    """A waveform added to the controller's own.

    Attributes:
        place: where.
        amplitude: of it [rad/s or N m].
        waveform: of amplitude 1.
        start: when it begins [s]; nothing before, nothing after its end.
    """

    place: Place
    amplitude: float
    waveform: Waveform
    start: float


@dataclass(frozen=True)
class Recorder:
    """What is written down.

    Attributes:
        divider: ticks of the controller per sample.
        channels: names after `recording.channels`, time left out.
        noise: channel to the standard deviation of white noise, SI.
        quantised: whether sensors are rounded to their declared resolution.
        seed: of the noise.
    """

    divider: int
    channels: tuple[str, ...]
    noise: Mapping[str, float]
    quantised: bool
    seed: int


@dataclass(frozen=True)
class Evaluation:
    """A figure that is asked for: its kind and its settings, numbers in SI or words."""

    kind: str
    settings: Mapping[str, float | str]


@dataclass(frozen=True)
class Scenario:
    """An experiment, ready to run.

    Attributes:
        name, description: for people.
        plant: the machine.
        cascade: its controller.
        trajectory: set-point of the table position.
        force: on the table.
        excitation: added within the controller, or None.
        recorder: what is written down.
        ticks: of the controller.
        evaluations: figures asked for.
        digest: checksum of everything that the run depends on, in hexadecimal.
    """

    name: str
    description: str
    plant: Plant
    cascade: Cascade
    trajectory: Trajectory
    force: Force
    excitation: Excitation | None
    recorder: Recorder
    ticks: int
    evaluations: tuple[Evaluation, ...]
    digest: str

    @property
    def sample_time(self) -> float:
        """Distance of the samples of the recording [s]."""
        return self.cascade.sample_time * self.recorder.divider

    @property
    def duration(self) -> float:
        """Length of the run [s]."""
        return self.ticks * self.cascade.sample_time


_NOT_SIMULATED = ("time", "motor_current", "motor_torque_share", "screw_speed")

SERIES: dict[str, str] = {
    **{name: unit for name, unit in CHANNEL_UNITS.items() if name not in _NOT_SIMULATED},
    "speed_command": "rad/s",
}
"""Series of a run and their SI units."""

MEANS = ("motor_torque", "cutting_force", *INJECTED)
"""Series that are means over the sample that follows; the others are readings."""


@dataclass(frozen=True)
class ScenarioResult:
    """A finished run.

    Attributes:
        scenario: that was run.
        recording: channels as recorded, noise and resolution included.
        time: of the samples [s], shape (n,).
        series: name of `SERIES` to exact samples, shape (n,).
    """

    scenario: Scenario
    recording: Recording
    time: FloatArray
    series: Mapping[str, FloatArray]


def recorded(scenario: Scenario, time: FloatArray, series: Mapping[str, FloatArray]) -> Recording:
    """The recording of exact series: white noise added, then rounded to the sensor's resolution where asked for.

    Args:
        scenario: says which channels, noise and seed; each channel has a random sequence of its own, known by its place
            in the alphabet; those injected, which are commands, stand behind the measured ones.
        time: [s], shape (n,).
        series: exact, shape (n,); late channels as they are recorded.

    Raises:
        InputError: a noise so large that numbers overflow.
    """
    recorder, channels = scenario.recorder, {}
    resolution = {sensor.channel: sensor.resolution for sensor in scenario.plant.sensors}
    for place, name in enumerate(sorted(SERIES, key=lambda name: (name in INJECTED, name))):
        if name not in recorder.channels:
            continue
        samples = series[name]
        if recorder.noise.get(name, 0.0) > 0:
            generator = np.random.default_rng([recorder.seed, place])
            with np.errstate(over="ignore"):
                samples = samples + recorder.noise[name] * generator.standard_normal(len(samples))
            if not np.isfinite(samples).all():
                raise InputError(f"the noise of {name} is too large", scenario.name, "check its unit")
        step = resolution.get(name, 0.0) if recorder.quantised else 0.0
        channels[name] = step * np.round(samples / step) if step > 0 else samples
    ordered = {name: channels[name] for name in recorder.channels}
    return Recording(scenario.name, time, ordered, scenario.sample_time)
