"""Why recordings cannot show an effect, in words for a person; an empty text where they can."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from feeddrive.diagnosis.finding.scene import Scene
from feeddrive.diagnosis.friction_at_port import declared_level
from feeddrive.effects.base import Port

Need = Callable[[Scene], str]

LEAST_TURNS = 1.0
"""Revolutions from which what repeats with the angle is looked for: within one nothing comes to the same angle again.
From when on an order is told from a trend its periods say (`sines.FEWEST_PERIODS`)."""

LEAST_STROKE_TURNS = 1.0
"""Stroke in revolutions of the screw from which position and angle are different things."""


WITHOUT_TORQUE = "the recordings hold no torque or current"
"""Why what acts at the motor cannot be seen."""


def reversals(scene: Scene) -> str:
    """The motor must turn round twice or more."""
    count = 0
    for run, evidence in zip(scene.runs, scene.problem.evidence, strict=True):
        direction = np.sign(run.motor_speed[evidence.fit_rows])
        turned = direction[np.abs(run.motor_speed[evidence.fit_rows]) > 1e-3 * np.abs(run.motor_speed).max()]
        count += int(np.sum(np.diff(turned) != 0))
    return "" if count >= 2 else f"the recording has {count} reversals; it needs two or more"


def turns(scene: Scene) -> str:
    """The motor must turn often enough for a period to be distinguished from a trend."""
    travelled = max(
        float(np.ptp(run.motor_angle[e.fit_rows])) for run, e in zip(scene.runs, scene.problem.evidence, strict=True)
    )
    count = travelled / (2 * np.pi)
    return "" if count >= LEAST_TURNS else f"the recording covers {count:.2g} revolutions; it needs {LEAST_TURNS:g}"


def _position(scene: Scene) -> str:
    seen = any("table_position" in evidence.channels for evidence in scene.problem.evidence)
    return "" if seen else "it needs a table position beside the motor angle"


def lead(scene: Scene) -> str:
    """Travel errors need a table position and some revolutions."""
    return _position(scene) or turns(scene)


def gap(scene: Scene) -> str:
    """Free play needs an elastic chain and reversals."""
    if not scene.plant.chain.elastic:
        return "the structure is rigid: free play needs a screw that moves against the table"
    return reversals(scene)


def friction(scene: Scene) -> str:
    """Friction at the table needs a declared level."""
    if not any(effect.name == "guide_friction" for effect in scene.plant.effects):
        return "the plant declares no guide_friction to act on"
    return force(scene)


def torque(scene: Scene) -> str:
    """What acts at the motor shows in its torque alone, as the motor's motion is given."""
    seen = any("motor_torque" in evidence.channels for evidence in scene.problem.evidence)
    return "" if seen else WITHOUT_TORQUE


def force(scene: Scene) -> str:
    """Forces show in the torque, or in what an elastic chain gives way."""
    return torque(scene) and ("" if scene.plant.chain.elastic else WITHOUT_TORQUE)


def nothing(scene: Scene) -> str:
    """Every recording can show it."""
    return ""


def elastic(scene: Scene) -> str:
    """Stiffness shows only where the chain is elastic."""
    return "" if scene.plant.chain.elastic else "the structure is rigid"


def inertia(scene: Scene) -> str:
    """An inertia differs from a mass on the table only where something between them gives way."""
    return "" if scene.plant.chain.elastic else "the structure is rigid: an inertia is a mass on the table (payload)"


def scale(scene: Scene) -> str:
    """Travel along the stroke needs a table position and a stroke."""
    return _position(scene) or stroke(scene)


def stroke(scene: Scene) -> str:
    """What depends on the position needs a stroke."""
    runs = zip(scene.runs, scene.problem.evidence, strict=True)
    longest = max(float(np.ptp(run.table_position[e.fit_rows])) for run, e in runs)
    least = LEAST_STROKE_TURNS * 2 * np.pi * scene.plant.chain.radius
    return "" if longest >= least else f"the stroke is {longest * 1e3:.2g} mm; it needs {least * 1e3:.3g} mm"


def stiffness_along_stroke(scene: Scene) -> str:
    """A stiffness along the stroke that is no part of the chain itself."""
    if scene.plant.chain.varies:
        return "the chain has its stiffness along the stroke from its parts; ask for that of a part"
    return elastic(scene) or stroke(scene)


def duration(scene: Scene) -> str:
    """What changes slowly is told from the motion where the same motion comes again."""
    return reversals(scene)


def screw_drag(scene: Scene) -> str:
    """What changes the drag of the screw needs a declared one, and a force that the chain knows."""
    if not declared_level(scene.plant, Port.SCREW):
        return "the plant declares no nut_drag or bearing_drag to act on"
    return torque(scene) or elastic(scene)


def both(first: Need, second: Need) -> Need:
    """What needs two things: the first that is lacking. Its docstring, which the effect's page shows, is theirs."""

    def need(scene: Scene) -> str:
        return first(scene) or second(scene)

    need.__doc__ = f"{first.__doc__} {second.__doc__}"
    return need


torque_turns, torque_inertia = both(torque, turns), both(torque, inertia)
force_stroke, force_duration = both(force, stroke), both(force, duration)
scale_duration, screw_drag_turns = both(scale, duration), both(screw_drag, turns)
friction_reversals = both(friction, reversals)
"""Ripples, inertias, springs, warming friction, growth, ball passing, what a reversal shows of friction.

What friction does over speed, position, force or angle shows in one direction as well. What little there is of the
other tells a level from an asymmetry and a ripple of the drag from one of the torque; where it does not, the two are
alike, which the evidence says.
"""
