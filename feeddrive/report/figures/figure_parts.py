"""Figures of an axis' parts from its own values: efficiency of the screw, friction and loads of the guide, life."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from feeddrive.errors import ValidityWarning
from feeddrive.parts.guide.guide_rating import Carriages, RollingCarriage, rated_friction
from feeddrive.parts.life.consumed_life import ConsumedLife
from feeddrive.parts.life.life_exponents import BALL_SCREW
from feeddrive.parts.screw.double_nut import OPENING, rigid_sharing
from feeddrive.plant.analysis.nut_losses import NutLosses, nut_losses
from feeddrive.plant.analysis.rated_life import datum, life_under, preload_of
from feeddrive.plant.plant import Plant
from feeddrive.report.figures.drawing import (
    AFTER,
    BEFORE,
    MEASURED,
    ReportFigure,
    dress,
    legend_above,
    new_figure,
)
from feeddrive.report.words.number_text import scale_for_share_of_life, significant
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_POINTS = 161
_KILO = 1e-3
_AREAS = {"seals": "#bdbdbd", "rolling": "#0072b2", "oil film": "#e6a800", "slip": "#c2477f"}
_SPEEDS = np.geomspace(0.06, 100.0, 81) / 60.0
"""From creeping to the fastest machine tools [m/s]."""

_EXAMPLES = (0.05, 0.1, 0.2)
"""Loads over the dynamic rating that are drawn where the axis declares none: light, usual and heavy duty."""


def parts_figures(plant: Plant, carriages: Carriages | None) -> tuple[ReportFigure, ...]:
    """The figures that the declared values of a plant and of its carriages allow."""
    figures, rating = list[ReportFigure](), datum(plant, "ball_screw.dynamic_rating")
    if (losses := nut_losses(plant)) is not None:
        figures.append(efficiency_figure(losses, datum(plant, "table.axial_load"), rating))
    if carriages is not None:
        figures.append(guide_figure(carriages))
    if rating is not None:
        figures.append(life_figure(plant))
    return tuple(figures)


def figures_left_out(plant: Plant, carriages: Carriages | None) -> tuple[str, ...]:
    """A line for each of `parts_figures` that is not drawn: what it shows, and what to declare for it."""
    needed = {
        "efficiency of the ball screw: declare [[effect]] nut_friction, or nut_drag and nut.preload": nut_losses(plant),
        "friction and loads of the guide: declare [guide] with its carriages": carriages,
        "life of the ball screw: declare ball_screw.dynamic_rating": datum(plant, "ball_screw.dynamic_rating"),
    }
    return tuple(line for line, given in needed.items() if given is None)


def efficiency_figure(losses: NutLosses, load: float | None, rating: float | None) -> ReportFigure:
    """Efficiency over the lead angle, with the axis' own, and over the axial load; preload and drag included.

    Args:
        losses: friction of the screw.
        load: declared axial load [N]; None where none is declared.
        rating: dynamic rating [N], of which a tenth is taken where no load is declared; None as well.
    """
    marked = load or (rating or 10 * OPENING * losses.preload or 1e4) / 10
    geometry = losses.screw.geometry
    figure = new_figure(3.4)
    left, right = figure.subplots(1, 2)
    angles = np.radians(np.linspace(1.0, max(1.8 * math.degrees(geometry.lead_angle), 12.0), _POINTS))
    leads = math.pi * geometry.pitch_diameter * np.tan(angles)
    greatest = max(2 * marked, 2 * OPENING * losses.preload)
    forces = np.linspace(greatest / 500, greatest, _POINTS)
    ways = ((True, AFTER, "-", "screw drives"), (False, BEFORE, "--", "nut drives"))
    for driving, colour, style, name in ways:
        over_lead = [100 * losses.efficiency(marked, driving, float(lead)) for lead in leads]
        over_load = [100 * losses.efficiency(float(force), driving) for force in forces]
        own = 100 * losses.efficiency(marked, driving)
        left.plot(np.degrees(angles), over_lead, style, color=colour, lw=1.8, label=name)
        left.plot([math.degrees(geometry.lead_angle)], [own], "o", color=colour, ms=6)
        right.plot(forces * _KILO, over_load, style, color=colour, lw=1.8, label=name)
        right.plot([marked * _KILO], [own], "o", color=colour, ms=6)
    dress(left, "lead angle [°]", "efficiency [%]", f"at {format_quantity(marked, 'N')}")
    left.set_xlim(0.0, math.degrees(angles[-1]))
    dress(right, "axial load [kN]", "efficiency [%]", f"lead {format_quantity(geometry.lead, 'm')}")
    right.set_xlim(0.0, greatest * _KILO)
    for axes in (left, right):
        axes.set_ylim(0.0, 100.0)
        legend_above(axes, 2)
    return ReportFigure("screw_efficiency", "Efficiency of the ball screw", _efficiency_caption(losses, marked), figure)


def _efficiency_caption(losses: NutLosses, marked: float) -> str:
    geometry, f = losses.screw.geometry, losses.screw.friction_coefficient
    driving, driven = (significant(100 * losses.efficiency(marked, way)) for way in (True, False))
    text = (
        f"Dots: this axis with {math.degrees(geometry.lead_angle):.1f}° at {format_quantity(marked, 'N')}: {driving} % "
        f"while the screw drives, {driven} % while the load turns the screw. Slow motion, friction coefficient "
        f"{f:.2g}, preload {format_quantity(losses.preload, 'N')}, drag of the shaft "
        f"{format_quantity(losses.drag, 'N m')}: "
        "drag is what a small lead and a small load lose by; the balls alone take the same share of every load."
    )
    if losses.effect != "nut_friction":
        text += " The coefficient follows from nut_drag at the preload, so seals in it count as friction of the balls."
    return text


def guide_figure(carriages: Carriages) -> ReportFigure:
    """What the friction of all carriages is made of, and how the rows of one share its load."""
    figure = new_figure(3.4)
    left, right = figure.subplots(1, 2)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ValidityWarning)  # of loads beyond the axis' own, which were checked on reading
        share = _friction_by_geometry(left, carriages) if _rolls(carriages) else _friction_by_rating(left, carriages)
        lost = _rows(right, carriages)
    own = format_quantity(carriages.load, "N")
    text = (
        f"{carriages.count} carriages {carriages.name}, {own} on each. Left: {share} Right: rows that the load presses "
        "and those that it relieves"
    )
    text += f"; beyond {format_quantity(lost, 'N')} these run free, the preload is lost." if lost else "; no preload."
    return ReportFigure("guide_shares", "Friction and load shares of the guide", text, figure)


def _rolls(carriages: Carriages) -> bool:
    return isinstance(carriages.one, RollingCarriage)


def _friction_by_geometry(axes: Axes, carriages: Carriages) -> str:
    """Parts of the friction over speed at the declared load."""
    from feeddrive.parts.guide.guide_carriage import table_friction

    one = carriages.one
    assert isinstance(one, RollingCarriage)
    found = table_friction(one.guide, one.coefficients, carriages.count, _SPEEDS, carriages.load, carriages.seal_drag)
    parts = dict(zip(_AREAS, (found.seal, found.rolling, found.viscous, found.slip), strict=True))
    kept = {name: part for name, part in parts.items() if part.max() > 0}
    axes.stackplot(
        _SPEEDS * 60, list(kept.values()), labels=list(kept), colors=[_AREAS[n] for n in kept], alpha=0.85, lw=0
    )
    axes.set_xscale("log")
    axes.set_xlim(_SPEEDS[0] * 60, _SPEEDS[-1] * 60)
    axes.set_xticks((0.1, 1.0, 10.0, 100.0), ["0.1", "1", "10", "100"])
    dress(axes, "speed [m/min]", "friction of the guide [N]")
    axes.set_ylim(0.0)
    legend_above(axes)
    return "what their friction is made of; only the oil film grows with speed."


def _friction_by_rating(axes: Axes, carriages: Carriages) -> str:
    """Seals and rows over the load of a carriage; its catalogue says nothing of the speed."""
    one = carriages.one
    assert not isinstance(one, RollingCarriage)
    loads = np.linspace(0.0, _greatest(carriages), _POINTS)
    rows = carriages.count * np.array([rated_friction(F, one.preload, one.friction_coefficient, 0.0) for F in loads])
    seals = np.full(loads.size, carriages.count * carriages.seal_drag)
    colours = [_AREAS["seals"], _AREAS["rolling"]]
    axes.stackplot(loads * _KILO, seals, rows, labels=["seals", "rolling"], colors=colours, alpha=0.85, lw=0)
    axes.axvline(carriages.load * _KILO, color=MEASURED, lw=1.2, ls=":", label="declared load")
    dress(axes, "vertical load of one carriage [kN]", "friction of the guide [N]")
    axes.set_xlim(0.0, loads[-1] * _KILO)
    axes.set_ylim(0.0)
    legend_above(axes)
    return "their friction by the catalogue, which says nothing of the speed; it is the size, within a factor of two."


def _rows(axes: Axes, carriages: Carriages) -> float:
    """Loads of pressed and relieved rows over the vertical load; returns where the preload is lost [N]."""
    loads = np.linspace(0.0, _greatest(carriages), 81)
    pressed, relieved = np.array([_shared(carriages, float(F)) for F in loads]).T
    unit, scale = ("kN", _KILO) if pressed.max() > 2e3 else ("N", 1.0)
    axes.plot(loads * _KILO, pressed * scale, color=AFTER, lw=1.8, label="pressed rows")
    axes.plot(loads * _KILO, relieved * scale, "--", color=BEFORE, lw=1.8, label="relieved rows")
    axes.axvline(carriages.load * _KILO, color=MEASURED, lw=1.2, ls=":", label="declared load")
    dress(
        axes, "vertical load of one carriage [kN]", f"load of {'a ball' if _rolls(carriages) else 'the rows'} [{unit}]"
    )
    axes.set_xlim(0.0, loads[-1] * _KILO)
    axes.set_ylim(0.0)
    legend_above(axes)
    return _lost(carriages)


def _shared(carriages: Carriages, load: float) -> tuple[float, float]:
    """Load of a ball of the pressed and the relieved rows, or of the rows where no geometry is known [N]."""
    one = carriages.one
    if isinstance(one, RollingCarriage):
        from feeddrive.parts.guide.guide_equilibrium import guide_equilibrium

        balls = guide_equilibrium(one.guide, load).ball_load
        return float(balls[2]), float(balls[0])
    pressed, relieved = rigid_sharing(load, one.preload)
    return float(pressed), float(relieved)


def _lost(carriages: Carriages) -> float:
    """Vertical load of one carriage at which its preload is lost [N]; 0 without preload."""
    one = carriages.one
    if isinstance(one, RollingCarriage):
        from feeddrive.parts.guide.guide_equilibrium import unloading_force

        return unloading_force(one.guide)
    return OPENING * one.preload


def _greatest(carriages: Carriages) -> float:
    """Right end of the load axis [N]."""
    return max(1.5 * _lost(carriages), 2.0 * abs(carriages.load), 100.0)


def life_figure(plant: Plant) -> ReportFigure:
    """Travel that 90 % survive over the axial load, and over the share of the travel under a load.

    Args:
        plant: that declares `ball_screw.dynamic_rating`.
    """
    rating, load, preload = (
        datum(plant, "ball_screw.dynamic_rating"),
        datum(plant, "table.axial_load"),
        preload_of(plant),
    )
    assert rating is not None
    loads = [load] if load is not None else [share * rating for share in _EXAMPLES]
    figure = new_figure(3.5)
    left, right = figure.subplots(1, 2, sharey=True)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ValidityWarning)  # above half the rating: warned of with its table
        forces = np.linspace(rating / 100 if preload == 0 else 0.0, max(rating / 2, 1.1 * max(loads)), _POINTS)
        left.semilogy(forces * _KILO, [_kilometres(plant, [(1.0, float(F))]) for F in forces], color=AFTER, lw=1.8)
        shares = np.linspace(0.01 if preload == 0 else 0.0, 1.0, _POINTS)
        for one, colour, style in zip(loads, (AFTER, BEFORE, MEASURED), ("-", "--", "-."), strict=False):
            course = [_kilometres(plant, [(share, one), (1 - share, 0.0)]) for share in shares]
            right.semilogy(100 * shares, course, style, color=colour, lw=1.8, label=format_quantity(one, "N"))
            left.plot([one * _KILO], [_kilometres(plant, [(1.0, one)])], "o", color=colour, ms=6)
        own = [significant(_kilometres(plant, [(1.0, one)])) for one in loads]
    dress(left, "axial load, always [kN]", "travel that 90 % survive [km]")
    left.set_xlim(0.0, forces[-1] * _KILO)
    dress(right, "share of the travel under the load [%]", "")
    right.set_xlim(0.0, 100.0)
    legend_above(right)
    _hours(right, plant)
    which = "the declared load" if load is not None else "5, 10 and 20 % of the dynamic rating, as none is declared"
    caption = (
        f"Rated life of the ball screw by its dynamic rating of {format_quantity(rating, 'N')}. Left: dots at {which}: "
        f"{', '.join(own)} km. Right: the load acts over a share of the travel, else the preload of "
        f"{format_quantity(preload, 'N')} alone. No factor for film, dirt or shocks."
    )
    return ReportFigure("screw_life", "Life of the ball screw over load and duty", caption, figure)


def _kilometres(plant: Plant, duty: Sequence[tuple[float, float]]) -> float:
    return life_under(plant, duty) * 2 * math.pi * plant.chain.radius * _KILO


def _hours(axes: Axes, plant: Plant) -> None:
    """The same lives as hours at the greatest velocity, at the right, where it is declared."""
    velocity = datum(plant, "table.max_velocity")
    if velocity is None:
        return
    per_hour = 3.6 * velocity  # km

    def to_hours(kilometres: Any) -> Any:
        return kilometres / per_hour

    def from_hours(hours: Any) -> Any:
        return hours * per_hour

    other = axes.secondary_yaxis("right", functions=(to_hours, from_hours))
    other.spines["right"].set_color("#888888")
    other.set_ylabel(f"time at {format_quantity(velocity, 'm/s')} [h]", fontsize=9)
    other.tick_params(labelsize=8.5, color="#888888")


def used_life_figure(time: FloatArray, used: ConsumedLife) -> ReportFigure:
    """Load of every nut along a recording, and the share of its rated life used.

    Args:
        time: (n,) [s].
        used: of the same recording.
    """
    figure = new_figure(4.6)
    upper, lower = figure.subplots(2, 1, sharex=True)
    scale = scale_for_share_of_life(float(used.total.max()))
    for name, forces, share, colour in zip(("nut +", "nut −"), used.forces, used.used, (AFTER, BEFORE), strict=True):
        upper.plot(time, _KILO * forces, color=colour, lw=0.9, label=name)
        lower.plot(time, scale.factor * share, color=colour, lw=1.4)
    dress(upper, "", "load of the nut [kN]")
    dress(lower, "time [s]", f"rated life used [{scale.unit}]")
    upper.set_ylim(0.0)
    lower.set_ylim(0.0)
    legend_above(upper)
    figure.align_ylabels([upper, lower])
    caption = (
        f"{significant(float(used.revolutions[-1]))} revolutions. A turn uses life as the load of the nut, its preload "
        f"included, to the power {BALL_SCREW.load:g}; a nut at rest uses none."
    )
    return ReportFigure("used_life", "Life used along the recording", caption, figure)
