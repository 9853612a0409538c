"""Sound recordings of machines of every kind, made in closed form: no flaw may be found in them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
import numpy.typing as npt
from scipy import signal

Array = npt.NDArray[np.float64]
FINEST = 4000.0
"""Rate at which the motion is computed at least [Hz]: a drive goes on between the rows of a slow recording."""


@dataclass(frozen=True)
class Sound:
    """Channels of a sound recording, (n,) each, and the time between rows [s]; `kind` says what it is like."""

    channels: dict[str, Array]
    sample_time: float
    kind: str


@cache
def sound_recording(seed: int) -> Sound:
    """Return a recording of a machine drawn at random.

    10 Hz to 20 kHz, encoders of 12 to 24 bits, with and without noise, torques and positions held by slower loops,
    coarse scales, long rests, chirps, stick-slip, saturation of the drive.
    """
    draw = np.random.default_rng(seed)
    rate = float(10.0 ** draw.uniform(1.0, math.log10(20e3)))
    rows = int(min(20_000, max(400, rate * draw.uniform(4.0, 30.0))))
    step = 1.0 / rate
    lead = float(10.0 ** draw.uniform(math.log10(2e-3), math.log10(40e-3)))
    ratio = lead / (2 * math.pi)
    fine = max(1, math.ceil(FINEST / rate))
    position = _motion(draw, rows * fine, step / fine)
    speed = np.gradient(position, step / fine)
    acceleration = np.gradient(speed, step / fine)
    inertia = float(10.0 ** draw.uniform(-4.0, -1.0)) / ratio
    friction = float(10.0 ** draw.uniform(-2.0, 1.0))
    torque = inertia * acceleration + friction * np.tanh(speed / 1e-3) + 0.3 * friction * speed / 0.1
    windup = float(10.0 ** draw.uniform(-7.0, -4.5)) * torque / np.max(np.abs(torque))
    position, torque, windup = (series[::fine] for series in (position, torque, windup))
    kinds = []
    if draw.random() < 0.3:  # the drive saturates, and says what it commands
        torque = np.clip(torque, -0.7 * np.max(np.abs(torque)), 0.7 * np.max(np.abs(torque)))
        kinds.append("saturated without noise")
    elif draw.random() < 0.7:
        torque = torque + float(10.0 ** draw.uniform(-3.5, -1.0)) * np.max(np.abs(torque)) * draw.standard_normal(rows)
        kinds.append("noise")
    every = int(draw.choice([1, 1, 1, 2, 3, 4, 5, 10]))
    torque = torque[np.arange(rows) // every * every]
    quantum = float(np.max(np.abs(torque))) * float(10.0 ** draw.uniform(-5.0, -1.3))
    torque = quantum * np.round(torque / quantum)
    bits = int(draw.integers(12, 25))
    angle = (position + windup) / ratio + draw.uniform(-100, 100)
    table = position + _stick_slip(draw, rows, rate)
    if draw.random() < 0.5:
        table = table + float(10.0 ** draw.uniform(-9.0, -6.0)) * draw.standard_normal(rows)
    pulse = 2 * math.pi / 2**bits
    scale = float(10.0 ** draw.uniform(-9.0, -5.3))
    slow = int(draw.choice([1, 1, 1, 1, 2, 3, 4, 8]))
    index = np.arange(rows) // slow * slow
    digits = int(draw.choice([7, 9, 12]))
    channels = {
        "motor_torque": torque,
        "motor_angle": np.round(pulse * np.round(angle / pulse), digits)[index],
        "table_position": np.round(scale * np.round(table / scale), digits + 2)[index],
    }
    kind = (
        f"{rate:.0f} Hz, {bits} bits, lead {1e3 * lead:.0f} mm, torque every {every}, positions every {slow}, {kinds}"
    )
    return Sound(channels, step, kind)


def _motion(draw: np.random.Generator, rows: int, step: float) -> Array:
    """Return a table position, (n,): strokes, rests and reversals that a servo follows, and a chirp now and then."""
    top = float(10.0 ** draw.uniform(-2.0, 0.3))
    acceleration = float(10.0 ** draw.uniform(-0.5, 1.3))
    pieces: list[Array] = [np.zeros(int(draw.integers(2, max(3, rows // 10))))]
    place, length = 0.0, len(pieces[0])
    while length < rows:
        if draw.random() < 0.3:
            piece = np.full(int(draw.integers(2, max(3, rows // 6))), place)
        else:
            speed = top * float(draw.choice([1.0, 0.5, 0.1, 0.003]))
            distance = speed * float(10.0 ** draw.uniform(-1.5, 0.5)) * float(draw.choice([-1.0, 1.0]))
            piece = place + np.sign(distance) * _stroke(abs(distance), speed, acceleration, step)
        pieces.append(piece)
        place, length = float(piece[-1]), length + len(piece)
    reference = np.concatenate(pieces)[:rows]
    servo = signal.butter(2, float(draw.uniform(8.0, 60.0)), fs=1.0 / step, output="sos")
    position = signal.sosfilt(servo, signal.sosfilt(servo, reference))
    if draw.random() < 0.5:
        position = position + _chirp(draw, rows, step, acceleration)
    return np.asarray(position, dtype=np.float64)


def _chirp(draw: np.random.Generator, rows: int, step: float, acceleration: float) -> Array:
    """Return a chirp to 450 Hz that fades in and out, its acceleration a tenth of that of the strokes, (n,)."""
    length = int(draw.integers(rows // 10, rows // 3))
    start = int(draw.integers(0, rows - length))
    time = np.arange(length) * step
    low, high = 5.0, min(450.0, 0.2 / step)
    phase = 2 * math.pi * (low * time + (high - low) * time**2 / (2 * time[-1]))
    frequency = low + (high - low) * time / time[-1]
    window = np.sin(math.pi * np.arange(length) / length) ** 2
    chirp = np.zeros(rows)
    chirp[start : start + length] = 0.1 * acceleration / (2 * math.pi * frequency) ** 2 * window * np.sin(phase)
    return chirp


def _stroke(distance: float, speed: float, acceleration: float, step: float) -> Array:
    """Return travel over time of a stroke: a trapezoid of speed."""
    speed = min(speed, math.sqrt(distance * acceleration))
    ramp = speed / acceleration
    total = distance / speed + ramp
    time = np.arange(0.0, total + 2 * step, step)
    travel = np.interp(time, [0.0, ramp, max(total - ramp, ramp + 1e-9), total], [0.0, 1.0, 1.0, 0.0]) * speed
    return np.asarray(np.cumsum(travel) * step, dtype=np.float64)


def _stick_slip(draw: np.random.Generator, rows: int, rate: float) -> Array:
    """Return a table that slips by some micrometres now and then, and rings; zero in most recordings."""
    if draw.random() > 0.2:
        return np.zeros(rows)
    frequency, time = float(draw.uniform(15.0, 120.0)), np.arange(rows) / rate
    slip = np.zeros(rows)
    for start in np.sort(draw.uniform(0.0, time[-1], 12)):
        after = np.maximum(time - start, 0.0)
        ring = 1.0 - np.exp(-30.0 * after) * np.cos(2 * math.pi * frequency * after)
        slip = slip + 3e-6 * ring * (time >= start)
    return slip - 3e-6 * 12 * time / time[-1]
