"""Programmes drawn at random, of the three kinds that people record, as set-points for a machine.

strokes: there and back at many speeds over parts of the stroke, with rests.
milling: short moves, arcs and rapids as a milling programme asks of one axis.
reversals: small to and fro at a few places, slow strokes between; with or without an injected torque at the end.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from tests.generator.machines import Machine, Random
from tests.generator.profile import chirp, smooth_step

Array = npt.NDArray[np.float64]

KINDS = ("strokes", "milling", "reversals")
REST, SMOOTHING = 0.6, 0.02
"""Rest before and after, and width of each of two averages over the set-point [s]."""

LONGEST_SWING = 2.0
"""Seconds to and fro at one place, but for one cycle that takes longer."""

SWING_SHARE = 0.3
"""Share of an excited programme in which torque is injected."""


@dataclass
class Path:
    """Set-point being written: pieces from rest to rest. position: where it stands [m]; seconds: how long it is."""

    machine: Machine
    position: float
    pieces: list[Array]
    seconds: float = 0.0

    def add(self, piece: Array) -> None:
        """Append a piece that begins at the position."""
        self.pieces.append(piece)
        self.seconds += len(piece) * self.machine.axis.sample_time
        self.position = float(piece[-1]) if len(piece) else self.position

    def rest(self, seconds: float) -> None:
        """Stand still."""
        self.add(np.full(round(seconds / self.machine.axis.sample_time), self.position))

    def move(self, to: float, speed: float) -> None:
        """Move to a place [m] with trapezoids of speed [m/s]."""
        axis = self.machine.axis
        low, high = axis.travel
        distance = min(max(to, low), high) - self.position
        if abs(distance) < 1e-6:
            return
        reached = min(speed, math.sqrt(abs(distance) * axis.acceleration))
        ramp = reached / axis.acceleration
        total = abs(distance) / reached + ramp
        time = (np.arange(math.ceil(total / axis.sample_time)) + 0.5) * axis.sample_time
        shape = np.clip(np.minimum(time, total - time) / ramp, 0.0, 1.0)
        self.add(self.position + distance * np.cumsum(shape) / np.sum(shape))

    def swing(self, reach: float, speed: float, cycles: int) -> None:
        """Go out by `reach` [m, signed] and back as a cosine, `cycles` times, at up to `speed` [m/s]."""
        axis = self.machine.axis
        low, high = axis.travel
        if not low <= self.position + reach <= high:
            reach = -reach
        speed = max(speed, math.pi * abs(reach) / LONGEST_SWING)
        rate = min(2.0 * speed / abs(reach), math.sqrt(2.0 * axis.acceleration / abs(reach)), 2.0 * math.pi * 6.0)
        cycles = max(1, min(cycles, round(LONGEST_SWING * rate / (2.0 * math.pi))))
        time = np.arange(round(cycles * 2.0 * math.pi / rate / axis.sample_time)) * axis.sample_time
        self.add(self.position + 0.5 * reach * (1.0 - np.cos(rate * time)))
        self.position = float(self.pieces[-1][0])


def programme(machine: Machine, kind: str, random: Random, seconds: float, excited: bool) -> tuple[Array, Array]:
    """Return set-point [m] and injected torque [N m] at the cycles of the loop, (n,) each, about `seconds` long."""
    axis = machine.axis
    low, high = axis.travel
    path = Path(machine, low + (high - low) * float(random.uniform(0.02, 0.5)), [])
    path.rest(REST)
    until = seconds - REST
    if excited:
        until -= SWING_SHARE * seconds
    writers = {"strokes": _strokes, "milling": _milling, "reversals": _reversals}
    writers[kind](path, random, until)
    count = path_length(path)
    if excited:
        _excited(path, random, SWING_SHARE * seconds)
    path.rest(REST)
    setpoint = _smoothed(np.concatenate(path.pieces), axis.sample_time)
    injected = np.zeros(len(setpoint))
    if excited:
        rows = path_length(path) - count - round(REST / axis.sample_time)
        time = np.arange(rows) * axis.sample_time
        top = min(450.0, 0.25 / axis.sample_time, 0.4 / machine.row_time)
        injected[count : count + rows] = axis.chirp_amplitude * chirp(time - 0.5, (5.0, top))
    rows = len(setpoint) // machine.every * machine.every
    return setpoint[:rows], injected[:rows]


def path_length(path: Path) -> int:
    """Return the number of cycles so far."""
    return sum(len(piece) for piece in path.pieces)


def _strokes(path: Path, random: Random, until: float) -> None:
    axis = path.machine.axis
    low, high = axis.travel
    while path.seconds < until:
        speed = axis.top_speed * math.exp(random.uniform(math.log(0.01), 0.0))
        reach = min(float(random.uniform(0.15, 1.0)) * (high - low), speed * float(random.uniform(0.4, 2.0)))
        start = path.position
        to = start + reach if start + reach <= high else start - reach
        path.move(to, speed)
        if random.random() < 0.4:
            path.rest(float(random.uniform(0.02, 0.25)))
        path.move(start + float(random.uniform(-0.2, 0.2)) * reach, speed * float(random.uniform(0.7, 1.0)))


def _milling(path: Path, random: Random, until: float) -> None:
    axis = path.machine.axis
    low, high = axis.travel
    stroke = high - low
    while path.seconds < until:
        feed = axis.top_speed * math.exp(random.uniform(math.log(0.004), math.log(0.25)))
        which = random.random()
        if which < 0.12:
            path.move(low + stroke * float(random.uniform(0.0, 1.0)), axis.top_speed * float(random.uniform(0.4, 1.0)))
        elif which < 0.45:
            reach = min(stroke * math.exp(random.uniform(math.log(2e-3), math.log(0.2))), 2.0 * feed)
            path.swing(float(random.choice([-1, 1])) * max(reach, 1e-4), feed, int(random.integers(1, 4)))
        else:
            for _ in range(int(random.integers(2, 6))):
                reach = min(stroke * math.exp(random.uniform(math.log(1e-3), math.log(0.15))), 0.7 * feed)
                path.move(path.position + float(random.choice([-1, 1])) * max(reach, 5e-5), feed)
        if random.random() < 0.2:
            path.rest(float(random.uniform(0.02, 0.1)))


def _reversals(path: Path, random: Random, until: float) -> None:
    axis = path.machine.axis
    low, high = axis.travel
    stroke = high - low
    while path.seconds < until:
        for _ in range(int(random.integers(2, 5))):
            reach = math.exp(random.uniform(math.log(2e-5), math.log(5e-3)))
            speed = axis.top_speed * math.exp(random.uniform(math.log(2e-3), math.log(0.1)))
            speed = max(speed, 0.6 * reach)
            if random.random() < 0.6:
                path.swing(reach, speed, int(random.integers(1, 4)))
            else:
                path.move(path.position + reach, speed)
                path.move(path.position - reach, speed)
        speed = axis.top_speed * math.exp(random.uniform(math.log(0.02), math.log(0.8)))
        reach = min(stroke * float(random.uniform(0.1, 0.9)), 1.5 * speed)
        path.move(path.position + (reach if path.position + reach <= high else -reach), speed)
        path.rest(float(random.uniform(0.02, 0.2)))


def _excited(path: Path, random: Random, seconds: float) -> None:
    """Swing slowly, so that friction has a direction while torque is injected; ends at rest."""
    axis = path.machine.axis
    low, high = axis.travel
    period = float(random.uniform(1.8, 3.2))
    reach = min(0.15 * axis.top_speed * period / (2.0 * math.pi), 0.2 * (high - low))
    middle = min(max(path.position, low + reach), high - reach)
    path.move(middle, 0.3 * axis.top_speed)
    time = np.arange(round(seconds / axis.sample_time)) * axis.sample_time
    blend = smooth_step(time / 0.5) * smooth_step((seconds - time) / 0.5)
    path.add(middle + blend * reach * np.sin(2.0 * math.pi * time / period))


def _smoothed(setpoint: Array, cycle: float) -> Array:
    width = max(1, round(SMOOTHING / cycle))
    window = np.ones(width) / width
    for _ in range(2):
        padded = np.concatenate([np.full(width - 1, setpoint[0]), setpoint])
        setpoint = np.convolve(padded, window, mode="valid")
    return setpoint
