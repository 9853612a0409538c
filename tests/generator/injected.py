"""Recordings of an axis into whose loop a test signal is injected, with the injected signal as a channel of its own."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from tests.generator.axis import AxisParameters
from tests.generator.constants import declared_constants
from tests.generator.effects import Effect, PlantedEffects
from tests.generator.lateness import as_recorded, lateness
from tests.generator.loop import closed_loop
from tests.generator.profile import Profile, chirp, setpoint_and_chirp
from tests.generator.recording import QUICK_STEP, measured, sampling_of, state_at_rest

Array = npt.NDArray[np.float64]

CHANNELS = ("injected_torque", "injected_speed")


def sweep(time: Array, hertz: tuple[float, float]) -> Array:
    """Return a logarithmic sweep of amplitude 1 over `time` [s], faded at both ends."""
    return chirp(time - time[0], hertz)


def multisine(time: Array, hertz: tuple[float, float], seed: int) -> Array:
    """Return sines at multiples of 2 Hz within a band, of drawn phases, the sum's peak 1."""
    lines = np.arange(math.ceil(hertz[0] / 2.0), math.floor(hertz[1] / 2.0) + 1) * 2.0
    phases = np.random.default_rng(seed).uniform(0.0, 2.0 * math.pi, lines.size)
    sums = np.sum([np.cos(2.0 * math.pi * f * time + p) for f, p in zip(lines, phases, strict=True)], axis=0)
    return np.asarray(sums / np.max(np.abs(sums)))


def binary(time: Array, held: int, seed: int) -> Array:
    """Return a drawn sequence of -1 and 1, each held for so many samples."""
    bits = np.random.default_rng(seed).integers(0, 2, time.size // held + 1)
    return np.repeat(2.0 * bits - 1.0, held)[: time.size]


def injected_recording(
    axis: AxisParameters,
    effects: Sequence[Effect],
    profile: Profile,
    signal: tuple[str, Array],
    seed: int,
    longest_step: float = QUICK_STEP,
) -> dict[str, Array]:
    """Return the recorded channels, (n,) each, SI, the injected one among them.

    Args:
        axis: the true axis; its controller tells the gains.
        effects: what it has beside its declared numbers.
        profile: of the set-point; its own chirp is left out.
        signal: a name of `CHANNELS`, and its samples, cut or filled up with zeros to the length of the set-point.
        seed: of the sensors' noise.
        longest_step: of the integrator [s].
    """
    setpoint, _ = setpoint_and_chirp(profile.without_chirp(), axis.sample_time)
    channel, values = signal
    injected = np.zeros_like(setpoint)
    injected[: values.size] = values[: setpoint.size]
    nothing = np.zeros_like(setpoint)
    torque_in, speed_in = (injected if channel == name else nothing for name in CHANNELS)
    constants = PlantedEffects(tuple(effects)).planted(declared_constants(axis))
    sampling = sampling_of(axis, constants, longest_step)
    start = state_at_rest(setpoint[0], constants)
    torque, states, read = closed_loop(setpoint, torque_in, start, sampling, constants, speed_in)
    if not np.all(np.isfinite(states)):
        raise FloatingPointError("the simulated axis diverged")
    time = np.asarray(np.arange(setpoint.size) * axis.sample_time, dtype=np.float64)
    exact = as_recorded(torque, states, read, lateness(axis.sample_time, constants).rows, constants)
    return {"time": time, "setpoint": setpoint, channel: injected} | measured(*exact, axis.sensors, seed)
