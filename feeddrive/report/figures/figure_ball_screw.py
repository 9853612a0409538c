"""Figures about the friction of a ball screw: efficiency, best contact angle, torque of a double nut."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.parts.screw.contact_angle_optimum import (
    best_contact_angle,
    efficiency_at_best_angle,
    highest_efficiency,
    largest_lead_angle,
)
from feeddrive.parts.screw.double_nut import OPENING
from feeddrive.parts.screw.screw_efficiency import back_driving_efficiency, driving_efficiency
from feeddrive.parts.screw.screw_friction import ScrewFriction
from feeddrive.parts.screw.slip_angle import groove_at
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
from feeddrive.report.words.words import figure_text
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_COLOURS = (AFTER, MEASURED, BEFORE, NOISE)
_POINTS = 400


def efficiency_figure(frictions: Sequence[float], contact_angle: float, largest: float = math.pi / 4) -> ReportFigure:
    """Efficiency against the lead angle, driving and back-driving.

    Args:
        frictions: friction coefficients, up to four.
        contact_angle: [rad].
        largest: lead angle to which it is drawn [rad].
    """
    figure = new_figure(3.4)
    axes = figure.subplots()
    alpha = np.linspace(1e-4, largest, _POINTS)
    groove = groove_at(alpha, contact_angle)
    for f, colour in zip(frictions, _COLOURS, strict=False):
        axes.plot(np.degrees(alpha), 100 * driving_efficiency(groove, f), color=colour, label=f"f = {f:g}")
        axes.plot(np.degrees(alpha), 100 * back_driving_efficiency(groove, f), color=colour, linestyle="--")
    angle = format_quantity(contact_angle, "rad")
    dress(axes, "lead angle [°]", "efficiency [%]", f"contact angle {angle}; solid driving, dashed back-driving")
    axes.set_xlim(0, math.degrees(largest))
    axes.set_ylim(None, 100)
    legend_above(axes)
    caption = (
        "Efficiency with slipping balls. It hardly depends on the lead angle, and does not vanish with it: in this "
        "model the balls' friction decides, not the lead. Drag that the load does not cause comes on top."
    )
    return ReportFigure("screw_efficiency", "Efficiency of the ball screw", caption, figure)


def contact_angle_figure(friction: float, lead_angles: Sequence[float]) -> ReportFigure:
    """Efficiency over the contact angle, and the contact angle of the highest efficiency over the lead angle.

    Args:
        friction: friction coefficient.
        lead_angles: of the curves at the left [rad], up to four.
    """
    figure = new_figure(3.4)
    left, right = figure.subplots(1, 2)
    _over_contact_angle(left, friction, lead_angles)
    alpha = np.linspace(1e-3, math.radians(50), _POINTS)
    right.plot(np.degrees(alpha), np.degrees(best_contact_angle(alpha, friction)), color=AFTER)
    last = math.degrees(float(largest_lead_angle(friction)))
    right.axvline(last, color=NOISE, linewidth=0.9, linestyle=":")
    note = f"up to {last:.1f}°\n{100 * float(highest_efficiency(friction)):.2f} % is reached"
    right.text(last - 0.8, 48, note, ha="right", fontsize=8.5)
    dress(right, "lead angle [°]", "best contact angle [°]", f"f = {friction:g}, driving")
    right.set_xlim(0, 50)
    caption = (
        "Left: efficiency over the contact angle, its highest value marked. Right: where that is. The optimum is flat, "
        "so 45° is good for usual leads; a steeper contact pays for large lead angles."
    )
    return ReportFigure("contact_angle", "Contact angle of the highest efficiency", caption, figure)


def _over_contact_angle(axes: Axes, friction: float, lead_angles: Sequence[float]) -> None:
    beta = np.linspace(math.radians(25), math.radians(85), _POINTS)
    for alpha, colour in zip(lead_angles, _COLOURS, strict=False):
        label = f"lead angle {math.degrees(alpha):.3g}°"
        axes.plot(
            np.degrees(beta), 100 * driving_efficiency(groove_at(alpha, beta), friction), color=colour, label=label
        )
        top = 100 * float(efficiency_at_best_angle(alpha, friction))
        axes.plot(math.degrees(float(best_contact_angle(alpha, friction))), top, "o", color=colour, markersize=4.5)
    dress(axes, "contact angle [°]", "efficiency [%]", f"f = {friction:g}, driving")
    axes.legend(fontsize=8.5, frameon=False, loc="lower center")


def double_nut_figure(screw: ScrewFriction, preload: float) -> ReportFigure:
    """Torque over the axial load in both directions of rotation, with rigid preload and without.

    Args:
        screw: with its friction.
        preload: [N], positive.
    """
    figure = new_figure(3.4)
    left, right = figure.subplots(1, 2)
    force = np.linspace(-4 * preload, 4 * preload, _POINTS + 1)
    for speed, colour, name in ((1.0, AFTER, "+ direction"), (-1.0, BEFORE, "− direction")):
        for given, line in ((preload, "-"), (0.0, "--")):
            torque = np.array([screw.torque(float(F), speed, given) for F in force])
            drag = speed * (torque - np.array(force) * screw.geometry.lead / (2 * math.pi))
            label = f"{name}, {'preloaded' if given else 'single nut'}"
            left.plot(force / 1e3, torque, line, color=colour, linewidth=1.3)
            right.plot(force / 1e3, drag, line, color=colour, linewidth=1.3, label=label)
    for axes in (left, right):
        for end in (-OPENING, OPENING):
            axes.axvline(end * preload / 1e3, color=NOISE, linewidth=0.9, linestyle=":")
    dress(left, "axial force [kN]", "torque on the screw [N m]", f"preload {format_quantity(preload, 'N')}")
    dress(right, "axial force [kN]", "friction torque [N m]")
    right.set_ylim(0, 1.45 * right.get_ylim()[1])
    right.legend(fontsize=8.5, frameon=False, ncols=2, loc="upper center", handlelength=1.6, columnspacing=1.2)
    caption = figure_text(
        "Left: torque on the screw. Right: what of it is friction; it resists in every quadrant. Beyond the dotted "
        "lines one nut is free of load, and the preload no longer counts."
    )
    return ReportFigure("double_nut", "Torque of the double nut", caption, figure)
