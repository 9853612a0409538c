"""Starts of what grows with position or changes while the recording lasts: springs, lead, warming, ball passing."""

from __future__ import annotations

import numpy as np

from feeddrive.diagnosis.finding.scene import Scene
from feeddrive.diagnosis.friction_at_port import declared_viscous
from feeddrive.diagnosis.starts.periodogram import strongest_sines
from feeddrive.diagnosis.starts.residual_force import residual_force
from feeddrive.diagnosis.starts.starts import LEAST_SINE, sine
from feeddrive.effects.base import Effect
from feeddrive.effects.friction.viscous_warmup import ViscousWarmup
from feeddrive.effects.source.ball_pass_ripple import BallPassRipple
from feeddrive.effects.source.position_spring import PositionSpring
from feeddrive.effects.travel.thermal_growth import ThermalGrowth

SHARES_OF_DURATION = (0.15, 0.6)
"""Time constants that are tried first, over the duration; a longer one looks like a straight line."""


def position_spring(scene: Scene) -> list[list[Effect]]:
    """The straight line of the residual force over the position."""
    at = scene.longest
    rows, run = scene.problem.evidence[at].fit_rows, scene.runs[at]
    force = residual_force(scene, at)[rows]
    position = run.table_position[rows]
    slope, offset = np.polyfit(position, force, 1)
    zero = -offset / slope if slope else float(np.mean(position))
    # far off the stroke a spring is a constant force; it starts where its force still changes
    reach = 2 * float(np.ptp(position))
    middle = float(np.mean(position))
    return [[PositionSpring.of(stiffness=float(slope), zero=float(np.clip(zero, middle - reach, middle + reach)))]]


def thermal_growth(scene: Scene) -> list[list[Effect]]:
    """A strain of its usual size, settling within the recording."""
    size = ThermalGrowth.parameter("strain").size
    return [[ThermalGrowth.of(strain=size, time_constant=seconds) for seconds in _time_constants(scene)]]


def viscous_warmup(scene: Scene) -> list[list[Effect]]:
    """A tenth of the viscous drag lost within the recording, at every port that declares one."""
    ports = [port for port in ViscousWarmup.ports if declared_viscous(scene.plant, port)]
    return [[ViscousWarmup.of(port, share=0.1, time_constant=t) for t in _time_constants(scene)] for port in ports]


def ball_pass_ripple(scene: Scene) -> list[list[Effect]]:
    """Orders of the residual torque that changes sign with the direction."""
    at = scene.longest
    rows, run = scene.problem.evidence[at].fit_rows, scene.runs[at]
    speed = run.screw_speed[rows]
    moving = np.abs(speed) > 0.01 * np.abs(speed).max()
    angle = run.screw_angle[rows][moving]
    torque = scene.plant.chain.radius * residual_force(scene, at)[rows]
    resisting = (torque * np.sign(speed))[moving]
    edge = scene.problem.evidence[at].edge
    sines = strongest_sines(angle, resisting - resisting.mean(), speed[moving], edge, count=1)
    return [[sine(BallPassRipple, one)] for one in sines if one.share >= LEAST_SINE]


def _time_constants(scene: Scene) -> list[float]:
    evidence = scene.problem.evidence[scene.longest]
    duration = float(evidence.fit_rows.sum()) * evidence.recording.sample_time
    return [share * duration for share in SHARES_OF_DURATION]
