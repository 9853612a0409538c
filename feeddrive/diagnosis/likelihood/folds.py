"""Blocks of time, and the folds to which they are dealt.

A motion that repeats would put one phase of itself into one fold if the blocks were dealt in turn. So they are dealt at
random, by a fixed seed, and kind of motion by kind of motion (rest, reversal, stroke, acceleration or excitation), so
that every fold sees a part of each.
Source: Roberts et al., Ecography 40 (2017) 913 (blocks, strata).
"""

from __future__ import annotations

import numpy as np

from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.typing import FloatArray, IntegerArray

FOLDS = 6
"""Folds to which the blocks are dealt; the number of a block modulo this is its fold."""

SEED = 6
"""Seed of the dealing; any number will do, and a recording is dealt alike every time."""

AT_REST = 1e-3
"""Share of the highest speed below which a block is at rest."""


def block_numbers(problem: Problem) -> IntegerArray:
    """Block of every row of the residual, counted over all recordings; channels share their blocks.

    Returns:
        Numbers of which the remainder by `FOLDS` is the fold, shape (m,).
    """
    numbers, first = [], 0
    for evidence in problem.evidence:
        rows = np.flatnonzero(evidence.thinned(evidence.fit_rows))
        dealt = dealt_blocks(evidence)
        numbers += [first + dealt[block_of_rows(evidence, rows)]] * len(evidence.channels)
        first += FOLDS * (int(dealt.max()) // FOLDS + 1)
    numbers.append(first + np.arange(len(problem.numbers)))  # each measured number is a block of its own
    return np.concatenate(numbers).astype(np.int64)


def blocks_in_time(problem: Problem) -> IntegerArray:
    """Block of every row of the residual, counted over all recordings as time goes on, shape (m,)."""
    numbers, first = [], 0
    for evidence in problem.evidence:
        blocks = block_of_rows(evidence, np.flatnonzero(evidence.thinned(evidence.fit_rows)))
        numbers += [first + blocks] * len(evidence.channels)
        first += int(blocks.max(initial=0)) + 1
    numbers.append(first + np.arange(len(problem.numbers)))
    return np.concatenate(numbers).astype(np.int64)


def block_of_rows(evidence: Evidence, rows: IntegerArray) -> IntegerArray:
    """Number of the block of time that each row lies in, shape of `rows`."""
    return (rows * evidence.recording.sample_time / evidence.block).astype(np.int64)


def dealt_blocks(evidence: Evidence) -> IntegerArray:
    """Number of each block of time by which it is counted, so that its remainder by `FOLDS` is its fold.

    All blocks of the recording are dealt, so that leaving samples out does not deal the others anew.
    """
    blocks = block_of_rows(evidence, np.arange(len(evidence.counted)))
    present = np.unique(blocks)  # blocks shorter than a row leave gaps
    kinds = kinds_of_motion(evidence.motion_speed, blocks)
    random = np.random.default_rng(SEED)
    order = np.concatenate([random.permutation(np.flatnonzero(kinds == kind)) for kind in np.unique(kinds)])
    numbers = np.zeros(int(present[-1]) + 1, dtype=np.int64)
    numbers[present[order]] = np.arange(len(kinds))
    return numbers


def kinds_of_motion(speed: FloatArray, blocks: IntegerArray) -> IntegerArray:
    """Kind of the motion in each block.

    Args:
        speed: of the motor or the screw, (n,).
        blocks: block of every sample, in order, (n,).

    Returns:
        Per block that has a sample 0 rest, 1 stroke, 2 acceleration or excitation (the half of the moving blocks in
        which the speed changes most), 3 reversal.
    """
    first = np.flatnonzero(np.concatenate([[True], np.diff(blocks) > 0]))
    slow = AT_REST * float(np.max(np.abs(speed), initial=0.0))
    highest, lowest = np.maximum.reduceat(speed, first), np.minimum.reduceat(speed, first)
    count = np.diff(np.concatenate([first, [len(speed)]]))
    change = np.add.reduceat(np.diff(speed, prepend=speed[:1]) ** 2, first) / count
    moving = np.maximum(highest, -lowest) > slow
    typical = float(np.median(change[moving])) if moving.any() else 0.0
    kinds = np.where(moving, np.where(change > typical, 2, 1), 0)
    return np.where((highest > slow) & (lowest < -slow), 3, kinds).astype(np.int64)
