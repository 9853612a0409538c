"""A recording made ready for comparison: motor motion, measured channels in the band, and which samples count."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self

import numpy as np

from feeddrive.diagnosis.calibration.calibration import Whitener, whitener
from feeddrive.diagnosis.likelihood.band import END_CUT, Band, comparison_band, held, sensor_noise
from feeddrive.diagnosis.likelihood.encoder_error import encoder_error, known_motion_of
from feeddrive.diagnosis.likelihood.lead_map import lead_map
from feeddrive.diagnosis.likelihood.slow_rows import (
    is_slow,
    known_motion,
    missed_between_rows,
    refuse_unknown_motion,
    sentence,
)
from feeddrive.diagnosis.likelihood.weighing import Weighing
from feeddrive.diagnosis.suspicion.channel_timing import lagging
from feeddrive.diagnosis.suspicion.flawed_rows import refuse_little_left, sound_rows, without_copied_position
from feeddrive.diagnosis.suspicion.torque_channel import with_torque
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.recording.checks.flaws import quantisation_step
from feeddrive.recording.long.joined import clock, recorded
from feeddrive.simulate.driven import MotorMotion, motor_motion
from feeddrive.typing import BoolArray, FloatArray

PREDICTED = ("motor_torque", "table_position")
"""Channels that are predicted from the measured motor motion."""

NO_SENSOR = 2.0**-32
"""Noise over the range of a channel below which no sensor made it: the finest encoders count 2^32 steps. A simulation
without noise is compared as far as its rows tell the motion between them."""

SHORTEST = 3.0
"""Shortest recording [s] that leaves something between the cut ends."""


LEAST_ZERO = 1e-4
"""Difference [m] of the zeros of table and motor that moves the nut: 0.1 mm of screw give way 0.5 nm per kilonewton."""

BLOCK = 0.5
"""Length of a block of cross-validation [s]: many correlation times of the band, and short against a stroke."""


@dataclass(frozen=True, eq=False)
class Evidence:
    """One recording, ready for comparison; each is a key of its own.

    Attributes:
        recording: as read.
        measured: channel to its series in the band, shape (n,), SI.
        noise: channel to the rms of its sensor noise in the band.
        counted: samples that count: not at the ends, and predictable; shape (n,).
        fitted: samples that parameters are fitted on; the other counted ones are judged; shape (n,).
        edge: upper edge of the band [Hz].
        block: length of a block of cross-validation [s].
        thinning: every how many samples carry all that is in the band.
        floating: channels whose zero is not known, and taken out of every error.
        model_error: channel to the rms of what the model itself may miss; channels left out are predicted exactly.
        lost: samples that would count, but that a free play of the plant leaves unpredictable, (n,); None for none.
        left: channel to what is left of it over its noise, where it weighs no more than that (`Problem.balanced`,
            `weighed_by_rest`).
        open_map: whether comparisons are without what a lead map may be (`lead_map`).
    """

    recording: Recording
    measured: dict[str, FloatArray]
    noise: dict[str, float]
    counted: BoolArray
    fitted: BoolArray
    edge: float
    block: float
    thinning: int
    floating: tuple[str, ...]
    model_error: dict[str, float]
    lost: BoolArray | None = field(default=None, kw_only=True)
    left: dict[str, float] = field(default_factory=dict, kw_only=True)
    open_map: bool = field(default=False, kw_only=True)

    @property
    def channels(self) -> tuple[str, ...]:
        """Channels that are compared."""
        return tuple(self.measured)

    @property
    def motion_speed(self) -> FloatArray:
        """Speed that tells kinds of motion apart, (n,); 0 where no motion is known."""
        return np.zeros(len(self.counted))

    @property
    def fit_rows(self) -> BoolArray:
        """Samples that count and are fitted."""
        return self.counted & self.fitted

    @property
    def judged_rows(self) -> BoolArray:
        """Samples that count and are not fitted."""
        return self.counted & ~self.fitted

    def thinned(self, rows: BoolArray) -> BoolArray:
        """Those of these samples that carry all that is in the band."""
        comb = np.zeros(len(rows), dtype=bool)
        comb[:: self.thinning] = True
        return rows & comb

    def weighted(self, series: dict[str, FloatArray], rows: BoolArray) -> FloatArray:
        """Channels at some samples over their noise, without what their sensors leave open, one after the other.

        Args:
            series: channel to measurement, prediction or their difference, (n,) each.
            rows: the samples, (n,).
        """
        every = self.thinning if np.count_nonzero(rows[:: self.thinning]) == np.count_nonzero(rows) else 1
        asked = rows[::every]
        return np.concatenate(
            [self.without_open(name, self.evened(name, series[name], every)[asked], rows) for name in self.channels]
        )

    def in_band(self, series: FloatArray) -> FloatArray:
        """A series, (n,), as it shows in the comparison."""
        return series

    def thinly_in_band(self, series: FloatArray) -> FloatArray:
        """A series, (n,), as it shows in the comparison, at the samples that carry all of it; not at its ends."""
        return series[:: self.thinning]

    def known_to(self, name: str) -> float:
        """Rms of what the sensors add to a channel in the band."""
        return self.noise[name]

    def unit(self, name: str) -> float:
        """Error of a channel that counts as one: its noise, or more where more is left of it than any name explains."""
        return self.noise[name] * self.left.get(name, 1.0)

    def evened(self, name: str, series: FloatArray, every: int) -> FloatArray:
        """A channel, (n,), at every k-th sample, each frequency weighed by how well it is known there."""
        return series[::every]

    def without_open(self, name: str, part: FloatArray, rows: BoolArray) -> FloatArray:
        """One channel over its noise, (k,), without what its sensor leaves open: the zero of a scale."""
        part = part / self.unit(name)
        return part - np.mean(part) if name in self.floating else part

    def missed(self, name: str) -> float:
        """Rms of what the model itself may miss of a channel."""
        return self.model_error.get(name, 0.0)

    def weighs_as(self, other: Self) -> bool:
        """Whether samples weigh as much in another evidence of this recording."""
        return self.left == other.left

    @property
    def map_parts(self) -> list[dict[str, FloatArray]]:
        """Series of all channels, (n,) each, that a lead map may be."""
        return []

    def with_map(self, is_open: bool) -> Self:
        """The evidence without what a lead map may be, where it is open; else all of it counts."""
        return self

    def with_curves(self, curves: dict[str, list[dict[str, FloatArray]]]) -> Self:
        """The evidence without what other forms of these laws may make of it; all of it counts where there are none."""
        return self

    @property
    def curves(self) -> dict[str, list[dict[str, FloatArray]]]:
        """Law to the series of all channels, (n,) each, of its other forms, which comparisons are without."""
        return {}

    @property
    def whole(self) -> Self:
        """The evidence with the samples again that a free play left unpredictable."""
        return self if self.lost is None else replace(self, counted=self.counted | self.lost, lost=None)

    def where_predictable(self, predictable: BoolArray | FloatArray) -> Self:
        """The whole evidence without the samples that cannot be predicted, (n,): false, or of weight 0."""
        whole = self.whole
        lost = whole.counted & ~(predictable > 0)
        return replace(whole, counted=whole.counted & ~lost, lost=lost) if lost.any() else whole

    def within(self, other: Self) -> Self:
        """The evidence on the samples that another one of this recording has as well."""
        gone = self.counted & ~other.counted
        lost = gone if self.lost is None else gone | self.lost
        kept = replace(self, counted=self.counted & other.counted, lost=lost) if gone.any() else self
        names = (*self.left, *other.left)
        left = {name: max(self.left.get(name, 1.0), other.left.get(name, 1.0)) for name in names}
        return kept if left == self.left else replace(kept, left=left)

    def beside(self, other: Self) -> Self:
        """The evidence on the samples alone that another one of this recording does not have."""
        return replace(self, counted=self.counted & ~other.counted)


@dataclass(frozen=True, eq=False)
class AxisEvidence(Evidence):
    """A recording of motion and torque.

    Attributes:
        motion: of the motor.
        band: of the comparison.
        scaled_from: channel that the motor torque is only proportional to; empty where the torque is known.
        zero: table position where the motor angle is zero [m], for a chain that depends on it; 0 where it is not known.
        gains: channel to the gain of each frequency of its whole series, where the encoder's error shows in it.
        added: channel to the rms in the band that the encoder's error adds to its noise; as `gains`.
        drawn: motions with the encoder's error once more; as `gains`.
        weights: channel to the weight of every sample, (n,): noise over noise and what the encoder's error makes of a
            free play there; channels left out are predicted alike everywhere.
        told: part of the motion that the torque tells and the encoder does not, (n,) [rad]; None for none.
        lead_map: what a lead map may be of the table position, in the band, (n, k); None without a table position.
        law_curves: as `curves`.
        unsure: channel to what motion that may not be makes of it, in the band, (n, k); as `gains`.
        acting: torque as it acts at the rows, of all frequencies, (n,) [N m]; None where it is not known.
        torque_rows: rows that the recorder writes a torque for, and the first row of one (`suspicion.logged_rows`);
            None where the torque is what the drive holds.
    """

    motion: MotorMotion
    band: Band
    scaled_from: str = ""
    zero: float = 0.0
    gains: dict[str, FloatArray] = field(default_factory=dict)
    added: dict[str, float] = field(default_factory=dict)
    drawn: tuple[MotorMotion, ...] = ()
    unsure: dict[str, FloatArray] = field(default_factory=dict)
    acting: FloatArray | None = None
    torque_rows: tuple[int, int] | None = None
    weights: dict[str, FloatArray] = field(default_factory=dict)
    lead_map: FloatArray | None = None
    law_curves: dict[str, list[dict[str, FloatArray]]] = field(default_factory=dict)
    told: FloatArray | None = None

    def where_predictable(self, predictable: BoolArray | FloatArray) -> Self:
        """The evidence without the samples of weight 0, the table position weighed at the others."""
        kept = super().where_predictable(predictable)
        if predictable.dtype == np.bool_ or "table_position" not in self.measured:
            return kept
        return replace(kept, weights={"table_position": np.asarray(predictable, dtype=float)})

    def within(self, other: Self) -> Self:
        """The evidence on the samples that another one of this recording has as well, by the lesser of the weights."""
        kept = super().within(other).with_map(self.open_map or other.open_map)
        kept = kept.with_curves({**other.curves, **self.curves})
        weights = {
            name: np.minimum(kept.weights.get(name, 1.0), other.weights.get(name, 1.0))
            for name in (*kept.weights, *other.weights)
        }
        return replace(kept, weights=weights) if weights and not self.weighs_as(other) else kept

    @property
    def whole(self) -> Self:
        """The evidence with the samples again that a free play left unpredictable, all of one weight."""
        whole = super().whole
        return replace(whole, weights={}) if whole.weights else whole

    def weighs_as(self, other: Self) -> bool:
        """Whether samples weigh as much in another evidence of this recording."""
        mine, its = self.weights, other.weights
        return (
            super().weighs_as(other)
            and self.open_map == other.open_map
            and self.curves.keys() == other.curves.keys()
            and all(self.curves[name] is other.curves[name] for name in self.curves)
            and mine.keys() == its.keys()
            and all(np.array_equal(mine[name], its[name]) for name in mine)
        )

    def without_open(self, name: str, part: FloatArray, rows: BoolArray) -> FloatArray:
        """One channel over its noise and by its weights, (k,), without the zero of a scale."""
        if name not in self.weights:
            return super().without_open(name, part, rows)
        weights = self.weights[name][rows]
        weighed = weights * part / self.unit(name)
        return weighed - weights * float(weights @ weighed / (weights @ weights)) if name in self.floating else weighed

    def in_band(self, series: FloatArray) -> FloatArray:
        """A series or columns, (n,), in the band of the comparison."""
        return self.band.filter(series)

    def thinly_in_band(self, series: FloatArray) -> FloatArray:
        """A series, (n,), in the band of the comparison, at the samples that carry all of it; not at its ends."""
        return self.band.thinned(series)

    def weighted(self, series: dict[str, FloatArray], rows: BoolArray) -> FloatArray:
        """Channels at some samples as any are, less what motion that is not known, or a lead map, may make of them."""
        weighted = super().weighted(series, rows)
        parts = self._open
        if not parts or not rows.any():
            return weighted
        key = rows.tobytes()
        if key not in self._sure:
            columns = np.column_stack([super(AxisEvidence, self).weighted(part, rows) for part in parts])
            self._sure[key] = whitener(columns, np.zeros(len(parts)), 1.0)
        return self._sure[key].applied(weighted)

    @cached_property
    def _open(self) -> list[dict[str, FloatArray]]:
        """Series of all channels, (n,) each, that a recording may hold, as far as a deviation of one goes."""
        count = next(iter(self.unsure.values())).shape[1] if self.unsure else 0
        parts = [{name: columns[:, i] for name, columns in self.unsure.items()} for i in range(count)]
        parts += [part for curve in self.law_curves.values() for part in curve]
        return [*parts, *self.map_parts] if self.open_map else parts

    @property
    def map_parts(self) -> list[dict[str, FloatArray]]:
        """Series of all channels, (n,) each, that a lead map may be."""
        none = dict.fromkeys(self.channels, np.zeros(len(self.counted)))
        return [] if self.lead_map is None else [{**none, "table_position": column} for column in self.lead_map.T]

    def with_map(self, is_open: bool) -> Self:
        """The evidence without what a lead map may be, where it is open; else all of it counts."""
        return replace(self, open_map=is_open) if is_open != self.open_map else self

    def with_curves(self, curves: dict[str, list[dict[str, FloatArray]]]) -> Self:
        """The evidence without what other forms of these laws may make of it; all of it counts where there are none."""
        return replace(self, law_curves=curves) if curves or self.law_curves else self

    @property
    def curves(self) -> dict[str, list[dict[str, FloatArray]]]:
        """Law to the series of all channels, (n,) each, of its other forms, which comparisons are without."""
        return self.law_curves

    @cached_property
    def _sure(self) -> dict[bytes, Whitener]:
        """What takes away what motion that is not known may make of a channel, by the samples."""
        return {}

    def known_to(self, name: str) -> float:
        """Rms of what sensor and encoder add to a channel in the band."""
        return math.hypot(self.noise[name], self.added.get(name, 0.0))

    def evened(self, name: str, series: FloatArray, every: int) -> FloatArray:
        """A channel, (n,), at every k-th sample, each frequency weighed by sensor noise over that and the encoder's."""
        if name not in self.gains:
            return series[::every]
        known = np.isfinite(series)
        inside = known & self._between_ends
        mean = float(np.mean(series[inside])) if inside.any() else 0.0  # apart, so that gaps do not make steps
        filled = np.where(inside, series - mean, 0.0)
        if inside.any():  # nor does a slow error end in one
            first, last = np.flatnonzero(inside)[[0, -1]]
            filled[:first], filled[last + 1 :] = filled[first], filled[last]
        key = (name, every)
        if key not in self._weighing:
            self._weighing[key] = Weighing.of(self.gains[name], len(self.counted), every)
        weighed = self._weighing[key](filled)
        return np.where(known[::every], weighed + self.gains[name][0] * mean, series[::every])

    @cached_property
    def _between_ends(self) -> BoolArray:
        """Samples from the first that counts to the last, (n,).

        A simulation begins at rest without stretch: what it does until that is forgotten would be carried on.
        """
        counted = self.counted if self.lost is None else self.counted | self.lost
        inside: BoolArray = np.logical_or.accumulate(counted) & np.logical_or.accumulate(counted[::-1])[::-1]
        return inside

    @cached_property
    def _weighing(self) -> dict[tuple[str, int], Weighing]:
        """By channel and every how many samples are asked for."""
        return {}

    def placed(self, plant: Plant) -> Plant:
        """The plant with its nut where it stood: simulated positions count from the zero of the motor angle."""
        return _placed(plant, self.zero)

    def at_other_times(self, recording: Recording) -> AxisEvidence:
        """The evidence as it is where the same rows have other times: what changes is the motion between them."""
        angle = recording["motor_angle"]
        if self.gains:
            angle = known_motion_of(angle, quantisation_step(angle), recording.sample_time)[0]
            angle = angle if self.told is None else angle + self.told
        motion = motor_motion(_from_zero(recording), angle).timed(clock(recording))
        return replace(self, recording=recording, motion=motion)

    @property
    def motion_speed(self) -> FloatArray:
        """Speed of the motor [rad/s], (n,)."""
        return self.motion.speed[self.motion.samples]

    def with_scale(self, scale: float) -> AxisEvidence:
        """The evidence with its motor torque times `scale`."""
        name = "motor_torque"
        channels = {**self.recording.channels, name: scale * self.recording[name]}
        measured = {**self.measured, name: scale * self.measured[name]}
        noise = {**self.noise, name: abs(scale) * self.noise[name]}
        added = {**self.added, name: abs(scale) * self.added[name]} if name in self.added else self.added
        unsure = {**self.unsure, name: scale * self.unsure[name]} if self.unsure else {}
        recording = replace(self.recording, channels=channels)
        return replace(self, recording=recording, measured=measured, noise=noise, added=added, unsure=unsure)


def prepare(recording: Recording, plant: Plant, share: float, hold: float | None = None) -> AxisEvidence:
    """Evidence of a recording, its first `share` fitted and the rest judged, or what was kept apart of it for that.

    Args:
        recording: with a torque, a current or the table position beside the motor angle.
        plant: whose lead and band apply.
        share: 1 to fit on all of it, 0 to judge on all of it.
        hold: how long the drive holds a torque [s]; None for a whole row, and for no time where rows are slow.

    Raises:
        InputError: too short, or channels that are needed are missing.
    """
    recording = without_copied_position(_with_motor_angle(recording, plant), plant)
    recording, scaled_from = with_torque(recording, plant)
    measured_names = [name for name in PREDICTED if name in recording]
    if not measured_names:
        mend = "record the motor torque or current, or the table position beside the motor angle"
        raise InputError("nothing that the motor's motion predicts", recording.name, mend)
    if recording.duration < SHORTEST:
        mend = f"record at least {SHORTEST:g} s"
        raise InputError(f"the recording lasts {recording.duration:.3g} s, too short to compare", recording.name, mend)
    rate = 1 / recording.sample_time
    band = comparison_band(plant, rate)
    time = _from_zero(recording)
    raw = {name: recording[name] for name in measured_names}
    slow = is_slow(recording)
    acting = dict(raw)
    if "motor_torque" in raw and hold is not None:
        acting["motor_torque"] = lagging(raw["motor_torque"], hold / 2, recording.sample_time)
    elif "motor_torque" in raw and not slow:
        acting["motor_torque"] = held(raw["motor_torque"])
    counted = (time >= END_CUT) & (time <= time[-1] - END_CUT)
    if slow:
        known = known_motion(recording, plant, band)
        refuse_unknown_motion(known, counted, recording)
        recording = replace(recording, notes=(*recording.notes, sentence(known, recording)))
        counted &= known
    elif hold is not None:  # the loop is faster than the rows: what it does between them is not known either
        counted &= known_motion(recording, plant, band)
    counted &= sound_rows(recording, plant.torque_limit, band)
    refuse_little_left(counted, recording)
    sensed = dict(raw)
    if "motor_torque" in raw and "injected_torque" in recording and not scaled_from:
        # the jumps of an injected binary sequence are no noise of the torque's sensor
        sensed["motor_torque"] = raw["motor_torque"] - recording["injected_torque"]
    own = recorded(recording)
    noise = {name: sensor_noise(series[own], band) for name, series in sensed.items()}
    for name, series in sensed.items():
        if noise[name] < NO_SENSOR * float(np.ptp(series)):
            noise[name] = math.hypot(noise[name], missed_between_rows(recording, plant, counted).get(name, 0.0))
    zero = _zero_of_angle(recording, plant)
    measured = {name: band.filter(series) for name, series in acting.items()}
    # what is judged is not to lend its torque to the motion that it is judged by
    telling = measured.get("motor_torque") if share > 0 else None
    encoder = encoder_error(_placed(plant, zero), recording, band, noise, bool(scaled_from), telling)
    motion = encoder.motion if encoder is not None else motor_motion(time, recording["motor_angle"])
    return AxisEvidence(
        recording,
        measured,
        noise,
        counted,
        _fitted(recording, share),
        band.edge,
        BLOCK,
        band.thinning,
        tuple(name for name in measured_names if name == "table_position"),
        {s.channel: s.model_error for s in plant.sensors if s.model_error > 0 and s.channel in measured_names},
        motion.timed(clock(recording)),
        band,
        scaled_from,
        zero,
        encoder.gains if encoder is not None else {},
        encoder.added if encoder is not None else {},
        encoder.drawn if encoder is not None else (),
        encoder.unsure if encoder is not None else {},
        acting=acting.get("motor_torque") if not scaled_from else None,
        told=encoder.told if encoder is not None else None,
        lead_map=band.filter(lead_map(raw["table_position"], plant.chain.radius)) if "table_position" in raw else None,
    )


def weighed_by(evidence: Evidence, plant: Plant) -> Evidence:
    """The evidence with the encoder's error as a plant shows it: at its resonances, not at those of the declared one.

    Args:
        evidence: prepared for the declared plant.
        plant: nearer to the machine.
    """
    if not isinstance(evidence, AxisEvidence) or not evidence.gains or evidence.scaled_from:
        return evidence
    telling = evidence.measured.get("motor_torque") if evidence.fitted.any() else None
    encoder = encoder_error(
        _placed(plant, evidence.zero), evidence.recording, evidence.band, evidence.noise, acting=telling
    )
    if encoder is None:
        return evidence
    motion = encoder.motion.timed(clock(evidence.recording))
    weighed = replace(evidence, gains=encoder.gains, added=encoder.added, unsure=encoder.unsure)
    return replace(weighed, motion=motion, told=encoder.told, drawn=encoder.drawn)


def _from_zero(recording: Recording) -> FloatArray:
    """Times of the rows from the first on [s], (n,), as many periods of the clock as there are rows between."""
    time: FloatArray = np.arange(len(recording), dtype=np.float64) * recording.sample_time
    return time


def _fitted(recording: Recording, share: float) -> BoolArray:
    """Samples that are fitted, (n,)."""
    if share >= 1 or share <= 0:
        return np.full(len(recording), share >= 1)
    if recording.kept_apart is not None:
        return ~recording.kept_apart
    time = np.arange(len(recording)) * recording.sample_time
    found: BoolArray = time < share * time[-1]
    return found


def _placed(plant: Plant, zero: float) -> Plant:
    """The plant with its nut a way [m] further along."""
    return plant.with_chain_values(plant.chain.nut_moved(zero)) if zero else plant


def _zero_of_angle(recording: Recording, plant: Plant) -> float:
    """Table position where the motor angle is zero [m], for a chain that depends on where the table stands.

    Raises:
        InputError: the nut would not be on the screw.
    """
    if not plant.chain.varies:
        return 0.0
    turned = plant.chain.motor_radius * recording["motor_angle"]
    measured = "table_position" in recording
    zero = float(np.median(recording["table_position"] - turned)) if measured else 0.0
    for position in (float(np.min(turned)) + zero, float(np.max(turned)) + zero):
        try:
            plant.chain.refuse_off_screw(position, recording.name)
        except InputError as error:
            mend = "record table_position, or shift motor_angle so that it is zero where the table is at 0"
            if measured:
                mend = "check zero and unit of table_position, and first_nut_position of the plant"
            raise InputError(error.what, recording.name, mend) from None
    return zero if abs(zero) > LEAST_ZERO else 0.0


def _with_motor_angle(recording: Recording, plant: Plant) -> Recording:
    """The recording with a motor angle: where there is no motor encoder, the table stands in for it."""
    if "motor_angle" in recording:
        return recording
    if "table_position" not in recording:
        raise InputError("neither motor_angle nor table_position", recording.name, "record one of them")
    if plant.chain.elastic:
        mend = 'record the motor angle, or declare the plant with structure = "rigid"'
        raise InputError("no channel motor_angle, and the plant is elastic", recording.name, mend)
    channels = dict(recording.channels)
    channels["motor_angle"] = channels.pop("table_position") / plant.chain.motor_radius
    note = "no motor encoder: the motor angle is taken from the table position"
    return replace(recording, channels=channels, notes=(*recording.notes, note))
