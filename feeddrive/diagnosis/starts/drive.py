"""Starts of what lies in drive and recorder: delays, droop of the torque constant; and of inertias."""

from __future__ import annotations

import numpy as np

from feeddrive.diagnosis.finding.scene import Scene
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.effects.base import Effect
from feeddrive.effects.chain.inertia_deviation import InertiaDeviation
from feeddrive.effects.source.torque_constant_droop import TorqueConstantDroop
from feeddrive.effects.timing.channel_delay import ChannelDelay
from feeddrive.effects.timing.drive_delay import DriveDelay
from feeddrive.typing import FloatArray

LONGEST = 0.1
"""Delays that are looked for [s]; a channel that is later than that belongs to another motion."""

CONTINUOUS = 0.3
"""Torque at which a droop is stated, over the declared limit: about what a servo motor gives continuously."""

TORQUE, ANGLE, TABLE = "motor_torque", "motor_angle", "table_position"


def drive_delay(scene: Scene) -> list[list[Effect]]:
    """No delay, and that at which the residual of the torque is least."""
    found = _least_error(scene, {TORQUE: -1})
    return [[DriveDelay.of(delay=delay) for delay in sorted({0.0, found})]]


def channel_delay(scene: Scene) -> list[list[Effect]]:
    """For every channel none, and the delay at which the residual is least.

    A late motor angle makes the others early. Without a table position it is a late drive, and left to that name.
    """
    channels = {name for evidence in scene.problem.evidence for name in evidence.channels}
    shifts = {TORQUE: {TORQUE: 1}, ANGLE: {TORQUE: -1, TABLE: -1}, TABLE: {TABLE: 1}}
    if TABLE not in channels:
        shifts = {TORQUE: shifts[TORQUE]}
    if TORQUE not in channels:
        del shifts[TORQUE]
    taken = {effect.place for effect in scene.found if effect.name == ChannelDelay.name}
    forms: list[list[Effect]] = []
    for place, moved in shifts.items():
        if place not in taken:
            delays = sorted({0.0, _least_error(scene, moved)})
            forms.append([ChannelDelay.of(place=place, delay=delay) for delay in delays])
    return forms


def inertia(scene: Scene) -> list[list[Effect]]:
    """None, at every shaft that has no further inertia yet."""
    taken = {effect.place for effect in scene.found if effect.name == InertiaDeviation.name}
    return [[InertiaDeviation.of(place=where, inertia=0.0)] for where in InertiaDeviation.places if where not in taken]


def droop(scene: Scene) -> list[list[Effect]]:
    """None, stated at the same torque for every recording of a machine; at the largest recorded one without a limit."""
    at = CONTINUOUS * scene.plant.torque_limit
    if not np.isfinite(at):
        at = max(float(np.abs(e.measured[TORQUE][e.fit_rows]).max()) for e in scene.problem.evidence)
    return [[TorqueConstantDroop.of(share=0.0, at_torque=float(f"{at:.1e}"))]] if at > 0 else []


def _least_error(scene: Scene, moved: dict[str, int]) -> float:
    """Delay in whole samples [s] at which the residual is least; `moved`: channel to +1 where it makes its rows late.

    Only the longest recording is looked at: shifts of what was predicted there, nothing is simulated.
    """
    evidence, residual = scene.problem.evidence[scene.longest], scene.residuals[scene.longest]
    step = evidence.recording.sample_time
    errors = np.zeros(int(LONGEST / step) + 1)
    for channel, way in moved.items():
        if channel in evidence.channels:
            errors += _shifted_errors(evidence, channel, residual[channel], way, len(errors))
    return float(np.argmin(errors)) * step


def _shifted_errors(evidence: Evidence, channel: str, residual: FloatArray, way: int, count: int) -> FloatArray:
    """Weighted squared error of a channel for shifts of 0, 1, ... samples, shape (count,)."""
    measured = evidence.measured[channel]
    predicted, rows = measured - residual, np.flatnonzero(evidence.thinned(evidence.fit_rows))
    errors = np.empty(count)
    for k in range(count):
        error = measured[rows] - predicted[np.clip(rows - way * k, 0, len(measured) - 1)]
        if channel in evidence.floating:
            error = error - error.mean()
        errors[k] = float(error @ error) / evidence.unit(channel) ** 2
    return errors
