"""A pair of recordings made on the fly."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from tests.generator.axis import AxisParameters
from tests.generator.effects import Backlash, DriveDelay, Effect, PlantedEffects
from tests.generator.profile import Profile, train_profile, validate_profile
from tests.generator.recording import QUICK_STEP, simulate

Array = npt.NDArray[np.float64]
Channels = dict[str, Array]


def profiles(axis: AxisParameters, effects: PlantedEffects, seconds: tuple[float, float]) -> tuple[Profile, Profile]:
    """Return the profiles for fitting and for judging; free play is judged without the chirp, being chaotic."""
    validate = validate_profile(axis, seconds[1])
    chaotic = any(effect.name == Backlash.name for effect in effects.effects)
    return train_profile(axis, seconds[0]), validate.without_chirp() if chaotic else validate


def true_axis(
    axis: AxisParameters, effects: PlantedEffects, off: Mapping[str, float] | None = None, noise_factor: float = 1.0
) -> AxisParameters:
    """Return the axis that is simulated: numbers multiplied by `off`, noise by noise_factor, soft where delayed."""
    control = axis.controller
    if any(effect.name == DriveDelay.name for effect in effects.effects):
        control = dataclasses.replace(control, speed_gain=control.soft_speed_gain)
    return dataclasses.replace(axis.off_by(off or {}), controller=control, sensors=axis.sensors.noisier(noise_factor))


def recording_pair(
    axis: AxisParameters,
    effects: Sequence[Effect],
    seeds: tuple[int, int],
    seconds: tuple[float, float],
    noise_factor: float = 1.0,
    off: Mapping[str, float] | None = None,
    longest_step: float = QUICK_STEP,
) -> tuple[Channels, Channels]:
    """Return the channels (see `simulate`) for fitting and for judging.

    Args:
        axis: the declared axis; another rate by `dataclasses.replace(axis, sample_time=...)`.
        effects: what the true axis has beside, none or several, each name once.
        seeds: of the noise in training and validation.
        seconds: their lengths [s], 6 s at least.
        noise_factor: noise over that of the declared sensors.
        off: name of a declared number -> the true one over the declared one ("the declared plant is wrong").
        longest_step: of the integrator [s].
    """
    planted = PlantedEffects(tuple(effects))
    true = true_axis(axis, planted, off, noise_factor)
    train, validate = (
        simulate(true, planted, profile, seed, longest_step)
        for profile, seed in zip(profiles(axis, planted, seconds), seeds, strict=True)
    )
    return train, validate
