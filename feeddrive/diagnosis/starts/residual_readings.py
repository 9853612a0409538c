"""What the present residual holds: a force on the table, and a friction over the position."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from feeddrive.diagnosis.finding.scene import Scene
from feeddrive.plant.analysis.stiffness_budget import static_stiffness
from feeddrive.typing import FloatArray

BINS = 60
"""Bins along the stroke."""


def residual_force(scene: Scene, at: int) -> FloatArray:
    """Force that resists + motion beyond what is predicted [N], shape (n,), of the recording number `at`.

    From the torque over the radius; without a torque from the table lagging on the spring that holds it.
    """
    return residual_forces(scene, at)[0]


def residual_forces(scene: Scene, at: int) -> list[FloatArray]:
    """The force that is left, by every channel that shows it, the torque's first; shape (n,) each.

    On a soft drive the lag of the table tells forces that are lost in the noise of the torque.
    """
    residual, forces = scene.residuals[at], []
    if "motor_torque" in residual:
        forces.append(residual["motor_torque"] / scene.plant.chain.motor_radius)
    if "table_position" in residual and scene.plant.chain.elastic:
        forces.append(-static_stiffness(scene.plant, scene.plant.middle) * residual["table_position"])
    return forces


@dataclass(frozen=True)
class PositionCurve:
    """Friction beyond the model along the stroke: position [m], force [N], samples, each of shape (k,)."""

    position: FloatArray
    force: FloatArray
    samples: FloatArray


def friction_over_position(position: FloatArray, velocity: FloatArray, force: FloatArray) -> PositionCurve | None:
    """Mean resisting force per position bin, from both directions.

    Args:
        position: [m], shape (n,).
        velocity: [m/s], shape (n,).
        force: residual force, positive where the recording needs more [N], shape (n,).

    Returns:
        The curve, or None where the table hardly moves.
    """
    moving = np.abs(velocity) > 0.01 * np.abs(velocity).max(initial=0.0)
    if np.sum(moving) < 10 * BINS:
        return None
    x, resisting = position[moving], (force * np.sign(velocity))[moving]
    low, high = np.quantile(x, [0.002, 0.998])
    if not high > low:
        return None
    edges = np.linspace(low, high, BINS + 1)
    bins = np.clip(np.digitize(x, edges) - 1, 0, BINS - 1)
    samples = np.bincount(bins, minlength=BINS)
    mean = np.bincount(bins, weights=resisting, minlength=BINS) / np.maximum(samples, 1)
    filled = samples > 0
    centres = 0.5 * (edges[1:] + edges[:-1])
    return PositionCurve(centres[filled], mean[filled], samples[filled].astype(float))


def bump_of(curve: PositionCurve, count: int = 3) -> list[tuple[float, float, float]]:
    """Peak [N], centre [m] and half width [m] of the Gaussian bumps that fit the curve best.

    A scan over centre and width, each with the best peak; bins weigh by the root of their samples.
    """
    stroke = curve.position[-1] - curve.position[0]
    weight = np.sqrt(curve.samples)
    found = []
    for width in stroke * np.array([0.03, 0.05, 0.08, 0.12, 0.18, 0.28, 0.45]):
        for centre in np.linspace(curve.position[0], curve.position[-1], 41):
            shape = np.exp(-(((curve.position - centre) / width) ** 2))
            power = float(np.sum(weight * shape**2))
            peak = float(np.sum(weight * shape * curve.force)) / power
            found.append((peak**2 * power, peak, float(centre), float(width)))
    found.sort(reverse=True)
    chosen: list[tuple[float, float, float]] = []
    for _, peak, centre, width in found:
        if all(abs(centre - other[1]) > 0.5 * max(width, other[2]) for other in chosen):
            chosen.append((peak, centre, width))
        if len(chosen) == count:
            break
    return chosen
