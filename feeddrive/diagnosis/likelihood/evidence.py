"""A recording ready for comparison: measured channels, their noise, and which samples count."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from feeddrive.recording import Recording
from feeddrive.typing import BoolArray, FloatArray

UNSEEN = 0.1
"""Deviations of the noise by which something moves all rows together, below which they do not see it. The interval of a
value within its tolerance that moves them by so much would be narrower than that by half a per cent; and no fitted
value is moved by more of its deviations."""


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
        kept: channel to the mean square of weighted rows that hold nothing but noise of the stated level, where some
            frequencies count for little; 1 for a channel that is left out.
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
    kept: dict[str, float] = field(default_factory=dict, kw_only=True)

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

    @property
    def at_draws(self) -> tuple[Self, ...]:
        """The recording on motions that its encoder would have told as well; none where it tells the motion itself."""
        return ()

    def weighted(self, series: dict[str, FloatArray], rows: BoolArray) -> FloatArray:
        """Channels at some samples over their noise, without what their sensors leave open, one after the other.

        Args:
            series: channel to measurement, prediction or their difference, (n,) each.
            rows: the samples, (n,).
        """
        every = self.every(rows)
        return self.over_noise(self.all_evened(series, every), rows, every)

    def every(self, rows: BoolArray) -> int:
        """Every how many samples hold some of them all, (n,): `thinning`, or 1."""
        return self.thinning if np.count_nonzero(rows[:: self.thinning]) == np.count_nonzero(rows) else 1

    def all_evened(self, series: dict[str, FloatArray], every: int) -> dict[str, FloatArray]:
        """Channels at every k-th sample, as `evened`."""
        return {name: self.evened(name, series[name], every) for name in self.channels}

    def over_noise(self, evened: dict[str, FloatArray], rows: BoolArray, every: int) -> FloatArray:
        """Channels at every k-th sample as they count at some samples, one after the other."""
        asked = rows[::every]
        return np.concatenate([self.without_open(name, evened[name][asked], rows) for name in self.channels])

    def in_band(self, series: FloatArray) -> FloatArray:
        """A series, (n,), as it shows in the comparison."""
        return series

    def thinly_in_band(self, series: FloatArray) -> FloatArray:
        """A series, (n,), as it shows in the comparison, at the samples that carry all of it; not at its ends."""
        return series[:: self.thinning]

    def rounded(self, name: str) -> float:
        """Rms of what rounding to steps makes of a channel that comes again, in its unit; 0 where nothing does."""
        return 0.0

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
