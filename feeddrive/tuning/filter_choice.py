"""Filters of the torque command as a drive has them: what may be set, and how a filter is chosen and moved within that.

    octave    f_u - f_l = B,  f_u f_l = f^2  at -3 dB of a deep notch, so  f_u = 2 f_l  at  B = f / sqrt(2)

| symbol | meaning | unit |
|---|---|---|
| f, B | frequency and bandwidth of a notch | Hz |
| f_l, f_u | its -3 dB points | Hz |

A notch wider than an octave no longer sits at a resonance: below its frequency it is a low-pass, and a low-pass of the
same denominator does what it does there and goes on falling above.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from feeddrive.servo.filters import Filter, notch, pt2

WIDEST_NOTCH = 1 / math.sqrt(2)
"""Bandwidth over frequency of a notch an octave wide."""

_WIDTHS, _DEPTHS = (0.25, 0.5, WIDEST_NOTCH), (10.0, 20.0)
_USUAL_DAMPING = 0.7


@dataclass(frozen=True)
class FilterLimits:
    """What filters of the torque command a drive has.

    Attributes:
        most: filters.
        notch, low_pass: whether it has notches and low-passes of second order.
        frequency: least and greatest frequency [Hz].
        damping: least and greatest damping of a denominator [1]; of a notch it is bandwidth / (2 frequency).
        depth: least and greatest depth of a notch [dB]; both infinite where it has complete notches alone.
        whole_hertz: whether frequencies are whole numbers.
    """

    most: int = 3
    notch: bool = True
    low_pass: bool = True
    frequency: tuple[float, float] = (1.0, 8000.0)
    damping: tuple[float, float] = (0.01, 1.0)
    depth: tuple[float, float] = (3.0, 40.0)
    whole_hertz: bool = field(default=False)

    def frequency_within(self, value: float) -> float:
        """The frequency [Hz] that can be set, three digits, nearest to a value."""
        low, high = self.frequency
        rounded = float(f"{min(max(value, low), high):.3g}")
        return float(round(rounded)) if self.whole_hertz else rounded

    def damping_within(self, value: float) -> float:
        """The damping that can be set, three digits, nearest to a value."""
        low, high = self.damping
        return min(max(float(f"{value:.3g}"), low), high)

    def depth_within(self, value: float) -> float:
        """The depth [dB] that can be set, in tenths, nearest to a value."""
        low, high = self.depth
        return min(max(round(value, 1), low), high)


NO_LIMITS = FilterLimits()
"""Filters of a drive that is not known: three filters, notch or low-pass."""


@dataclass(frozen=True)
class FilterChoice:
    """A filter of the torque command and what it brings.

    Attributes:
        kind: "notch" or "PT2".
        frequency: of the notch, or natural frequency of the low-pass [Hz].
        damping: of the denominator [1].
        depth: of a notch [dB]; infinite for a complete one and for a low-pass.
        resonance: least and greatest natural frequency of the resonance over the cases [Hz]; None where none limits.
        brings: factor of the integral gain that it allows.
    """

    kind: str
    frequency: float
    damping: float
    depth: float = math.inf
    resonance: tuple[float, float] | None = None
    brings: float = 1.0

    @property
    def bandwidth(self) -> float:
        """Width of a notch between its -3 dB points [Hz]."""
        return 2 * self.damping * self.frequency

    @property
    def filter(self) -> Filter:
        """As the cascade takes it."""
        if self.kind == "PT2":
            return pt2(self.frequency, self.damping)
        return notch(self.frequency, self.bandwidth, self.depth)

    def varied(self, step: float, limits: FilterLimits) -> Iterator[FilterChoice]:
        """The filter with one value larger or smaller by a share, within the limits of the drive."""
        for factor in (1 + step, 1 / (1 + step)):
            yield replace(self, frequency=limits.frequency_within(self.frequency * (1 + (factor - 1) / 2)))
            damping = limits.damping_within(self.damping * factor**2)
            yield replace(self, damping=min(damping, WIDEST_NOTCH / 2) if self.kind == "notch" else damping)
            if self.kind == "notch" and math.isfinite(self.depth):
                yield replace(self, depth=limits.depth_within(self.depth * factor**2))


def notches_about(spread: tuple[float, float], limits: FilterLimits) -> list[FilterChoice]:
    """Notches about a resonance that lies between two frequencies [Hz], gentle ones first; none if the drive has none.

    None is wider than an octave: where the drive allows no narrower one there is none.
    """
    if not limits.notch or limits.damping[0] > WIDEST_NOTCH / 2:
        return []
    centre = limits.frequency_within(math.sqrt(spread[0] * spread[1]))
    depths = dict.fromkeys(limits.depth_within(depth) for depth in _DEPTHS)
    made = []
    for depth in depths:
        for width in _WIDTHS:
            bandwidth = min(max(width * centre, 1.5 * (spread[1] - spread[0])), WIDEST_NOTCH * centre)
            damping = min(limits.damping_within(0.5 * bandwidth / centre), WIDEST_NOTCH / 2)
            made.append(FilterChoice("notch", centre, damping, depth, spread))
    return list(dict.fromkeys(made))


def low_pass(frequency: float, limits: FilterLimits) -> FilterChoice | None:
    """A low-pass of second order [Hz]; None where the drive has none."""
    if not limits.low_pass:
        return None
    return FilterChoice("PT2", limits.frequency_within(frequency), limits.damping_within(_USUAL_DAMPING))


def is_low_pass(frequency: float, bandwidth: float) -> bool:
    """Whether a notch [Hz, Hz] is wider than an octave, and so a low-pass."""
    return bandwidth > WIDEST_NOTCH * frequency * (1 + 1e-9)
