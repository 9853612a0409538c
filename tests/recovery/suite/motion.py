"""Recordings of motion and torque with planted effects, as the package reads them."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import numpy as np

from feeddrive.recording import Recording
from tests.generator.axis import AXES
from tests.generator.effects import Effect, PlantedEffects
from tests.generator.pair import Channels, profiles, recording_pair, true_axis
from tests.generator.recording import COLUMNS, QUICK_STEP, simulate

SECONDS = {"bench": (12.0, 7.6), "light": (6.8, 6.0)}
"""Lengths of the recordings for fitting and for judging [s]."""

SLOW = {"thermal_growth": 10.0, "viscous_warmup": 10.0}
"""Effects that settle with time, and the shortest recording for fitting that is to show them [s]."""


def seconds_for(axis: str, effects: tuple[Effect, ...]) -> tuple[float, float]:
    """Lengths of the recordings of these effects [s]; sizes depend on the second alone."""
    fitted, judged = SECONDS[axis]
    return max(fitted, *(SLOW.get(effect.name, 0.0) for effect in effects), 0.0), judged


def motion_recordings(
    axis: str,
    effects: tuple[Effect, ...],
    noise: float,
    seeds: tuple[int, int],
    seconds: tuple[float, float],
    off: Mapping[str, float],
) -> tuple[Recording, Recording]:
    """The recordings to fit and to judge."""
    fitted, judged = recording_pair(AXES[axis], effects, seeds, seconds, noise, off)
    return as_recording(fitted, "fit"), as_recording(judged, "judge")


def twins_without_effects(
    axis: str, effects: tuple[Effect, ...], noise: float, seeds: tuple[int, int], seconds: tuple[float, float]
) -> tuple[Recording, Recording]:
    """The same motion and noise, as `effects` would have them, with nothing planted."""
    true = true_axis(AXES[axis], PlantedEffects(effects), {}, noise)
    asked = profiles(true, PlantedEffects(effects), seconds)
    made = [simulate(true, PlantedEffects(), p, s, QUICK_STEP) for p, s in zip(asked, seeds, strict=True)]
    return as_recording(made[0], "fit"), as_recording(made[1], "judge")


def quiet_validation(axis: str, effects: tuple[Effect, ...]) -> Recording:
    """The recording to judge, from sensors without noise and with steps that do not show."""
    declared = AXES[axis]
    fine = dataclasses.replace(declared.sensors, torque_noise=0.0, scale_noise=0.0, scale_step=1e-13, encoder_bits=34)
    true = true_axis(dataclasses.replace(declared, sensors=fine), PlantedEffects(effects))
    profile = profiles(true, PlantedEffects(effects), SECONDS[axis])[1]
    channels = simulate(true, PlantedEffects(effects), profile, 0, QUICK_STEP)
    return _recording(channels, "quiet")


def as_recording(channels: Channels, name: str) -> Recording:
    """The recording, its numbers rounded as its file would round them."""
    decimals = {key: int(form[2:-1]) for key, (_, form) in COLUMNS.items() if key != "time"}
    rounded = {key: np.round(values, decimals.get(key, 9)) for key, values in channels.items()}
    return _recording(rounded, name)


def _recording(channels: Channels, name: str) -> Recording:
    time = channels["time"]
    rest = {key: values for key, values in channels.items() if key != "time"}
    return Recording(name, time, rest, float(time[1] - time[0]))
