"""The force on the table that the present residual stands for."""

from __future__ import annotations

from feeddrive.diagnosis.finding.scene import Scene
from feeddrive.plant.analysis.stiffness_budget import static_stiffness
from feeddrive.typing import FloatArray


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
