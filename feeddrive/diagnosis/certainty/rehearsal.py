"""Shipped scenarios as this axis would run them: recordings to come, without noise, made ready for comparison.

The motion is that of the plant with what was found, under its declared cascade, or under that of the scenario with its
gain scaled by the inertia that moves. It has to fit the axis: within the declared stroke, or no longer than what was
recorded; below the torque limit; with a stable loop. Scenarios with a force on the table and those shorter than a
recording that can be compared are passed, as `diagnose` could not use what they record.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.preparing import SHORTEST, prepare
from feeddrive.engine.step.linear_part import SimulationError
from feeddrive.errors import InputError
from feeddrive.files import shipped_scenarios
from feeddrive.plant.analysis.modes import inertia_at_motor
from feeddrive.plant.plant import DeclaredCascade, Plant
from feeddrive.schema.table import Origins, Table
from feeddrive.servo.cascade import Cascade
from feeddrive.servo.linear_loop import refuse_unstable
from feeddrive.simulate.scenario.scenario import Recorder, Scenario
from feeddrive.simulate.scenario.scenario_controller import read_cascade
from feeddrive.simulate.scenario.scenario_file import read_scenario
from feeddrive.simulate.scenario.scenario_run import run_scenario
from feeddrive.simulate.setpoints.cutting_force import NoForce, held
from feeddrive.simulate.setpoints.setpoint_motion import Motion, Stop, Trajectory
from feeddrive.typing import FloatArray

LOOKED_AT = 2000
"""Times at which a trajectory is looked at for its ends."""

SLACK = 1e-3
"""By which a motion may be longer than what was recorded [m]: where a stroke was driven to its end is read to that."""

WORKERS = 2
"""Scenarios run at the same time."""


@dataclass(frozen=True)
class Rehearsal:
    """A scenario as this axis would run it.

    Attributes:
        name: of the shipped scenario.
        evidence: what would be recorded, with the noise of the sensors at hand but none drawn.
        moved: by which its positions are moved to fit the axis [m].
    """

    name: str
    evidence: AxisEvidence
    moved: float


@dataclass(frozen=True)
class Moved:
    """A trajectory with its positions moved [m]."""

    inner: Trajectory
    by: float

    @property
    def duration(self) -> float:
        return self.inner.duration

    @property
    def stops(self) -> tuple[Stop, ...]:
        return tuple(replace(stop, target=stop.target + self.by) for stop in self.inner.stops)

    def at(self, time: FloatArray) -> Motion:
        motion = self.inner.at(time)
        return replace(motion, position=motion.position + self.by)


def rehearsals(declared: Plant, after: Plant, recorded: Sequence[AxisEvidence]) -> list[Rehearsal]:
    """All shipped scenarios that this axis can run, in the order of their names.

    Args:
        declared: the plant as declared, which compares.
        after: the plant with what was found, which moves.
        recorded: recordings at hand, whose sensors and sample time apply.
    """
    with ThreadPoolExecutor(WORKERS) as pool:
        tried = pool.map(lambda path: _rehearsed(path, declared, after, recorded), shipped_scenarios())
    return [one for one in tried if one is not None]


def _rehearsed(path: Path, declared: Plant, after: Plant, recorded: Sequence[AxisEvidence]) -> Rehearsal | None:
    try:
        scenario = read_scenario(path)
        if scenario.duration < SHORTEST or _pushed(scenario):
            return None
        moved = _fitting_move(scenario.trajectory, _travel(after, recorded))
        if moved is None:
            return None
        ready = _for_axis(scenario, after, recorded[0], moved)
        refuse_unstable(after, ready.cascade, str(path), after.middle)
        run = run_scenario(ready)
        if np.abs(run.series["motor_torque"]).max() >= 0.999 * ready.cascade.torque_limit:
            return None
        evidence = prepare(run.recording, declared, 1.0)
    except (InputError, SimulationError):  # this axis cannot run it
        return None
    return Rehearsal(path.stem, _with_noise_of(evidence, recorded[0]), moved)


def _pushed(scenario: Scenario) -> bool:
    """Whether a force acts on the table, which a diagnosis does not know of."""
    if isinstance(scenario.force, NoForce):
        return False
    return bool(np.any(held(scenario.force, 0, scenario.ticks, scenario.cascade.sample_time)))


def _travel(plant: Plant, recorded: Sequence[AxisEvidence]) -> tuple[float, float]:
    """Table positions [m] that the axis is known to reach: its declared stroke, or what was recorded."""
    if plant.stroke is not None:
        return plant.stroke
    reached = [plant.chain.motor_radius * one.motion.angle for one in recorded]
    return min(float(r.min()) for r in reached) - SLACK, max(float(r.max()) for r in reached) + SLACK


def _fitting_move(trajectory: Trajectory, travel: tuple[float, float]) -> float | None:
    """Least move of a trajectory that keeps it in the travel [m]; None where it is longer than that."""
    times = np.concatenate([np.linspace(0.0, trajectory.duration, LOOKED_AT), [s.arrival for s in trajectory.stops]])
    position = trajectory.at(times).position
    low, high = float(position.min()), float(position.max())
    if high - low > travel[1] - travel[0]:
        return None
    return max(travel[0] - low, 0.0) + min(travel[1] - high, 0.0)


def _for_axis(scenario: Scenario, plant: Plant, like: AxisEvidence, moved: float) -> Scenario:
    """The scenario on this plant, recorded as the recording at hand was."""
    cascade = _cascade(scenario, plant)
    divider = max(1, round(like.recording.sample_time / cascade.sample_time))
    channels = tuple(dict.fromkeys(("motor_angle", *like.channels)))
    return replace(
        scenario,
        plant=plant,
        cascade=cascade,
        trajectory=Moved(scenario.trajectory, moved) if moved else scenario.trajectory,
        recorder=Recorder(divider, channels, {}, False, 0),
        ticks=math.ceil(scenario.duration / cascade.sample_time - 1e-6),
    )


def _cascade(scenario: Scenario, plant: Plant) -> Cascade:
    """The plant's own cascade, or the scenario's with its torques scaled by the inertia that moves."""
    if isinstance(plant.controller, DeclaredCascade):
        cascade, _ = read_cascade(Table(plant.controller.entries, plant.controller.where, Origins()), plant)
        mode = scenario.cascade.position_gain  # a scenario of the velocity loop alone opens the position loop
        cascade = cascade if mode > 0 else replace(cascade, position_gain=0.0)
    else:
        given = scenario.cascade
        ratio = inertia_at_motor(plant) / inertia_at_motor(scenario.plant)
        forward = replace(
            given.feed_forward,
            inertia=given.feed_forward.inertia * ratio,
            coulomb=given.feed_forward.coulomb * ratio,
            viscous=given.feed_forward.viscous * ratio,
        )
        # a notch is at a mode of the scenario's own plant
        same = plant.name == scenario.plant.name
        filters = given.torque_filters if same else ()
        cascade = replace(
            given,
            radius=plant.chain.motor_radius,
            velocity_gain=given.velocity_gain * ratio,
            torque_limit=given.torque_limit * ratio,
            feed_forward=forward,
            torque_filters=filters,
        )
    return replace(cascade, torque_limit=min(cascade.torque_limit, plant.torque_limit))


def _with_noise_of(evidence: AxisEvidence, like: AxisEvidence) -> AxisEvidence:
    """The evidence with the sensor noise of a recording at hand, in its own band."""
    ratio = evidence.band.noise_gain / like.band.noise_gain
    return replace(evidence, noise={name: like.noise[name] * ratio for name in evidence.channels})
