"""A scenario: which plant moves how under which controller, and what is written down of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import Cascade
from feeddrive.simulate.setpoints.cutting_force import Force
from feeddrive.simulate.setpoints.setpoint_motion import Trajectory
from feeddrive.simulate.setpoints.waveforms import Waveform


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
