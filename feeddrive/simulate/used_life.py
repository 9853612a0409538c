"""Life that a motion takes from the nuts of a plant's ball screw: the driven plant gives the force, parts the life.

The force of the nut on the table follows from the motor's motion through the plant's own equations (mass, friction,
weight); a cutting force is added as the screw holds it, without the dynamics between. The preload is shared rigidly
(`feeddrive.parts.screw.double_nut`).
"""

from __future__ import annotations

from feeddrive.parts.life.consumed_life import ConsumedLife, consumed_life, rigid_nut_forces
from feeddrive.plant.analysis.rated_life import preload_of
from feeddrive.plant.plant import Plant
from feeddrive.simulate.driven import motor_motion, simulate_driven
from feeddrive.typing import FloatArray


def used_life(
    plant: Plant, time: FloatArray, motor_angle: FloatArray, cutting_force: FloatArray | None = None
) -> ConsumedLife | None:
    """Life used along a motion.

    Args:
        plant: with its values.
        time: sample times, evenly spaced [s], shape (n,).
        motor_angle: [rad], shape (n,); noise of it counts as rolling, so a recorded one is smoothed before.
        cutting_force: on the table along + motion [N], shape (n,); none if None.

    Returns:
        What the two nuts have used; None where the file declares no `ball_screw.dynamic_rating`, or nothing is elastic,
        so that no force of a nut is known.

    Raises:
        SimulationError: a motion that cannot be followed.
    """
    rating = plant.data["ball_screw.dynamic_rating"].value if "ball_screw.dynamic_rating" in plant.data else None
    if rating is None or not plant.chain.elastic:
        return None
    run = simulate_driven(plant, motor_motion(time, motor_angle))
    force = run.force if cutting_force is None else run.force - cutting_force
    return consumed_life(run.screw_angle, rigid_nut_forces(force, preload_of(plant)), rating)
