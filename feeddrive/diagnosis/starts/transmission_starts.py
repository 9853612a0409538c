"""Starts of what makes the spring of the transmission other than a straight line: read off the lag of the table.

Where the motor is given, the table lags by the stretch of the spring. What a softer spring adds to it, in the band,

    -x_left = b sat(F, F1) / k                 preload lost around zero force, b = 1 / ratio - 1
    -x_left = (b u + 4 m u (1 - u)) F / k,    u = (x - x_l) / (x_h - x_l)    stiffness falling along the stroke

follows the transmitted force F; the first by least squares for a few F1, beside the slopes of declared values, which
have taken what they can of it within their tolerances. Where the lag does not follow, no simulation is spent on it.
The second begins at none: what a coarse scale hides of the lag may show in the torque, whose resonance moves along the
stroke.
"""

from __future__ import annotations

import numpy as np

from feeddrive.diagnosis.calibration.calibration import Whitener, whitener
from feeddrive.diagnosis.finding.materiality import is_material
from feeddrive.diagnosis.finding.scene import Scene
from feeddrive.diagnosis.likelihood.coordinates import LEAST
from feeddrive.effects.base import Effect
from feeddrive.effects.chain.stiffness_deviation import StiffnessDeviation, parts_of
from feeddrive.effects.transmission.preload_loss import PreloadLoss
from feeddrive.effects.transmission.stiffness_vs_position import StiffnessVsPosition
from feeddrive.plant.analysis.stiffness_budget import nut_stiffness
from feeddrive.typing import FloatArray

LEAST_LAG = 0.004
"""Share of the square of what is left of the position that must follow the force: less than what an effect must take
away of all channels together, and twice what the best of the forces tried takes from noise in some seconds."""

PARABOLA = 0.01
"""Compliance halfway that a parabola begins with: one of none is a straight line, which has a value less."""

FORCES = 24
"""Forces F1 that are tried, up to the greatest transmitted one."""

LEAST_FORCE = 0.002
"""Smallest of them over the greatest transmitted force, some ten times that of friction; a loss within it is a free
play."""

NOTHING = 1e-18
"""Mean square over the largest square below which a series does not change: rounding leaves as much of a constant."""


def preload_loss(scene: Scene) -> list[list[Effect]]:
    """The force up to which the lag grows best with it, and the ratio that goes with it."""
    lag, force = _lag(scene), _transmitted(scene)
    if not np.any(force):
        return []
    stiffness = nut_stiffness(scene.plant)
    if lag is None:
        return [[PreloadLoss.of(ratio=0.3, force=float(share * np.std(force))) for share in (0.3, 1.0)]]
    beside = _beside_values(scene)
    lag = beside.applied(lag)
    limits = np.abs(force).max() * np.geomspace(LEAST_FORCE, 1.0, FORCES)
    slopes, shares = np.zeros(FORCES), np.zeros(FORCES)
    for i, limit in enumerate(limits):  # one after the other: all at once are four times the recording
        stretch = beside.applied(_in_band(scene, np.clip(force, -limit, limit) / stiffness))
        energy = float(stretch @ stretch)
        if energy <= NOTHING * len(stretch) * (limit / stiffness) ** 2:
            continue  # the force never comes below the limit: in one direction the lag stays as it is
        slopes[i] = float(stretch @ lag) / energy
        shares[i] = slopes[i] ** 2 * energy / float(lag @ lag)
    best = int(np.argmax(np.where(slopes > 0, shares, 0.0)))
    if slopes[best] <= 0 or shares[best] < LEAST_LAG:
        return []
    ratio = max(1 / (1 + float(slopes[best])), LEAST[PreloadLoss.name, "ratio"])
    start = PreloadLoss.of(ratio=ratio, force=float(limits[best]))
    return [[start]] if is_material(start, scene.plant) else []


def stiffness(scene: Scene) -> list[list[Effect]]:
    """The declared stiffness, of every part that the chain knows apart and that has no other one yet."""
    taken = {effect.place for effect in scene.found if effect.name == StiffnessDeviation.name}
    parts = [part for part in parts_of(scene.plant.chain.values) if part not in taken]
    return [[StiffnessDeviation.of(place=part, factor=1.0)] for part in parts]


def stiffness_vs_position(scene: Scene) -> list[list[Effect]]:
    """A straight line and a parabola, where force and place change.

    The stroke is the declared one, or where none is declared that of the recordings.
    """
    low, high = scene.plant.stroke or _travelled(scene)
    lag, force = _lag(scene), _transmitted(scene)
    forms: list[list[Effect]] = [
        [StiffnessVsPosition.of(share_over_stroke=0.0, middle_compliance=middle, low=low, high=high)]
        for middle in (0.0, PARABOLA)
    ]
    if lag is None:
        return forms
    stretch = force / nut_stiffness(scene.plant)
    along = (scene.runs[scene.longest].table_position - low) / (high - low)
    beside = _beside_values(scene)
    everywhere, *growing = (
        beside.applied(one)
        for one in _in_band(scene, np.column_stack([stretch, stretch * along, stretch * along * (1 - along)])).T
    )
    least = NOTHING * len(stretch) * float(np.max(stretch**2))
    if not float(everywhere @ everywhere) > least:
        return []  # a force that stays
    growing = [one - everywhere * float(one @ everywhere) / float(everywhere @ everywhere) for one in growing]
    # where no column is left the place stays
    return forms if any(float(one @ one) > least for one in growing) else []


def _beside_values(scene: Scene) -> Whitener:
    """What takes out of a series of the fitted table position what declared values within tolerances may stand for."""
    evidence, known = scene.problem.evidence[scene.longest], scene.problem.calibration
    if known is None or not known.values:
        return whitener(np.zeros((int(evidence.fit_rows.sum()), 0)), np.zeros(0), 1.0)
    columns = known.slopes[evidence.recording]["table_position"][evidence.fit_rows]
    columns = (columns - columns.mean(axis=0)) / evidence.unit("table_position")
    # of all samples, of which fits take a few
    return whitener(columns, known.coordinates, known.variance * evidence.thinning)


def _lag(scene: Scene) -> FloatArray | None:
    """How far the table stays behind what is predicted, about its mean, fitted samples [m]; None without a scale."""
    residual = scene.residuals[scene.longest]
    if "table_position" not in residual:
        return None
    left = residual["table_position"][scene.problem.evidence[scene.longest].fit_rows]
    behind: FloatArray = left.mean() - left
    return behind


def _transmitted(scene: Scene) -> FloatArray:
    """Force of the nut on the table with what was found so far, all samples [N]."""
    return scene.runs[scene.longest].force


def _in_band(scene: Scene, series: FloatArray) -> FloatArray:
    """Series, or columns, as they show in the comparison, about their means; all samples in, fitted ones out."""
    evidence = scene.problem.evidence[scene.longest]
    seen = evidence.in_band(series)[evidence.fit_rows]
    about_mean: FloatArray = seen - seen.mean(axis=0)
    return about_mean


def _travelled(scene: Scene) -> tuple[float, float]:
    """Least and greatest table position of all recordings [m]."""
    positions = [run.table_position for run in scene.runs]
    return min(float(p.min()) for p in positions), max(float(p.max()) for p in positions)
