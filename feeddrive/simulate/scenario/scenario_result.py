"""What a scenario gives: the recording as sensors would write it, and the exact series that figures are taken from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.channels import CHANNEL_UNITS, INJECTED
from feeddrive.recording.recording import Recording
from feeddrive.simulate.scenario.scenario import Scenario
from feeddrive.typing import FloatArray

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
