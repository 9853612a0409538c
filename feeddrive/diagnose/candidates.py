"""Which effects are tried, whether a recording can show them, and the values that their fits start from.

A start is as good as the residual allows: orders from an angle-domain periodogram, a bump from the residual over
position, velocities and stiffnesses from a short scan. Each candidate then is refined before it is compared.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.diagnose.evidence import Evidence
from feeddrive.diagnose.fit import Problem
from feeddrive.diagnose.periodogram import sine_at, strongest_orders
from feeddrive.diagnose.position_curve import bump_of, friction_over_position
from feeddrive.effects.backlash import Backlash
from feeddrive.effects.base import Effect, Port
from feeddrive.effects.constant_force import ConstantForce
from feeddrive.effects.coulomb_asymmetry import CoulombAsymmetry
from feeddrive.effects.drive_delay import DriveDelay
from feeddrive.effects.friction_deviation import FrictionDeviation
from feeddrive.effects.friction_vs_position import FrictionVsPosition
from feeddrive.effects.lead_error_periodic import LeadErrorPeriodic
from feeddrive.effects.payload import Payload
from feeddrive.effects.presliding import Presliding
from feeddrive.effects.stribeck import Stribeck
from feeddrive.effects.torque_ripple import TorqueRipple
from feeddrive.effects.viscous_asymmetry import ViscousAsymmetry
from feeddrive.simulate.driven import LoadMotion
from feeddrive.typing import FloatArray

TABLE_NODES = 12
"""Nodes of a tabulated friction curve over the stroke."""

LEAST_CURVE = 0.01
"""Share of the torque residual's square that must follow the position before a table is tried."""

LEAST_TURNS = 2.0
"""Revolutions that must be travelled before a periodic effect can be told from a trend."""


@dataclass(frozen=True)
class Scene:
    """What a start can be read from: the present residual and motion of every recording.

    Attributes:
        problem: declared plant and recordings.
        found: effects found so far.
        residuals: per recording, channel to measured less predicted in the band, shape (n,).
        runs: per recording, the motion of the load side.
    """

    problem: Problem
    found: tuple[Effect, ...]
    residuals: tuple[dict[str, FloatArray], ...]
    runs: tuple[LoadMotion, ...]

    @property
    def longest(self) -> int:
        """Index of the recording with the most fitted samples."""
        return int(np.argmax([e.fit_rows.sum() for e in self.problem.evidence]))


@dataclass(frozen=True)
class Candidate:
    """An effect to try.

    Attributes:
        name: effect name.
        forms: started separately, each a list of values of which the best is refined.
        needs: why the recordings cannot show it, or an empty text.
        scanned: whether the starts are compared as they are; otherwise after one step of the fit.
    """

    name: str
    forms: Callable[[Scene], list[list[Effect]]]
    needs: Callable[[Scene], str]
    scanned: bool = False


def scene_of(problem: Problem, found: Sequence[Effect]) -> Scene:
    """The scene after the effects found so far."""
    plant = problem.plant.with_effects(*found)
    residuals, runs = [], []
    for evidence in problem.evidence:
        predicted = problem.predictor.predict(plant, evidence)
        residuals.append({name: evidence.measured[name] - predicted[name] for name in evidence.channels})
        runs.append(problem.predictor.load_motion(plant, evidence))
    return Scene(problem, tuple(found), tuple(residuals), tuple(runs))


def _both_directions(scene: Scene) -> str:
    moved = [_moved(run, evidence) for run, evidence in zip(scene.runs, scene.problem.evidence, strict=True)]
    forward, backward = sum(m[0] for m in moved), sum(m[1] for m in moved)
    least = 5 * scene.problem.plant.chain.radius
    if min(forward, backward) < least:
        return f"the recording moves {forward * 1e3:.2g} mm forward and {backward * 1e3:.2g} mm back; it needs both"
    return ""


def _moved(run: LoadMotion, evidence: Evidence) -> tuple[float, float]:
    steps = np.diff(run.table_position)[evidence.fit_rows[1:]]
    return float(steps[steps > 0].sum()), float(-steps[steps < 0].sum())


def _reversals(scene: Scene) -> str:
    count = 0
    for run, evidence in zip(scene.runs, scene.problem.evidence, strict=True):
        direction = np.sign(run.motor_speed[evidence.fit_rows])
        turned = direction[np.abs(run.motor_speed[evidence.fit_rows]) > 1e-3 * np.abs(run.motor_speed).max()]
        count += int(np.sum(np.diff(turned) != 0))
    return "" if count >= 2 else f"the recording has {count} reversals; it needs two or more"


def _turns(scene: Scene) -> str:
    travelled = max(
        float(np.ptp(run.motor_angle[e.fit_rows])) for run, e in zip(scene.runs, scene.problem.evidence, strict=True)
    )
    turns = travelled / (2 * np.pi)
    return "" if turns >= LEAST_TURNS else f"the recording covers {turns:.2g} revolutions; it needs {LEAST_TURNS:g}"


def _lead(scene: Scene) -> str:
    if not any("table_position" in evidence.channels for evidence in scene.problem.evidence):
        return "it needs a table position beside the motor angle"
    return _turns(scene)


def _gap(scene: Scene) -> str:
    if not scene.problem.plant.chain.elastic:
        return "the structure is rigid: free play needs a screw that moves against the table"
    return _reversals(scene)


def _friction(scene: Scene) -> str:
    declared = any(effect.name == "guide_friction" for effect in scene.problem.plant.effects)
    return _both_directions(scene) if declared else "the plant declares no guide_friction to act on"


def _nothing(scene: Scene) -> str:
    return ""


def _plain(effect: Effect) -> Callable[[Scene], list[list[Effect]]]:
    return lambda scene: [[effect]]


def _deviation(scene: Scene) -> list[list[Effect]]:
    ports = [port for port in FrictionDeviation.ports if any(_has_level(e, port) for e in scene.problem.plant.effects)]
    taken = [effect.port for effect in scene.found if effect.name == FrictionDeviation.name]
    return [[FrictionDeviation.of(port)] for port in ports if port not in taken]


def _has_level(effect: Effect, port: Port) -> bool:
    return effect.port == port and "coulomb" in effect.values


def _stribeck(scene: Scene) -> list[list[Effect]]:
    fastest = max(float(np.abs(run.table_velocity).max()) for run in scene.runs)
    size = Stribeck.parameter("delta_force").size
    return [[Stribeck.of(delta_force=size, velocity=fastest * share) for share in (0.005, 0.015, 0.05, 0.15, 0.4)]]


def _presliding(scene: Scene) -> list[list[Effect]]:
    level = _coulomb_level(scene)
    deflections = (1e-7, 3e-7, 1e-6, 3e-6, 1e-5, 3e-5, 1e-4)
    return [
        [Presliding.of(stiffness=level / z, damping=0.0, break_away=share) for z in deflections] for share in (0.0, 0.7)
    ]


def _coulomb_level(scene: Scene) -> float:
    levels = [e.values["coulomb"] for e in scene.problem.plant.effects if _has_level(e, Port.TABLE)]
    return max(float(sum(level for level in levels if isinstance(level, float))), 1.0)


def _backlash(scene: Scene) -> list[list[Effect]]:
    at = scene.longest
    residual, rows = scene.residuals[at], scene.problem.evidence[at].fit_rows
    widths = [1e-6, 3e-6, 1e-5, 3e-5, 1e-4]
    if "table_position" in residual:
        flank = float(np.std(residual["table_position"][rows]))  # the table lags by half the play, either way
        widths = [2 * flank, 1.4 * flank, 0.7 * flank, 3 * flank]
    return [[Backlash.of(width=min(width, 5e-3)) for width in widths]]


def _ripple(scene: Scene) -> list[list[Effect]]:
    at = scene.longest
    rows = scene.problem.evidence[at].fit_rows
    angle, residual = scene.runs[at].motor_angle[rows], scene.residuals[at]["motor_torque"][rows]
    orders = strongest_orders(angle, residual, _highest_order(scene, at))
    return [[_sine(TorqueRipple, angle, residual, order) for order in orders]] if orders else []


def _lead_error(scene: Scene) -> list[list[Effect]]:
    at = scene.longest
    rows = scene.problem.evidence[at].fit_rows
    if "table_position" not in scene.residuals[at]:
        return []
    angle, residual = scene.runs[at].screw_angle[rows], scene.residuals[at]["table_position"][rows]
    orders = strongest_orders(angle, residual, _highest_order(scene, at))
    return [[_sine(LeadErrorPeriodic, angle, residual, order) for order in orders]] if orders else []


def _highest_order(scene: Scene, at: int) -> float:
    """Order whose frequency meets half the sample rate at the highest speed; above it a sampled sine is another one."""
    fastest = float(np.abs(scene.runs[at].motor_speed).max())
    return float(np.pi / scene.problem.evidence[at].recording.sample_time / fastest)


def _sine(kind: type[Effect], angle: FloatArray, residual: FloatArray, order: float) -> Effect:
    amplitude, phase = sine_at(angle, residual, order)
    return kind.of(amplitude=amplitude, order=order, phase=phase)


def _over_position(scene: Scene) -> list[list[Effect]]:
    at = scene.longest
    evidence, run = scene.problem.evidence[at], scene.runs[at]
    rows = evidence.fit_rows
    radius = scene.problem.plant.chain.radius
    curve = friction_over_position(
        run.table_position[rows], run.table_velocity[rows], scene.residuals[at]["motor_torque"][rows] / radius
    )
    if curve is None:
        return []
    bumps: list[Effect] = [
        FrictionVsPosition.of(peak=peak, centre=centre, half_width=width) for peak, centre, width in bump_of(curve)
    ]
    torque = scene.residuals[at]["motor_torque"][rows]
    follows = float(np.sum(curve.samples * (radius * curve.force) ** 2)) / float(np.sum(torque**2))
    if follows < LEAST_CURVE:
        return [bumps]
    nodes = np.linspace(curve.position[0], curve.position[-1], TABLE_NODES)
    table = FrictionVsPosition.of(position=tuple(nodes.tolist()), delta_force=tuple([0.0] * TABLE_NODES))
    return [bumps, [table]]


CANDIDATES: tuple[Candidate, ...] = (
    Candidate("friction_deviation", _deviation, _nothing),
    Candidate("constant_force", _plain(ConstantForce.of(force=0.0)), _nothing),
    Candidate("coulomb_asymmetry", _plain(CoulombAsymmetry.of(delta_force=0.0)), _friction),
    Candidate("viscous_asymmetry", _plain(ViscousAsymmetry.of(delta_viscous=0.0)), _friction),
    Candidate("stribeck", _stribeck, _friction),
    Candidate("presliding", _presliding, lambda scene: _friction(scene) or _reversals(scene), scanned=True),
    Candidate("friction_vs_position", _over_position, _friction),
    Candidate("torque_ripple", _ripple, _turns),
    Candidate("lead_error_periodic", _lead_error, _lead),
    Candidate("backlash", _backlash, _gap, scanned=True),
    Candidate("payload", _plain(Payload.of(mass=0.0)), _nothing),
    Candidate("drive_delay", _plain(DriveDelay.of(delay=0.0)), _nothing),
)
"""Effects that `diagnose` tries, and how."""
