"""Figures about the life of a ball screw: Weibull plot, load along the nut, life used along a recording."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.parts.life.consumed_life import ConsumedLife
from feeddrive.parts.life.weibull import RATED_FAILURE, LifeSample, WeibullLaw, likelihood_fit, median_ranks
from feeddrive.parts.life.weibull_interval import life_interval, slope_interval
from feeddrive.parts.screw.load_distribution import LoadDistribution
from feeddrive.report.figures.drawing import (
    AFTER,
    BEFORE,
    MEASURED,
    NOISE,
    ReportFigure,
    dress,
    legend_above,
    new_figure,
)
from feeddrive.report.words.people import significant
from feeddrive.typing import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_TICKS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9, 0.99)
_SHARES = (0.01, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 0.95, 0.99)
"""Failed shares at which the band is computed."""

_COLOURS = (AFTER, BEFORE, MEASURED, NOISE)


def weibull_figure(sample: LifeSample, unit: str = "rev", level: float = 0.9) -> ReportFigure:
    """Failures of a life test in Weibull paper, the law of maximum likelihood and the band of its lives.

    Args:
        sample: lives of the test.
        unit: in which they are counted.
        level: confidence of the band, point by point, by the likelihood ratio.

    Raises:
        InputError: a sample that has no fit.
    """
    law, slope = likelihood_fit(sample), slope_interval(sample, level)
    bounds = [life_interval(sample, share, level) for share in _SHARES]
    rated = bounds[_SHARES.index(RATED_FAILURE)]
    figure = new_figure(4.6)
    axes = figure.subplots()
    low, high = _finite([one.low for one in bounds]), _finite([one.high for one in bounds])
    heights = _weibull_height(np.array(_SHARES))
    axes.fill_betweenx(heights, low, high, color=AFTER, alpha=0.15, lw=0, label=f"{level:.0%} band")
    axes.plot([law.life(share) for share in _SHARES], heights, color=AFTER, lw=1.4, label="maximum likelihood")
    lives, ranks = median_ranks(sample)
    axes.plot(lives, _weibull_height(ranks), "o", color=MEASURED, ms=4.5, label="failures at median ranks")
    _suspensions(axes, sample.suspended)
    _weibull_axes(axes, law, unit)
    axes.plot([rated.low, rated.high], [_weibull_height(np.array([RATED_FAILURE]))[0]] * 2, color=BEFORE, lw=2.2,
              label="L10")  # fmt: skip
    legend_above(axes, 5)
    caption = (
        f"{sample.failures} failures of {sample.size} specimens. Slope {significant(law.slope, 2)} "
        f"({significant(slope.low, 2)} to {significant(slope.high, 2)}), L10 {significant(rated.estimate)} {unit} "
        f"({significant(rated.low)} to {significant(rated.high)} {unit}); intervals of {level:.0%} by the likelihood "
        "ratio. A suspended specimen counts as whole up to its mark."
    )
    return ReportFigure("weibull", "Life test in Weibull paper", caption, figure)


def load_distribution_figure(distributions: Sequence[tuple[str, LoadDistribution]]) -> ReportFigure:
    """Loads of the balls along the nut over their mean.

    Args:
        distributions: label and loads, up to four; the first ball is that at the end from which the screw is pulled.
    """
    figure = new_figure(3.4)
    axes = figure.subplots()
    texts = []
    for (label, loads), colour in zip(distributions, _COLOURS, strict=False):
        share = loads.relative
        along = (np.arange(share.size) + 0.5) / share.size
        axes.plot(along, share, ".-", color=colour, ms=4, lw=1.0, label=label)
        texts.append(f"{label} {share.max():.2f}")
    axes.axhline(1.0, color=NOISE, lw=0.9, ls="--")
    dress(axes, "place along the nut, from the loaded end [1]", "ball load over mean [1]")
    axes.set_xlim(0.0, 1.0)
    legend_above(axes)
    caption = (
        "Every dot is a ball. Screw and nut body give way, so that the balls next to the force carry more: greatest "
        f"over mean {', '.join(texts)}. Errors of lead and balls come on top."
    )
    return ReportFigure("nut_load_distribution", "Load along the nut", caption, figure)


def consumed_life_figure(time: FloatArray, nut_forces: FloatArray, used: ConsumedLife) -> ReportFigure:
    """Load of every nut along a recording, and the share of its rated life used.

    Args:
        time: (n,) [s].
        nut_forces: (nuts, n) [N].
        used: of the same recording.
    """
    figure = new_figure(4.6)
    upper, lower = figure.subplots(2, 1, sharex=True)
    factor, force_unit = (1e-3, "kN") if float(np.max(nut_forces)) >= 2e3 else (1.0, "N")
    scale, share_unit = _share_scale(used)
    for nut, (forces, share) in enumerate(zip(nut_forces, used.used, strict=True)):
        label, colour = f"nut {'AB'[nut] if nut < 2 else nut + 1}", _COLOURS[nut % len(_COLOURS)]
        upper.plot(time, factor * forces, color=colour, lw=0.9, label=label)
        lower.plot(time, scale * share, color=colour, lw=1.4, label=label)
    dress(upper, "", f"axial load [{force_unit}]")
    dress(lower, "time [s]", f"rated life used [{share_unit}]")
    upper.set_ylim(bottom=0.0)
    lower.set_ylim(bottom=0.0)
    legend_above(upper)
    figure.align_ylabels([upper, lower])
    return ReportFigure("consumed_life", "Life used along the recording", _life_caption(used), figure)


def _life_caption(used: ConsumedLife) -> str:
    turned = f"{significant(float(used.revolutions[-1]))} revolutions"
    if not np.isfinite(used.repetitions):
        return f"{turned} under no load: no life is used."
    scale, unit = _share_scale(used)
    shares = " and ".join(significant(scale * float(share)) for share in used.total)
    nuts = "the nuts" if used.total.size > 1 else "the nut"
    return (
        f"{turned} use {shares} {unit} of the rated life of {nuts}; 90 % of such screws would survive "
        f"{significant(used.repetitions)} repetitions. A turn uses life as the load to the power "
        f"{used.exponents.load:g}; a nut at rest uses none."
    )


def _share_scale(used: ConsumedLife) -> tuple[float, str]:
    """Factor and unit in which shares of life are readable."""
    return (100.0, "%") if float(used.total.max()) >= 1e-4 else (1e6, "ppm")


def _weibull_height(failed: FloatArray) -> FloatArray:
    """ln ln 1/(1 - F), the ordinate of Weibull paper."""
    return np.asarray(np.log(-np.log1p(-failed)), dtype=float)


def _finite(ends: list[float]) -> FloatArray:
    """Ends of a band, an open one drawn far out."""
    values = np.array(ends)
    finite = values[np.isfinite(values) & (values > 0.0)]
    return np.asarray(np.clip(values, 1e-3 * finite.min(initial=1.0), 1e3 * finite.max(initial=1.0)), dtype=float)


def _suspensions(axes: Axes, suspended: FloatArray) -> None:
    """Marks of the suspended specimens on the lower edge."""
    if suspended.size:
        height = np.full(suspended.size, _weibull_height(np.array([_SHARES[0]]))[0])
        axes.plot(suspended, height, "|", color=MEASURED, ms=9, mew=1.4, label="suspended")


def _weibull_axes(axes: Axes, law: WeibullLaw, unit: str) -> None:
    low, high = 0.4 * law.life(_SHARES[0]), 2.0 * law.life(_SHARES[-1])
    axes.set_xscale("log")
    ticks = [step * 10.0**decade for decade in range(-9, 15) for step in (1, 2, 3, 5)]
    ticks = [tick for tick in ticks if low <= tick <= high]
    axes.set_xticks(ticks, [significant(tick, 1) for tick in ticks])
    axes.set_xticks([], minor=True)
    axes.set_yticks(_weibull_height(np.array(_TICKS)), [f"{100 * share:g}" for share in _TICKS])
    dress(axes, f"life [{unit}]", "failed [%]")
    axes.set_ylim(*_weibull_height(np.array([_SHARES[0] * 0.85, 0.995])))
    axes.set_xlim(low, high)
