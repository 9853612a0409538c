"""Made-up diagnoses for the tests of the report: sines and noise, no plant and no search behind them."""

from __future__ import annotations

import numpy as np
from scipy.signal import butter, sosfiltfilt

from feeddrive.diagnosis.judging.result import (
    ChannelResult,
    ChannelSeries,
    Dependence,
    Diagnosis,
    EffectResult,
    FileStamp,
    JudgedRecording,
    ParameterResult,
    RefusedEffect,
    SimulationResult,
    Trial,
    Unexplained,
    error_figures,
)
from feeddrive.typing import FloatArray

LEAD = 0.020
TORQUE_NOISE = 0.012
POSITION_NOISE = 0.05e-6


def recording(samples: int, seed: int, name: str, found: bool = True) -> JudgedRecording:
    """A table moved to and fro over 0.4 m at 1 kHz, with backlash, a torque ripple of order 7 and sensor noise.

    One second in the middle is left out. Without `found` both predictions miss the noise alone.
    """
    noise = np.random.default_rng(seed)
    time = np.arange(samples) * 1e-3
    position = 0.2 + 0.2 * np.sin(2.0 * np.pi * time / 9.7) * np.sin(2.0 * np.pi * time / 31.0)
    velocity = np.gradient(position, time)
    angle = position * 2.0 * np.pi / LEAD
    missing_torque = 0.12 * np.sin(7.0 * angle) + 0.05 * np.tanh(velocity / 1e-3)
    missing_position = -3.75e-6 * np.tanh(velocity / 2e-4)
    channels = (
        _series("motor_torque", "N m", 1.2 * np.tanh(velocity / 2e-3) + 3.0 * np.gradient(velocity, time),
                missing_torque * found, TORQUE_NOISE, noise),
        _series("table_position", "m", position, missing_position * found, POSITION_NOISE, noise),
    )  # fmt: skip
    variables = {"table_velocity": velocity, "table_position": position, "motor_angle": angle}
    return JudgedRecording(name, time, channels, variables)


def _series(
    name: str, unit: str, known: FloatArray, missing: FloatArray, rms: float, noise: np.random.Generator
) -> ChannelSeries:
    """Measured is known + missing + noise; before predicts the known part, after the missing part as well."""
    low_pass = butter(4, 150.0, fs=1000.0, output="sos")
    white = sosfiltfilt(low_pass, noise.normal(0.0, 1.0, known.size))
    measured = known + missing + rms * white / np.std(white)
    after = known + 0.99 * missing
    middle = slice(known.size // 2, known.size // 2 + 1000)
    for series in (measured, known, after):
        series[middle] = np.nan
    return ChannelSeries(name, unit, measured, known, after)


def channel_results(recordings: tuple[JudgedRecording, ...]) -> tuple[ChannelResult, ...]:
    """Error figures of the first recording's channels."""
    noise = {"motor_torque": TORQUE_NOISE, "table_position": POSITION_NOISE}
    reference = {"motor_torque": 1.3, "table_position": 12e-6}
    return tuple(
        ChannelResult(
            one.name, one.unit, (0.0, 150.0), noise.get(one.name, 0.0),
            error_figures(one.measured - one.before, reference.get(one.name, 1.0)),
            error_figures(one.measured - one.after, reference.get(one.name, 1.0)),
        )
        for one in recordings[0].channels
    )  # fmt: skip


def effects() -> tuple[EffectResult, ...]:
    """Four effects: plain, several parameters, a word as value, a tabulated curve."""
    return (
        EffectResult(
            "backlash", {"width": ParameterResult(7.52e-6, "m", (7.40e-6, 7.68e-6))}, {"table_position": 0.993}, True,
            "Steps of 7.5 µm in the table position at every one of 24 reversals, the same over the whole stroke.",
            "Free play between nut and screw: preload is gone.",
        ),
        EffectResult(
            "torque_ripple",
            {"amplitude": ParameterResult(0.1203, "N m", (0.1192, 0.1214)), "order": ParameterResult(7.0, "1"),
             "phase": ParameterResult(0.31, "rad", (0.29, 0.33))},
            {"motor_torque": 0.842, "table_position": 0.0004}, True,
            "A line at 7.00 per revolution, ten times its surroundings.", "Cogging of seven pole pairs.",
        ),
        EffectResult(
            "friction_deviation",
            {"port": ParameterResult("table", "1"), "coulomb_factor": ParameterResult(1.21, "1", (1.17, 1.25))},
            {"motor_torque": 0.12, "table_position": 0.01}, False, "A step in torque at every reversal.",
        ),
        EffectResult(
            "friction_vs_position",
            {"position": ParameterResult([0.0, 0.1, 0.2, 0.3, 0.4], "m"),
             "delta_force": ParameterResult([0.0, 12.0, 41.0, 14.0, 1.0], "N",
                                            [(-2.0, 2.0), (9.0, 15.0), (38.0, 44.0), (11.0, 17.0), (-2.0, 4.0)]),
             "peak": ParameterResult(41.3, "N", (38.1, 44.5)), "centre": ParameterResult(0.2, "m", (0.19, 0.21)),
             "half_width": ParameterResult(0.071, "m", (0.064, 0.078))},
            {"motor_torque": 0.031}, True, "A hump in the middle of the stroke, both ways.",
        ),
    )  # fmt: skip


def trials() -> tuple[Trial, ...]:
    """Three rounds; in the last nothing is taken."""
    rows = (
        (1, "backlash", 0.931, 0.004, True), (1, "preload_loss", 0.88, 0.006, False),
        (1, "stribeck", 0.02, 0.01, False),
        (1, "payload", 0.001, 0.002, False), (2, "torque_ripple", 0.71, 0.01, True),
        (2, "ball_pass_ripple", 0.052, 0.012, False), (2, "stribeck", 0.011, 0.004, False),
        (3, "stribeck", 0.0011, 0.0009, False), (3, "payload", 0.0002, 0.0004, False),
        (3, "presliding", -0.0004, 0.0006, False),
    )  # fmt: skip
    return tuple(Trial(*row) for row in rows)


def diagnosis(samples: int = 12_000, recordings: int = 1) -> Diagnosis:
    """A diagnosis that found four effects and has something to say in every section."""
    judged = tuple(recording(samples, seed, f"stroke_{seed}.csv") for seed in range(1, recordings + 1))
    return Diagnosis(
        plant="axis_x",
        fit=(FileStamp("sweep.csv", "ab" * 32),),
        validate=tuple(FileStamp(one.name, "cd" * 32) for one in judged),
        channels=channel_results(judged),
        effects=effects(),
        refused=(
            RefusedEffect("stribeck", "gain 0.11 % ± 0.09 %, less than the 0.5 % that an effect must bring"),
            RefusedEffect("preload_loss", "explains the reversals 40 times worse than backlash"),
        ),
        ambiguous=(("payload", "inertia_deviation"),),
        rehomed=("torque_ripple",),
        unexplained={"motor_torque": Unexplained(0.004, (Dependence("motor_angle", 0.31, "1 rev"),))},
        trials=trials(),
        recordings=judged,
        simulation=SimulationResult("table_position", 0.041, 0.006),
        notes=("stroke_1.csv: 1.0 s left out, free play is not predictable there",),
    )


def nothing_missing(samples: int = 12_000) -> Diagnosis:
    """A diagnosis of a plant that was declared completely."""
    judged = (recording(samples, 5, "stroke.csv", found=False),)
    stamps = (FileStamp("stroke.csv", "ef" * 32),)
    return Diagnosis(
        plant="axis_x", fit=stamps, validate=(), channels=channel_results(judged), effects=(), refused=(),
        ambiguous=(), rehomed=(), unexplained={}, trials=(), recordings=judged,
    )  # fmt: skip
