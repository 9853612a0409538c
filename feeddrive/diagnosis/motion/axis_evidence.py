"""A recording of motion and torque, ready for comparison beside its encoder's error, a lead map and laws' curves."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self

import numpy as np

from feeddrive.diagnosis.calibration.calibration import Whitener, whitener
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.motion.band import Band
from feeddrive.diagnosis.motion.encoder_error import EncoderError, known_motion_of
from feeddrive.diagnosis.motion.rounding import Rounding
from feeddrive.diagnosis.motion.weighing import Weighing
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.recording.checks.flaws import quantisation_step
from feeddrive.recording.long.joined import clock
from feeddrive.simulate.driven import FlankRests, MotorMotion, motor_motion
from feeddrive.typing import BoolArray, FloatArray

Channels = tuple[dict[str, FloatArray], ...]
"""Series of channels, several times."""


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
        unsure: of every part of the motion that may not be, channel to what that makes of it, in the band, (n,); as
            `gains`.
        between_rows: of what a drive may do between two rows, channel to what that makes of it, in the band, (n,)
            (`motion.between_rows`).
        rounding: what the steps of the torque may make of it; None where they make nothing that comes again.
        acting: torque as it acts at the rows, of all frequencies, (n,) [N m]; None where it is not known.
        torque_rows: rows that the recorder writes a torque for, and the first row of one (`suspicion.logged_rows`);
            None where the torque is what the drive holds.
        rests: where the load is seen to ride on a flank; None where it is not.
        bouncing: samples at which it has left a flank and not come to rest again, (n,); None as `rests`.
        evened_unsure: `unsure` and `rounding` as `evened`, by every how many samples and from which to which: as long
            to make as tens of predictions, and the same for all evidence with one encoder's error.
    """

    motion: MotorMotion
    band: Band
    scaled_from: str = ""
    zero: float = 0.0
    gains: dict[str, FloatArray] = field(default_factory=dict)
    added: dict[str, float] = field(default_factory=dict)
    drawn: tuple[MotorMotion, ...] = ()
    unsure: Channels = ()
    between_rows: Channels = ()
    rounding: Rounding | None = None
    acting: FloatArray | None = None
    torque_rows: tuple[int, int] | None = None
    weights: dict[str, FloatArray] = field(default_factory=dict)
    lead_map: FloatArray | None = None
    law_curves: dict[str, list[dict[str, FloatArray]]] = field(default_factory=dict)
    told: FloatArray | None = None
    rests: FlankRests | None = None
    bouncing: BoolArray | None = None
    evened_unsure: dict[tuple[int, int, int], Channels] = field(default_factory=dict, repr=False)

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
        has_map = self.open_map and self.lead_map is not None and self.lead_map.shape[1] > 0
        is_open = bool(self.unsure or self.between_rows or self.rounding or any(self.law_curves.values()) or has_map)
        if not is_open or not rows.any():
            return weighted
        key = rows.tobytes()
        if key not in self._sure:
            every = self.every(rows)
            columns = np.column_stack([self.over_noise(part, rows, every) for part in self._open(every)])
            self._sure[key] = whitener(columns, np.zeros(columns.shape[1]), 1.0)
        return self._sure[key].applied(weighted)

    def _open(self, every: int) -> Channels:
        """Series of all channels, as `evened`, that a recording may hold, as far as a deviation of one goes."""
        key = every, self._ends.start, self._ends.stop
        if key not in self.evened_unsure:
            self.evened_unsure[key] = tuple(self.all_evened(part, every) for part in (*self.unsure, *self._rounded()))
        others = [part for curve in self.law_curves.values() for part in curve]
        others += self.map_parts if self.open_map else []
        others += self.between_rows
        return *self.evened_unsure[key], *(self.all_evened(part, every) for part in others)

    def _rounded(self) -> Iterator[dict[str, FloatArray]]:
        """Series of all channels, (n,) each, that the steps of a torque may make."""
        none = dict.fromkeys(self.channels, np.zeros(len(self.counted)))
        for part in self.rounding.parts() if self.rounding else ():
            yield {**none, "motor_torque": self.in_band(part)}

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

    def rounded(self, name: str) -> float:
        """Rms of what rounding to steps makes of a channel that comes again, in its unit; 0 where nothing does."""
        return self.rounding.size if self.rounding and name == "motor_torque" else 0.0

    def evened(self, name: str, series: FloatArray, every: int) -> FloatArray:
        """A channel, (n,), at every k-th sample, each frequency weighed by sensor noise over that and the encoder's.

        Every k-th sample carries all that is in the band, and so all that is weighed.
        """
        thin = series[::every]
        if name not in self.gains:
            return thin
        ends, known = self._ends_at(every), np.isfinite(thin)
        gaps = not known.all()
        if gaps:
            ends = _reach(self._between_ends[::every] & known)
        inner, there = thin[ends], known[ends]
        mean = float(np.mean(inner[there])) if there.any() else 0.0  # apart, so that gaps do not make steps
        filled = np.zeros(len(thin))
        filled[ends] = np.where(there, inner - mean, 0.0)
        if len(inner):  # nor does a slow error end in one
            filled[: ends.start], filled[ends.stop :] = filled[ends.start], filled[ends.stop - 1]
        weighed = self._weighing(name, every)(filled)
        weighed += self.gains[name][0] * mean
        return np.where(known, weighed, thin) if gaps else weighed

    def beside_misfit(self, name: str, square: float) -> Self:
        """The evidence with a channel whose frequencies weigh by its noise and a misfit of laws, white in the band.

        Args:
            name: of a channel that has gains.
            square: mean square of the misfit, in the channel's unit squared.
        """
        more = square / self.noise[name] ** 2
        gains = self.gains[name] * np.sqrt((1 + more) / (1 + more * self.gains[name] ** 2))
        return replace(self, gains={**self.gains, name: gains})

    def _weighing(self, name: str, every: int) -> Weighing:
        """Gains of a channel for its series at every k-th sample."""
        key = (name, every)
        if key not in self._weighings:
            count = len(self.counted)
            thin = -(-count // every)
            frequencies = np.arange(thin // 2 + 1) / (thin * every)
            gains = np.interp(frequencies, np.arange(count // 2 + 1) / count, self.gains[name])
            self._weighings[key] = Weighing.of(gains, thin)
        return self._weighings[key]

    def _ends_at(self, every: int) -> slice:
        """Of every k-th sample those from the first that counts to the last."""
        return self._ends if every == 1 else _reach(self._between_ends[::every])

    @cached_property
    def _ends(self) -> slice:
        """Rows from the first sample that counts to the last."""
        return _reach(self._between_ends)

    @cached_property
    def _between_ends(self) -> BoolArray:
        """Samples from the first that counts to the last, (n,).

        A simulation begins at rest without stretch: what it does until that is forgotten would be carried on.
        """
        counted = self.counted if self.lost is None else self.counted | self.lost
        inside: BoolArray = np.logical_or.accumulate(counted) & np.logical_or.accumulate(counted[::-1])[::-1]
        return inside

    @cached_property
    def _weighings(self) -> dict[tuple[str, int], Weighing]:
        """By channel and every how many samples are asked for."""
        return {}

    def placed(self, plant: Plant) -> Plant:
        """The plant with its nut where it stood: simulated positions count from the zero of the motor angle."""
        return placed(plant, self.zero)

    def with_encoder(self, encoder: EncoderError | None) -> Self:
        """The evidence as an error of the encoder shows in it; None for one that does not show."""
        if encoder is None:
            return self
        motion, *drawn = (one.timed(clock(self.recording)) for one in (encoder.motion, *encoder.drawn))
        weighed = replace(self, gains=encoder.gains, added=encoder.added, unsure=encoder.unsure, evened_unsure={})
        told = replace(weighed, motion=motion, told=encoder.told, drawn=tuple(drawn), kept=encoder.kept)
        return told.in_steps(self.motion.every)

    @property
    def at_draws(self) -> tuple[Self, ...]:
        """The recording on the motions that are drawn."""
        return tuple(replace(self, motion=motion) for motion in self.drawn)

    def in_steps(self, every: int) -> Self:
        """The evidence with its motion simulated in steps of so many rows."""
        if every == self.motion.every:
            return self
        motion, *drawn = (replace(one, every=every) for one in (self.motion, *self.drawn))
        return replace(self, motion=motion, drawn=tuple(drawn))

    def at_other_times(self, recording: Recording) -> AxisEvidence:
        """The evidence as it is where the same rows have other times: what changes is the motion between them."""
        angle = recording["motor_angle"]
        if self.gains:
            angle = known_motion_of(angle, quantisation_step(angle), recording.sample_time)
            angle = angle if self.told is None else angle + self.told
        whole = 1 if self.motion.every > 1 else None  # of steps of several rows none is made of a part of one
        motion = motor_motion(from_zero(recording), angle, whole).timed(clock(recording))
        drawn = tuple(one.timed(clock(recording)) for one in self.drawn)
        return replace(self, recording=recording, motion=replace(motion, every=self.motion.every), drawn=drawn)

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
        unsure = tuple({**part, name: scale * part[name]} for part in self.unsure)
        recording = replace(self.recording, channels=channels)
        scaled = replace(self, recording=recording, measured=measured, noise=noise, added=added)
        between = tuple({**part, name: scale * part[name]} for part in self.between_rows)
        return replace(scaled, unsure=unsure, between_rows=between, evened_unsure={})


def _reach(rows: BoolArray) -> slice:
    """From the first of some samples to the last; of none where there are none."""
    at = np.flatnonzero(rows)
    return slice(int(at[0]), int(at[-1]) + 1) if len(at) else slice(0, 0)


def placed(plant: Plant, zero: float) -> Plant:
    """The plant with its nut a way [m] further along."""
    return plant.with_chain_values(plant.chain.nut_moved(zero)) if zero else plant


def from_zero(recording: Recording) -> FloatArray:
    """Times of the rows from the first on [s], (n,), as many periods of the clock as there are rows between."""
    time: FloatArray = np.arange(len(recording), dtype=np.float64) * recording.sample_time
    return time
