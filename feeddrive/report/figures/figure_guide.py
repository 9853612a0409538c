"""Figures of a ball guide: shares of its friction, friction over load and speed, ball loads over load."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.parts.guide.guide_carriage import carriage_friction, friction_map
from feeddrive.parts.guide.guide_coefficients import GuideCoefficients
from feeddrive.parts.guide.guide_equilibrium import guide_equilibrium
from feeddrive.parts.guide.guide_geometry import BallGuide
from feeddrive.parts.guide.guide_stiffness import unloading_force
from feeddrive.report.figures.drawing import NOISE, ReportFigure, dress, legend_above, new_figure
from feeddrive.typing import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PARTS = (("rolling", "#0072b2", "white"), ("viscous", "#e6a800", "#222222"), ("slip", "#c2477f", "white"))
"""Name, colour of the area and of the word in it."""
_LINES = ("#08306b", "#2171b5", "#35978f", "#b8860b", "#d55e00", "#7f0000")
_SPEEDS = np.geomspace(0.06, 100.0, 121) / 60.0
"""Of the component study of paper 003 [m/s]."""
_TICKS = (0.1, 1.0, 10.0, 100.0)
_TO_M_PER_MIN, _TO_KILONEWTON = 60.0, 1e-3


def guide_shares_figure(
    guide: BallGuide, coefficients: GuideCoefficients, loads: Sequence[float] = (0.0, 6e3, 24e3)
) -> ReportFigure:
    """Shares of rolling, viscous and slip friction over speed, one panel a vertical load [N]; seals left out."""
    figure = new_figure(3.1)
    panels = figure.subplots(1, len(loads), sharey=True, squeeze=False)[0]
    for axes, load in zip(panels, loads, strict=True):
        shares = 100.0 * np.array(carriage_friction(guide, coefficients, _SPEEDS, load).shares())
        colours = [colour for _, colour, _ in PARTS]
        axes.stackplot(_SPEEDS * _TO_M_PER_MIN, shares, colors=colours, alpha=0.85, lw=0.0)
        _name_areas(axes, shares)
        first = axes is panels[0]
        dress(axes, "speed [m/min]", "share of friction [%]" if first else "", f"{_kilonewton(load)} on the carriage")
        _speed_axis(axes)
        axes.set_ylim(0.0, 100.0)
    caption = (
        "Height of a colour: its share of the running friction of one carriage, without seals. Viscous friction rises "
        "with speed, rolling and slip do not; slip gains with load. At the left end the film is some nanometres, less "
        "than any roughness, and its share is the law continued."
    )
    return ReportFigure("guide_shares", "What the friction of the guide is made of", caption, figure)


def guide_friction_figure(
    guide: BallGuide, coefficients: GuideCoefficients, loads: Sequence[float] = (0.0, 1e3, 3e3, 6e3, 12e3, 24e3),
    speeds: Sequence[float] = (0.001, 0.05, 0.2, 100.0 / 60.0), seal_drag: float = 0.0,
) -> ReportFigure:  # fmt: skip
    """Friction of one carriage over speed at vertical loads [N], and over load at speeds [m/s]."""
    from matplotlib.ticker import LogLocator, NullFormatter

    figure = new_figure(3.4)
    left, right = figure.subplots(1, 2)
    over_speed = friction_map(guide, coefficients, np.array(loads), _SPEEDS, seal_drag)
    for load, force, colour in zip(loads, over_speed, _LINES, strict=False):
        left.plot(_SPEEDS * _TO_M_PER_MIN, force, color=colour, lw=1.6, label=_kilonewton(load))
    dress(left, "speed [m/min]", "friction of one carriage [N]")
    _speed_axis(left)
    left.set_yscale("log")
    left.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    left.yaxis.set_major_formatter("{x:g}")
    left.yaxis.set_minor_formatter(NullFormatter())
    legend_above(left, columns=3)
    steps = np.linspace(0.0, max(loads), 97)
    over_load = friction_map(guide, coefficients, steps, np.array(speeds), seal_drag).T
    for speed, force, colour in zip(speeds, over_load, _LINES[::2] + _LINES[1::2], strict=False):
        right.plot(steps * _TO_KILONEWTON, force, color=colour, lw=1.6, label=f"{speed * _TO_M_PER_MIN:g} m/min")
    _mark_unloading(right, guide)
    dress(right, "vertical load on the carriage [kN]", "friction of one carriage [N]")
    right.set_xlim(0.0, float(steps[-1]) * _TO_KILONEWTON)
    right.set_ylim(bottom=0.0)
    legend_above(right, columns=2)
    caption = (
        "Friction hardly changes until the preload is lost (dashed line); beyond, it rises with the load. Left: over "
        f"speed, both scales logarithmic. Seals: {seal_drag:g} N."
    )
    return ReportFigure("guide_friction", "Friction of the guide over load and speed", caption, figure)


def guide_ball_load_figure(
    guide: BallGuide, oversizes: Sequence[float] | None = None, largest: float | None = None
) -> ReportFigure:
    """Load of one ball over vertical load.

    Args:
        guide: whose.
        oversizes: preloads to compare [m]; none, half and all of the guide's own if not given.
        largest: load at the end of the axis [N]; twice that which takes the preload away if not given.
    """
    own = guide.preload_oversize
    sizes = tuple(dict.fromkeys((0.0, 0.5 * own, own))) if oversizes is None else tuple(oversizes)
    end = largest or 2.0 * unloading_force(guide) or 10e3
    figure = new_figure(3.6)
    axes = figure.subplots(1, 1)
    for size, colour in zip(sizes, _LINES[::2] + _LINES[1::2], strict=False):
        _ball_curves(axes, replace(guide, preload_oversize=size), end, colour)
    dress(axes, "vertical load on the carriage [kN]", "load of one ball [N]")
    axes.set_xlim(0.0, end * _TO_KILONEWTON)
    axes.set_ylim(bottom=0.0)
    legend_above(axes)
    caption = (
        "Solid: rows that the load presses on; dashed: rows that it relieves, up to the point where they lose contact "
        "(dot). A preload slows the rise until it is lost, then the curves run together."
    )
    return ReportFigure("guide_ball_load", "Ball loads of the guide over its load", caption, figure)


def _ball_curves(axes: Axes, guide: BallGuide, largest: float, colour: str) -> None:
    """Pressed and relieved rows of one preload, and the point where the relieved ones lose contact."""
    free = unloading_force(guide)
    for last, row, style in ((largest, 2, "-"), (min(free, largest), 0, "--")):
        loads = np.linspace(0.0, last, 101)
        balls = [float(guide_equilibrium(guide, float(load)).ball_load[row]) for load in loads]
        label = f"oversize {guide.preload_oversize * 1e6:g} µm" if row == 2 else None
        axes.plot(loads * _TO_KILONEWTON, balls, color=colour, lw=1.6, ls=style, label=label)
    if 0.0 < free <= largest:
        axes.plot([free * _TO_KILONEWTON], [0.0], "o", color=colour, ms=5, clip_on=False)


def _name_areas(axes: Axes, shares: FloatArray) -> None:
    """Write each part's name inside its area, where that is widest."""
    tops = np.cumsum(shares, axis=0)
    for (name, _, ink), share, top in zip(PARTS, shares, tops, strict=True):
        inner = slice(share.size // 5, -share.size // 5)  # clear of the frame
        at = int(np.argmax(share[inner])) + share.size // 5
        if share[at] > 6.0:
            axes.text(_SPEEDS[at] * _TO_M_PER_MIN, top[at] - 0.5 * share[at], name, ha="center", va="center",
                      fontsize=9, color=ink, fontweight="bold")  # fmt: skip


def _speed_axis(axes: Axes) -> None:
    """Logarithmic speed in m/min with plain numbers."""
    axes.set_xscale("log")
    axes.set_xlim(_SPEEDS[0] * _TO_M_PER_MIN, _SPEEDS[-1] * _TO_M_PER_MIN)
    axes.set_xticks(_TICKS, [f"{tick:g}" for tick in _TICKS])


def _mark_unloading(axes: Axes, guide: BallGuide) -> None:
    """Dashed line where the preload is lost."""
    force = unloading_force(guide) * _TO_KILONEWTON
    axes.axvline(force, color=NOISE, lw=1.0, ls="--")
    axes.annotate("preload lost", (force, 0.98), xycoords=("data", "axes fraction"), xytext=(4, 0),
                  textcoords="offset points", va="top", fontsize=8.5, color="#555555")  # fmt: skip


def _kilonewton(load: float) -> str:
    return f"{load * _TO_KILONEWTON:g} kN"
