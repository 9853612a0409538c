"""Hours of an axis in production at 1 kHz, in closed form and written as it goes: a maker of files of any size.

The machine is that of `trend_machine`, whose drag falls as it warms up. Stretches of setting up (moves of any length
and speed), of production (one part program over and over, with a dwell in each) and long rests follow one another. A
move is a polynomial of fifth degree from rest to rest. No more than a block is in memory.

Friction holds the table until a flank of the nut is met: it lags as the play operator has it (M. Krasnosel'skii and
A. Pokrovskii, Systems with Hysteresis, 1989, section 2), and in between, or braked, nothing is transmitted against it.

    python -m tests.recovery.long_production long.csv --hours 7.7 --seed 5 --play 6
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np

from tests.recovery import trend_machine as machine
from tests.recovery.trend_machine import Array

STEP, BLOCK = 1e-3, 200_000
LOW, HIGH = 0.02, 0.48
SLOWEST, FASTEST, HARDEST = 2e-3, 0.25, 0.6
WARM, WARM_SHARE = 1.2 * 3600, 0.15
HEADER = "time [s],motor_torque [N m],motor_angle [rad],table_position [m]\n"
FORM = "%.3f,%.4f,%.6f,%.8f\n"

Move = tuple[int, float, float]
"""Rows, and position before and after [m]."""


def moves(rows: int, seed: int) -> list[Move]:
    """What the axis does, until so many rows are full."""
    random = np.random.default_rng(seed)
    found: list[Move] = []
    filled, at = 0, 0.25

    def go(targets: list[float], speeds: list[float]) -> None:
        nonlocal filled, at
        for target, speed in zip(targets, speeds, strict=True):
            way = abs(target - at)
            # of the polynomial: 15/8 of the mean speed, 10/sqrt(3) of way / time^2
            time = max(1.875 * way / speed, math.sqrt(5.774 * way / HARDEST), 0.05)
            found.append((round(time / STEP), at, target))
            at = target
            filled += found[-1][0]

    def rest(seconds: float) -> None:
        nonlocal filled
        found.append((round(seconds / STEP), at, at))
        filled += found[-1][0]

    def some(count: int, way: float) -> tuple[list[float], list[float]]:
        places = [at]
        for _ in range(count):
            near = places[-1] + way * random.standard_normal()
            places.append(float(np.clip(near if random.random() < 0.5 else random.uniform(LOW, HIGH), LOW, HIGH)))
        return places[1:], np.exp(random.uniform(math.log(SLOWEST), math.log(FASTEST), count)).tolist()

    while filled < rows:
        go(*some(30, 0.02))
        part = some(12, 0.05)
        for _ in range(int(random.integers(10, 60))):
            go(*part)
            rest(random.uniform(5.0, 15.0))
        rest(random.uniform(60.0, 1500.0))
    return found


def blocks(hours: float, seed: int, play: float) -> Iterator[Array]:
    """Rows of time [s], motor torque [N m], motor angle [rad], table position [m]: (up to BLOCK, 4) each."""
    rows = round(hours * 3600 / STEP)
    plan = moves(rows, seed)
    ends = np.concatenate([[0], np.cumsum([one[0] for one in plan])])
    random, radius = np.random.default_rng(seed + 1), machine.LEAD / (2 * math.pi)
    lags, begins = _lags(plan, play), np.array([one[1] for one in plan])
    cuts = [*range(0, rows, BLOCK), rows]
    for first, last in pairwise(cuts):
        row = np.arange(first, last)
        number = np.searchsorted(ends, row, side="right") - 1
        (x, v, a), (x_mid, v_mid, a_mid) = (_motion(plan, ends, row + late) for late in (0.0, 0.5))
        lag, force = _on_flank(x - begins[number], lags[number], play, _force(v, a), v)
        _, middle = _on_flank(x_mid - begins[number], lags[number], play, _force(v_mid, a_mid), v_mid)
        table = x + machine.lead_map(x) + lag - force / machine.STIFFNESS
        drag = machine.DRAG * (1 + WARM_SHARE * np.expm1(-row * STEP / WARM)) * (1 + machine.friction_map(x))
        torque = machine.INERTIA * a_mid / radius + drag * np.tanh(v_mid / machine.SMOOTH) + radius * middle
        yield np.column_stack([
            row * STEP, torque + 0.02 * random.standard_normal(len(row)), x / radius,
            table + 20e-9 * random.standard_normal(len(row)),
        ])  # fmt: skip


def write_production(path: Path, hours: float, seed: int, play: float) -> Path:
    """Write a recording as CSV, block by block."""
    with path.open("w", encoding="ascii") as file:
        file.write(HEADER)
        for block in blocks(hours, seed, play):
            file.write((FORM * len(block)) % tuple(block.ravel()))
    return path


def _motion(plan: list[Move], ends: Array, row: Array) -> tuple[Array, Array, Array]:
    number = np.searchsorted(ends, row, side="right") - 1
    count, begin, end = (np.array([one[column] for one in plan])[number] for column in range(3))
    share, time, way = (row - ends[number]) / count, count * STEP, end - begin
    x = begin + way * share**3 * (10 - 15 * share + 6 * share**2)
    v = way / time * 30 * share**2 * (1 - share) ** 2
    a = way / time**2 * 60 * share * (1 - share) * (1 - 2 * share)
    return x, v, a


def _lags(plan: list[Move], play: float) -> Array:
    """How far the table is ahead of the motor before each move [m]: half the play behind at first, as after +."""
    lags = [-0.5 * play]
    for _, begin, end in plan:
        lags.append(min(max(lags[-1] - (end - begin), -0.5 * play), 0.5 * play))
    return np.array(lags)


def _on_flank(moved: Array, lag: Array, play: float, force: Array, v: Array) -> tuple[Array, Array]:
    """How far the table is ahead of the motor in a move [m], and the force of the flank that pushes it [N]."""
    after = lag - moved
    if play == 0:
        return np.zeros_like(after), force
    pushed = np.where(v > 0, after <= -0.5 * play, after >= 0.5 * play) & (np.sign(force) == np.sign(v))
    return np.clip(after, -0.5 * play, 0.5 * play), np.where(pushed, force, 0.0)


def _force(v: Array, a: Array) -> Array:
    return machine.MASS * a + machine.COULOMB * np.tanh(v / machine.SMOOTH) + machine.VISCOUS * v


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Write hours of a recording in production.")
    parser.add_argument("path", type=Path)
    parser.add_argument("--hours", type=float, default=7.7)
    parser.add_argument("--seed", type=int, default=5)
    parser.add_argument("--play", type=float, default=6.0, help="backlash [µm]")
    given = parser.parse_args()
    written = write_production(given.path, given.hours, given.seed, 1e-6 * given.play)
    sys.stdout.write(f"{written}: {written.stat().st_size / 1e9:.3f} GB\n")
