"""The linear pass over one recording: what its rest is made of, to first order.

The declared plant, driven by the measured motor motion, predicts torque and table position. What it misses is linear in
small deviations from it, at equal positions:

    x - x_pred = o + s x - g/2 sign F - c F + t v + p_s sin(theta) + p_c cos(theta) + L(x) + H(x) sign v
    (T - T_pred)/r = m a + C sign v + b v + F0 + q_s sin(theta) + q_c cos(theta) + Q(x) + P(x) sign v

| symbol | meaning | unit |
|---|---|---|
| F | force of the nut on the table, of the declared plant | N |
| v, a | speed and acceleration of the motor times r = lead / 2 pi | m/s, m/s^2 |
| o, s | zero of the table against the motor; growth or lead error | m, m/m |
| g, c | play; compliance beyond the declared one | m, m/N |
| t | table read later than the motor | s |
| m, C, b, F0 | mass, Coulomb and viscous friction, constant force beyond the declared ones | kg, N, N s/m, N |
| p, q | once per revolution of the motor | m, N |
| L, H, P, Q | maps over position, the same in every recording: lead, reversal, friction, forces | m, N |

Just after a reversal the table is between the flanks and the friction is not yet sliding: rows there are left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.recording.long.joined import shortened
from feeddrive.simulate.driven import LoadMotion
from feeddrive.typing import BoolArray, FloatArray

TRAVEL = ("offset", "slope", "play", "compliance", "delay", "lead_sine", "lead_cosine")
FORCE = ("mass", "coulomb", "viscous", "force", "ripple_sine", "ripple_cosine")
TERMS = {"table_position": TRAVEL, "motor_torque": FORCE}

SETTLED_WAY = 0.2e-3
"""Way of the motor after a reversal [m]: several times any play, wind-up and presliding distance (some 10 µm each)."""

SETTLED_PERIODS = 3.0
"""Time after a change of the force's sign, in periods of the band's edge: its filter has forgotten it then."""

MAP_CELLS = 24
"""Cells of the maps over the stroke: finer than any smooth lead or friction curve, and 50 values beside the terms."""

FEWEST_ROWS = 100
"""Rows per channel below which a recording says nothing: twice the values of a pass."""


@dataclass(frozen=True)
class Grid:
    """Places of the maps: k times `cell`, k any integer, so that recordings of other strokes share them.

    Attributes:
        cell: [m].
        middle: that slopes are taken about in the pass [m]; the quantities are about the screw's fixed end.
    """

    cell: float
    middle: float


def grid_for(plant: Plant, recording: Recording) -> Grid:
    """The grid of a machine: over its stroke, or that of a recording where none is declared."""
    if plant.stroke is not None:
        low, high = plant.stroke
    else:
        position = _position(recording, plant)
        low, high = float(position.min()), float(position.max())
    return Grid(max(high - low, 1e-3) / MAP_CELLS, 0.5 * (low + high))


@dataclass(frozen=True, eq=False)
class Pass:
    """What is kept of one channel of a recording: the triangle of a QR factorisation of [terms, maps, rest].

    Attributes:
        channel: "table_position" or "motor_torque".
        triangle: (q, q), upper; columns: terms, hats of map 1, hats of map 2, rest.
        first: index of the first hat on the grid.
        hats: of each map.
        rows: samples that it stands for.
        declared: terms that the plant's own prediction has, so that value = declared + deviation; (p,).
        slow_force: size of the force of the nut in slow motion [N]; 0 where it is not known.
    """

    channel: str
    triangle: FloatArray
    first: int
    hats: int
    rows: int
    declared: FloatArray
    slow_force: float


def linear_pass(recording: Recording, plant: Plant, grid: Grid) -> tuple[Pass, ...]:
    """The pass over one recording, a result for each channel that can be predicted.

    Raises:
        InputError: a recording that cannot be used with this plant.
    """
    recording = shortened(recording, plant.chain.motor_radius)
    evidence = prepare(recording, plant, 1.0)
    predictor = AxisPredictor()
    run = predictor.load_motion(plant, evidence)
    if not np.isfinite(run.torque).all():
        raise InputError("the plant cannot follow its motion", recording.name, "check recording and plant")
    found = []
    for channel in evidence.channels:
        if channel == "motor_torque" and evidence.scaled_from:
            continue  # only proportional to the torque: no forces without a torque constant
        made = _Columns(recording, plant, grid, evidence, run).passed(channel, predictor)
        found += [] if made is None else [made]
    if not found:
        what = "too little steady motion, or no torque and no scale"
        raise InputError(what, recording.name, "record strokes of several mm at two speeds")
    return tuple(found)


def _position(recording: Recording, plant: Plant) -> FloatArray:
    if "table_position" in recording:
        return recording["table_position"]
    return plant.chain.motor_radius * recording["motor_angle"]


@dataclass(frozen=True, eq=False)
class _Columns:
    """Columns of the pass over one recording."""

    recording: Recording
    plant: Plant
    grid: Grid
    evidence: AxisEvidence
    run: LoadMotion

    def passed(self, channel: str, predictor: AxisPredictor) -> Pass | None:
        """The pass of a channel; None where too few rows are left."""
        evidence, radius = self.evidence, self.plant.chain.motor_radius
        speed = radius * evidence.motion.speed[evidence.motion.samples]
        force = self._force(radius)
        # travel is judged where the flank is settled, torque where the friction slides
        used = evidence.thinned(evidence.counted & self._settled(speed, speed if channel == "motor_torque" else force))
        if np.count_nonzero(used) < FEWEST_ROWS:
            return None
        position = _position(self.recording, self.plant)[used]
        predicted = predictor.predict(self.plant, evidence)[channel]
        rest = (evidence.measured[channel] - predicted)[used]
        terms = self._terms(channel, used, position, speed, force)
        if channel == "motor_torque":
            rest, explained = rest / radius, predicted[used] / radius
        else:
            explained = (
                predicted[used] - radius * evidence.band.filter(evidence.motion.angle[evidence.motion.samples])[used]
            )
        declared = _regularised(terms, explained)
        first, hats, maps = _hats(position, self.grid, np.sign(speed[used]))
        triangle = np.asarray(np.linalg.qr(np.column_stack([terms, maps, rest]), mode="r"))
        return Pass(channel, triangle, first, hats, int(used.sum()), declared, self._slow_force(used, speed, force))

    def _force(self, radius: float) -> FloatArray:
        """Force of the nut, of a rigid machine what the motor's torque is at the table."""
        raw = self.run.force if self.plant.chain.elastic else self.run.torque / radius
        return self.evidence.band.filter(raw)

    def _settled(self, speed: FloatArray, turning: FloatArray) -> BoolArray:
        """Samples far enough from the last change of sign of speed and of what turns the flank."""
        step = self.recording.sample_time
        way = np.concatenate([[0.0], np.cumsum(np.abs(speed[1:]) * step)])
        period = max(1, round(SETTLED_PERIODS / self.evidence.edge / step))
        good = np.ones(len(speed), dtype=bool)
        for series in (speed, turning):
            signs = np.sign(series)
            flips = np.flatnonzero(signs[1:] != signs[:-1]) + 1
            last = np.zeros(len(speed), dtype=int)
            last[flips] = flips
            last = np.maximum.accumulate(last)
            since = np.arange(len(speed)) - last
            nearest_ahead = np.full(len(speed), len(speed))
            nearest_ahead[flips] = flips
            ahead = np.minimum.accumulate(nearest_ahead[::-1])[::-1] - np.arange(len(speed))
            good &= (way - way[last] > SETTLED_WAY) & (since > period) & (ahead > period)
        return good

    def _terms(
        self, channel: str, used: BoolArray, position: FloatArray, speed: FloatArray, force: FloatArray
    ) -> FloatArray:
        """Columns of the terms, (k, p)."""
        evidence, radius = self.evidence, self.plant.chain.motor_radius
        angle = evidence.motion.angle[evidence.motion.samples][used]
        ones, v = np.ones(len(position)), speed[used]
        # over part of a revolution a sine is a curve over the stroke, which the maps have
        turn = [np.sin(angle), np.cos(angle)] if np.ptp(angle) >= 2 * np.pi else [0.0 * ones, 0.0 * ones]
        if channel == "table_position":
            f = force[used]
            return np.column_stack([ones, position - self.grid.middle, -0.5 * np.sign(f), -f, v, *turn])
        acceleration = radius * evidence.band.filter(evidence.motion.acceleration[evidence.motion.samples])[used]
        return np.column_stack([acceleration, np.sign(v), v, ones, *turn])

    def _slow_force(self, used: BoolArray, speed: FloatArray, force: FloatArray) -> float:
        """Median size of the force where little of it accelerates."""
        inertial = (
            np.abs(self.evidence.motion.acceleration[self.evidence.motion.samples]) * self.plant.chain.motor_radius
        )
        mild = used & (inertial <= np.quantile(inertial[used], 0.3))
        return float(np.median(np.abs(force[mild]))) if mild.any() else 0.0


def _regularised(terms: FloatArray, values: FloatArray) -> FloatArray:
    """Least squares with columns of equal length, directions that the rows do not show left at zero."""
    size = np.linalg.norm(terms, axis=0)
    size[size == 0] = 1.0
    solved, *_ = np.linalg.lstsq(terms / size, values, rcond=1e-6)
    found: FloatArray = solved / size
    return found


def _hats(position: FloatArray, grid: Grid, side: FloatArray) -> tuple[int, int, FloatArray]:
    """Index of the first hat, hats of each map, and both maps' columns, (k, 2 hats)."""
    at = position / grid.cell
    below = np.floor(at).astype(int)
    first, hats = int(below.min()), int(below.max() - below.min()) + 2
    columns = np.zeros((len(position), hats))
    rows, share = np.arange(len(position)), at - below
    columns[rows, below - first] = 1 - share
    columns[rows, below - first + 1] = share
    return first, hats, np.column_stack([columns, columns * side[:, None]])
