"""Recordings of the shipped machines of parts, made by finite elements, with and without something planted."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np

from feeddrive.effects.base import Motion, Port
from feeddrive.files import find_plant
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.friction_law import friction_level
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import parameter_symbols, parameter_values
from feeddrive.recording import Recording
from tests.generator.profile import setpoint_and_chirp, train_profile, validate_profile
from tests.generator.screw_elements import Drive, Friction, Planted, Recorder, drive_of, record

SAMPLE = 5e-4
MARGIN = 0.05
"""Left free at both ends of the stroke [m]."""

CHIRP = {"kimm_testbed": 2.0, "hsr_axis": 2.0, "vertical_axis": 1.0}
"""Amplitude of the injected torque [N m]: some micrometres of the table up to its first resonance."""


def friction_of(plant: Plant) -> Friction:
    """The declared friction as numbers for the elements; the level of the screw over the transmitted force as rows."""
    guide = next(effect.values for effect in plant.effects if effect.name == "guide_friction")
    drags = [effect.values for effect in plant.effects if effect.port == Port.SCREW]
    forces = np.linspace(-2e4, 2e4, 4001)
    symbols = parameter_symbols(plant)
    columns = []
    for way in (1.0, -1.0):
        motion = Motion(ca.SX(0.0), ca.SX(way), 0.0, force := ca.SX.sym("force"), plant.chain.radius)
        level = ca.Function("level", [force, symbols.vector], [friction_level(plant, symbols, Port.SCREW, motion)])
        columns.append(np.array([float(level(f, parameter_values(plant))) for f in forces]))
    pulling = sum(float(e.values["force"]) for e in plant.effects if e.name == "constant_force")
    table = tuple(float(guide.get(key, 0.0)) for key in ("coulomb", "smoothing_velocity", "viscous", "film_force"))
    exponent = float(guide.get("film_exponent", 0.5))
    smoothing = {float(drag["smoothing_speed"]) for drag in drags}
    assert len(smoothing) == 1
    screw = (smoothing.pop(), sum(float(drag["viscous"]) for drag in drags))
    return Friction((*table, exponent), screw, np.column_stack([forces, *columns]), pulling)


@cache
def made(name: str, seconds: float, validate: bool, seed: int, changes: tuple[tuple[str, Any], ...] = ()) -> Recording:
    """A recording of a shipped machine.

    changes: (what, value) of the drive, of its friction (Stribeck, bump) or of what is planted in the transmission.
    """
    path = find_plant(name)
    plant, drive = read_plant(path), drive_of(path)
    friction, planted, recorder = friction_of(plant), Planted(), Recorder()
    for key, value in changes:
        if hasattr(drive, key):
            drive = replace(drive, **{key: value})
        elif hasattr(friction, key):
            friction = replace(friction, **{key: value})
        elif hasattr(planted, key):
            planted = replace(planted, **{key: value})
        else:
            recorder = replace(recorder, **{key: value})
    assert plant.stroke is not None
    low, high = plant.stroke
    axis = SimpleNamespace(
        travel=(low + MARGIN, high - MARGIN), top_speed=0.25, acceleration=2.5, chirp_amplitude=CHIRP[name],
        sample_time=SAMPLE,
    )  # fmt: skip
    profile = (validate_profile if validate else train_profile)(axis, seconds)  # type: ignore[arg-type]
    channels = record(drive, friction, *setpoint_and_chirp(profile, SAMPLE), seed, planted, recorder)
    time = channels.pop("time")
    return Recording(f"{name}, {'validate' if validate else 'train'}", time, channels, SAMPLE)


def softer(drive: Drive, part: str, factor: float) -> tuple[tuple[str, Any], ...]:
    """The change of a drive whose part is as stiff as `factor` times the declared one."""
    if part == "coupling":
        *before, (stiffness, inertia) = drive.springs
        return (("springs", (*before, (stiffness * factor, inertia))),)
    return ((part, getattr(drive, part) * factor),)
