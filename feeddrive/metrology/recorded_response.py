"""Frequency response from a recording, laid beside the linear one.

    H1 = S_uy / S_uu,   G(j w) = H1(w) / W(w),   W = sinc(w T / 2) exp(-j w T / 2)   for a torque held over the sample

| symbol | meaning | unit |
|---|---|---|
| u, y | torque or force, and what answers | SI |
| T | sample time | s |
| W | response of the hold, which is in H1 and not in G | 1 |

An answer that was not recorded is the difference of its integral (speed from angle), a mean over the sample, whose own
sinc(w T / 2) exp(+j w T / 2) is taken out likewise. Valid up to a quarter of the sample rate; beyond, what the sampling
folds back shows (2 dB at 0.4). Recordings under control are biased by noise that runs round the loop; the coherence
says where.
"""

from __future__ import annotations

import math

import numpy as np

from feeddrive.errors import InputError
from feeddrive.metrology.response import Response, measured_response
from feeddrive.recording.recording import Recording
from feeddrive.typing import FloatArray

_INTEGRALS = {"motor_speed": "motor_angle", "table_velocity": "table_position"}
_HELD = ("motor_torque", "cutting_force")
_AVERAGES = 16
_SHORTEST, _LONGEST = 64, 2.0  # samples, s
_HIGHEST = 0.25


def recorded_response(recording: Recording, given: str, output: str) -> Response:
    """The response of a recording from one channel to another, as the linear plant has it.

    Args:
        recording: during which the input was excited, the axis moving.
        given: `motor_torque` or `cutting_force`, held over the samples.
        output: any recorded channel, or a speed whose angle is recorded.

    Raises:
        InputError: a channel that is not recorded, or a recording too short for averages.
    """
    if given not in _HELD:
        raise InputError(f"{given} is no input of the mechanics", recording.name, f"choose {' or '.join(_HELD)}")
    force, tick = recording[given], recording.sample_time
    if not np.ptp(force) > 0:
        raise InputError(f"{given} does not change", recording.name, "record while it is excited")
    answer, mean = _answer(recording, output)
    segment = min(int(2 * len(answer) / (_AVERAGES + 1)), int(_LONGEST / tick))
    if segment < _SHORTEST:
        what = f"{len(answer)} samples are too few for {_AVERAGES} averages"
        raise InputError(what, recording.name, f"record {_SHORTEST * (_AVERAGES + 1) // 2} samples or more")
    found = measured_response(force[: len(answer)], answer, tick, segment).between(0.0, _HIGHEST / tick)
    half = math.pi * found.frequency * tick
    hold = np.sinc(half / math.pi) * np.exp(-1j * half)
    own = np.sinc(half / math.pi) * np.exp(1j * half) if mean else np.ones_like(hold)
    return Response(found.frequency, found.response / (hold * own), found.coherence, found.averages)


def _answer(recording: Recording, output: str) -> tuple[FloatArray, bool]:
    """Samples of the output, and whether each is the mean over its sample."""
    if output in recording:
        return recording[output], False
    integral = _INTEGRALS.get(output, "")
    if integral not in recording:
        return recording[output], False  # which tells what the recording has
    return np.diff(recording[integral]) / recording.sample_time, True
