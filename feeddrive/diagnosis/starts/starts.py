"""Values from which the fits of the candidates start, read off the residual."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from feeddrive.diagnosis.finding.scene import Scene
from feeddrive.diagnosis.friction_at_port import declared_level, declared_viscous
from feeddrive.diagnosis.starts.residual_readings import (
    bump_of,
    friction_over_position,
    residual_force,
    residual_forces,
)
from feeddrive.diagnosis.starts.sines import Sine, longest_sine, sine_among_fringes, sine_at, strongest_sines
from feeddrive.effects.base import Effect, Port, number
from feeddrive.effects.friction.friction_deviation import FrictionDeviation
from feeddrive.effects.friction.friction_vs_position import FrictionVsPosition
from feeddrive.effects.friction.presliding import Presliding
from feeddrive.effects.friction.stribeck import Stribeck
from feeddrive.effects.friction.viscous_warmup import ViscousWarmup
from feeddrive.effects.source.ball_pass_ripple import BallPassRipple
from feeddrive.effects.source.position_spring import PositionSpring
from feeddrive.effects.source.torque_ripple import TorqueRipple
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.effects.travel.lead_error_periodic import LeadErrorPeriodic
from feeddrive.effects.travel.thermal_growth import ThermalGrowth
from feeddrive.recording.long.joined import clock
from feeddrive.typing import FloatArray

TABLE_NODES = 12
"""Nodes of a tabulated friction curve over the stroke."""

LEAST_SINE = 0.001
"""Share of its channel's square that a sine must take away: a fifth of the gain that is asked of all channels together,
since a sine of the whole recording misses what the band takes off it in fast strokes."""

HARMONICS = (2, 3)
"""Multiples of an order found that are tried beside it."""

LEAST_CURVE = 0.01
"""Share of the residual force's square that must follow the position before a table is tried."""


BREAK_AWAY = 0.7
"""Share of the steady deflection that a bristle begins with that is elastic first; it is fitted from there."""

SHARES_OF_DURATION = (0.15, 0.6)
"""Time constants that are tried first, over the duration; a longer one looks like a straight line."""


def plain(effect: Effect) -> Callable[[Scene], list[list[Effect]]]:
    """One start, whatever the residual."""
    return lambda scene: [[effect]]


def deviation(scene: Scene) -> list[list[Effect]]:
    """A factor of one at every port that declares friction and has none yet."""
    plant = scene.plant
    ports = [p for p in FrictionDeviation.ports if declared_level(plant, p) or declared_viscous(plant, p)]
    taken = [effect.port for effect in scene.found if effect.name == FrictionDeviation.name]
    return [[FrictionDeviation.of(port)] for port in ports if port not in taken]


def stribeck(scene: Scene) -> list[list[Effect]]:
    """A tenth of the declared level at a few velocities of the recording.

    More than the level is no small change of the motion: a series of that size tells nothing of one that is physical.
    """
    fastest = max(float(np.abs(run.table_velocity).max()) for run in scene.runs)
    size = 0.1 * declared_level(scene.plant, Port.TABLE) or Stribeck.parameter("delta_force").size
    return [[Stribeck.of(delta_force=size, velocity=fastest * share) for share in (0.005, 0.015, 0.05, 0.15, 0.4)]]


def presliding(scene: Scene) -> list[list[Effect]]:
    """Bristles of a few deflections, slipping from the start or after break-away."""
    level = max(declared_level(scene.plant, Port.TABLE), 1.0)
    deflections = (1e-7, 3e-7, 1e-6, 3e-6, 1e-5, 3e-5, 1e-4)
    return [
        [Presliding.of(stiffness=level / z, damping=0.0, break_away=share) for z in deflections]
        for share in (0.0, BREAK_AWAY)
    ]


def backlash(scene: Scene) -> list[list[Effect]]:
    """Widths about the lag of the table, and one that no passage in which it leaves its flank crosses."""
    at = scene.longest
    residual, rows = scene.residuals[at], scene.problem.evidence[at].fit_rows
    widths = [1e-6, 3e-6, 1e-5, 3e-5, 1e-4]
    if "table_position" in residual:
        lag = residual["table_position"][rows]
        flank = float(np.std(lag))  # the table lags by half the play, either way
        widths = [2 * flank, 1.4 * flank, 0.7 * flank, 3 * flank, 2 * float(np.ptp(lag))]
    return [[Backlash.of(width=min(width, 5e-3)) for width in widths]]


def ripple(scene: Scene) -> list[list[Effect]]:
    """The sines that take most of the residual torque."""
    at = scene.longest
    evidence, run = scene.problem.evidence[at], scene.runs[at]
    rows = evidence.fit_rows
    residual, angle = scene.evened(at, "motor_torque")[rows], run.motor_angle[rows]
    sines = strongest_sines(angle, residual, run.motor_speed[rows], evidence.edge)
    sines += sine_among_fringes(angle, residual, run.motor_speed[rows], evidence.edge)
    sines += longest_sine(angle, residual, math.inf)
    sines += _harmonics(scene, TorqueRipple, angle, residual)
    return [[sine(TorqueRipple, one) for one in sines]] if sines else []


def lead_error(scene: Scene) -> list[list[Effect]]:
    """The sines that take most of the residual position."""
    at = scene.longest
    evidence, run = scene.problem.evidence[at], scene.runs[at]
    if "table_position" not in scene.residuals[at]:
        return []
    rows = evidence.fit_rows
    residual, angle = scene.evened(at, "table_position")[rows], run.screw_angle[rows]
    sines = strongest_sines(angle, residual - residual.mean(), run.screw_speed[rows], evidence.edge)
    sines += _harmonics(scene, LeadErrorPeriodic, angle, residual)
    kept = [sine(LeadErrorPeriodic, one) for one in sines if one.share >= LEAST_SINE]
    return [kept] if kept else []


def sine(kind: type[Effect], one: Sine) -> Effect:
    """An effect that is this sine."""
    return kind.of(amplitude=one.amplitude, order=one.order, phase=one.phase)


def _harmonics(scene: Scene, kind: type[Effect], angle: FloatArray, residual: FloatArray) -> list[Sine]:
    """Sines at multiples of the orders that were found: what repeats with an angle is seldom one sine."""
    square, found = float(residual @ residual), []
    orders = [number(effect.values["order"]) for effect in scene.found if effect.name == kind.name]
    for order in [times * order for order in orders for times in HARMONICS]:
        amplitude, phase = sine_at(angle, residual, order)
        found.append(Sine(order, amplitude, phase, 0.5 * amplitude**2 * len(angle) / square if square > 0 else 0.0))
    return found


def over_position(scene: Scene) -> list[list[Effect]]:
    """Bumps that fit the friction left over, and a table where it follows the position."""
    at = scene.longest
    rows, run = scene.problem.evidence[at].fit_rows, scene.runs[at]
    bumps: list[Effect] = []
    tables: list[Effect] = []
    for whole in residual_forces(scene, at):
        force = whole[rows]
        curve = friction_over_position(run.table_position[rows], run.table_velocity[rows], force)
        if curve is None:
            continue
        bumps += [
            FrictionVsPosition.of(peak=peak, centre=centre, half_width=width) for peak, centre, width in bump_of(curve)
        ]
        follows = float(np.sum(curve.samples * curve.force**2)) / float(np.sum(force**2))
        if follows >= LEAST_CURVE and not tables:
            nodes = np.linspace(curve.position[0], curve.position[-1], TABLE_NODES)
            levels = tuple([0.0] * TABLE_NODES)
            tables.append(FrictionVsPosition.of(position=tuple(nodes.tolist()), delta_force=levels))
    return [form for form in (bumps, tables) if form]


def position_spring(scene: Scene) -> list[list[Effect]]:
    """The straight line of the residual force over the position."""
    at = scene.longest
    rows, run = scene.problem.evidence[at].fit_rows, scene.runs[at]
    force = residual_force(scene, at)[rows]
    position = run.table_position[rows]
    slope, offset = np.polyfit(position, force, 1)
    zero = -offset / slope if slope else float(np.mean(position))
    return [[PositionSpring.of(stiffness=float(slope), zero=float(zero))]]


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
    torque = scene.plant.chain.radius / scene.plant.chain.motor_radius * scene.evened(at, "motor_torque")[rows]
    resisting = (torque * np.sign(speed))[moving]
    edge = scene.problem.evidence[at].edge
    sines = strongest_sines(angle, resisting - resisting.mean(), speed[moving], edge)
    sines += sine_among_fringes(angle, resisting, speed[moving], edge)
    sines += _harmonics(scene, BallPassRipple, angle, resisting)
    kept = [sine(BallPassRipple, one) for one in sines if one.share >= LEAST_SINE]
    return [kept] if kept else []


def _time_constants(scene: Scene) -> list[float]:
    evidence = scene.problem.evidence[scene.longest]
    since = clock(evidence.recording)[evidence.fit_rows]  # of hours, what was left out counts as well
    duration = float(np.ptp(since)) + evidence.recording.sample_time
    return [share * duration for share in SHARES_OF_DURATION]
