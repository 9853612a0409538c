"""Closed-loop simulation error, where the controller is declared: what the fitted plant does on its own."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from feeddrive.diagnose.evidence import AxisEvidence
from feeddrive.diagnose.judge import Judged
from feeddrive.diagnose.result import SimulationResult
from feeddrive.effects.channel_delay import lateness
from feeddrive.plant.plant import Plant
from feeddrive.simulate.closed_loop import simulate_closed_loop
from feeddrive.simulate.lateness import late_mean
from feeddrive.typing import FloatArray


def simulation_error(before: Plant, after: Plant, judged: Sequence[Judged]) -> SimulationResult | None:
    """Relative error of the simulated motor torque, unfiltered, over the judged samples; None without a controller."""
    usable = [j for j in judged if "setpoint" in j.evidence.recording]
    if before.controller is None or not usable:
        return None
    errors = [_relative(plant, usable) for plant in (before, after)]
    return SimulationResult("motor_torque", *errors)


def _relative(plant: Plant, judged: Sequence[Judged]) -> float:
    missed, measured = 0.0, 0.0
    for j in judged:
        recording, rows = j.evidence.recording, j.evidence.judged_rows
        time: FloatArray = np.arange(len(recording), dtype=np.float64) * recording.sample_time
        position, speed = _start(j)
        run = simulate_closed_loop(plant, time, recording["setpoint"], position, speed)
        told = late_mean(run.torque, recording.sample_time, lateness(plant.effects, "motor_torque"))
        error: FloatArray = (recording["motor_torque"] - told)[rows]
        missed += float(error @ error)
        measured += float(np.sum(recording["motor_torque"][rows] ** 2))
    return float(np.sqrt(missed / measured))


def _start(j: Judged) -> tuple[float, float]:
    """Table position [m] and velocity [m/s] that the recording starts from."""
    assert isinstance(j.before, Plant) and isinstance(j.evidence, AxisEvidence)
    r = j.before.chain.motor_radius
    return r * float(j.evidence.motion.angle[0]), r * float(j.evidence.motion.speed[0])
