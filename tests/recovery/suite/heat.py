"""Warm-up recordings with planted thermal effects, and examples of every thermal effect."""

from __future__ import annotations

import math
import tempfile
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Self

import numpy as np

from feeddrive.recording import Recording, read_recording
from tests.generator.thermal import (
    NOISE_KELVIN,
    NOISE_METRE,
    RESOLUTION_KELVIN,
    RESOLUTION_METRE,
    STEP,
    TRAIN,
    VALIDATE,
    Rig,
    simulate,
    write_csv,
)
from tests.generator.thermal_effects import Planted, ThermalTruth

Schedule = tuple[tuple[float, int], ...]
Series = dict[str, np.ndarray]

RUNS: dict[str, tuple[Schedule, Schedule]] = {
    "warm-up": (TRAIN, VALIDATE),
    "short warm-up": (((750, 90), (0, 50), (300, 40)), ((500, 80), (0, 40))),
}
"""Name to the schedules for fitting and for judging. The generator has one rig: two programmes stand for two axes."""

FAST = 750 * math.pi / 30


@dataclass(frozen=True)
class HeatEffect:
    """A thermal effect with its values (SI), as those of motion have them.

    size_keys: the parameters that make it larger; neutral: their value where it is absent.
    """

    name: str
    values: tuple[tuple[str, float | str], ...]
    size_keys: tuple[str, ...]
    neutral: float = 0.0

    def scaled(self, factor: float) -> Self:
        """The effect `factor` times as large; ValueError where a factor on a conductance would not be positive."""
        made = {
            key: self.neutral + factor * (float(value) - self.neutral) if key in self.size_keys else value
            for key, value in self.values
        }
        if self.neutral == 1.0 and min(float(made[key]) for key in self.size_keys) < 0.05:
            raise ValueError(f"{self.name}: the factor would be nearly 0")
        return replace(self, values=tuple(made.items()))


def _effect(name: str, size_keys: tuple[str, ...], neutral: float = 0.0, **values: float | str) -> HeatEffect:
    return HeatEffect(name, tuple(values.items()), size_keys, neutral)


def heat_examples(run: str) -> tuple[HeatEffect, ...]:
    """One or two examples of every thermal effect; times follow the length of the run."""
    seconds = STEP * sum(count for _, count in RUNS[run][0])
    return (
        _effect("motor_heat", ("power",), power=1.5, at_speed=FAST, share_at_rest=0.3),
        _effect("bearing_heat", ("factor",), factor=1.0, rear_share=1.0),
        _effect("bearing_heat", ("factor",), factor=1.0, rear_share=0.5),
        _effect("ambient_drift", ("amplitude",), amplitude=0.8, curve="sine", period=round(0.7 * seconds)),
        _effect("ambient_drift", ("amplitude",), amplitude=-0.8, curve="sine", period=round(2.0 * seconds)),
        _effect("preload_growth", ("coefficient",), coefficient=0.015),
        _effect("preload_growth", ("coefficient",), coefficient=-0.01),
        _effect("viscosity_temperature", ("coefficient",), coefficient=0.02),
        _effect("cooling", ("conductance",), conductance=0.05, start=0.0),
        _effect("cooling", ("conductance",), conductance=0.05, start=round(0.2 * seconds)),
        _effect("convection_deviation", ("factor",), 1.0, where="screw", factor=1.2),
        _effect("convection_deviation", ("factor",), 1.0, where="nut", factor=0.8),
        _effect("contact_conductance_deviation", ("factor",), 1.0, factor=0.6),
        _effect("contact_conductance_deviation", ("factor",), 1.0, factor=1.6),
        _effect("heat_sink", ("conductance", "capacity"), conductance=0.1, capacity=400.0),
        _effect("structure_growth", ("growth", "slope"), growth=1.5e-6, slope=0.0, time_constant=0.25 * seconds),
        _effect("structure_growth", ("growth", "slope"), growth=-1e-6, slope=1.2e-5, time_constant=0.4 * seconds),
        _effect("sensor_lag", ("time_constant",), channel="nut_temperature", time_constant=60.0),
        _effect("sensor_lag", ("time_constant",), channel="front_bearing_temperature", time_constant=90.0),
    )


def exact(schedule: Schedule, effects: tuple[HeatEffect, ...]) -> Series:
    """Channels without noise."""
    planted: Planted = {effect.name: dict(effect.values) for effect in effects}
    return simulate(schedule, ThermalTruth(planted), _rig()) if planted else _nothing_planted(schedule)


def heat_recordings(
    run: str, effects: tuple[HeatEffect, ...], noise: float, seeds: tuple[int, int]
) -> tuple[Recording, Recording]:
    """The recordings to fit and to judge, read back from files."""
    with tempfile.TemporaryDirectory() as folder:
        made = []
        for part, schedule, seed in zip(("fit", "judge"), RUNS[run], seeds, strict=True):
            path = Path(folder) / f"{part}.csv"
            write_csv(_measured(exact(schedule, effects), noise, seed), path)
            made.append(read_recording(path))
    return made[0], made[1]


def noise_of(channel: str) -> float:
    """Noise of a channel's sensor, rounding included [K or m]."""
    noise, step = NOISES["growth" if channel.startswith("table_growth") else "temperature"]
    return math.sqrt(noise**2 + step**2 / 12)


NOISES = {"growth": (NOISE_METRE, RESOLUTION_METRE), "temperature": (NOISE_KELVIN, RESOLUTION_KELVIN)}


def _measured(channels: Series, factor: float, seed: int) -> Series:
    """Channels with `factor` times the sensors' noise, and their resolution."""
    random, result = np.random.default_rng(seed), {}
    for name, series in channels.items():
        if name.startswith("table_growth") or name in ("nut_temperature", "front_bearing_temperature"):
            noise, step = NOISES["growth" if name.startswith("table_growth") else "temperature"]
            series = step * np.round((series + factor * noise * random.standard_normal(len(series))) / step)
        result[name] = series
    return result


@cache
def _rig() -> Rig:
    return Rig()


@cache
def _nothing_planted(schedule: Schedule) -> Series:
    return simulate(schedule, ThermalTruth(), _rig())
