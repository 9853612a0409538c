"""Figure of a measured stiffness and frequency: what the screw's own mass explains, and where explanations part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import cycle
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.diagnosis.stiffness.candidates import DriveAt
from feeddrive.diagnosis.stiffness.gap import Solved, frequency_of
from feeddrive.parts.combined_stiffness import natural_frequency, stiffness_along
from feeddrive.report.figures.drawing import AFTER, BEFORE, MEASURED, ReportFigure, dress, new_figure
from feeddrive.typing import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_COLOURS = ("#0072b2", "#009e73", "#cc79a7", "#d55e00", "#56b4e9", "#e69f00")
_POINTS = 60
_LEGEND_WIDTH = 44


def stiffness_gap_figure(
    declared: DriveAt, single: Sequence[Solved], frequency: float, lengths: FloatArray
) -> ReportFigure:
    """Left: frequency against the screw's length. Right: each single explanation at other nut positions.

    Args:
        declared: the drive as declared.
        single: changes that each give the measured stiffness, as `explain_stiffness` finds them; at least one.
        frequency: measured [Hz].
        lengths: of the screw, from beyond the nut on [m], shape (n,).

    Raises:
        InputError: a length at which the nut is not on the screw.
    """
    figure = new_figure(3.7)
    left, right = figure.subplots(1, 2)
    _length_panel(left, declared, single[0], frequency, lengths)
    _position_panel(right, declared, single)
    caption = (
        "Left: the screw's own mass and inertia lower the frequency without any change of stiffness. "
        "Right: every line meets the measured stiffness, by one change each. Different lines are told apart by a "
        "second nut position; changes that share a line only by measuring at the part itself."
    )
    return ReportFigure("stiffness_gap", "What a measured stiffness and frequency leave open", caption, figure)


def _length_panel(axes: Axes, declared: DriveAt, softer: Solved, frequency: float, lengths: FloatArray) -> None:
    """First frequency over the screw's length, with the declared and with the measured stiffness."""
    for state, colour, name in ((declared, BEFORE, "declared"), (softer.state, AFTER, "measured")):
        drive = state.drive
        states = [
            replace(state, drive=replace(drive, screw=replace(drive.screw, length=float(length)))) for length in lengths
        ]
        alone = np.full(lengths.shape, _table_alone(state))
        axes.plot(1e3 * lengths, alone, color=colour, lw=1.0, ls="--", label=f"{name} stiffness, table alone")
        own = [frequency_of(one) for one in states]
        axes.plot(1e3 * lengths, own, color=colour, lw=1.8, label=f"{name} stiffness, with screw")
    axes.axhline(frequency, color=MEASURED, lw=1.2, ls=":", label="measured frequency")
    dress(axes, "length of the screw [mm]", "first natural frequency [Hz]")
    _legend_below(axes)


def _table_alone(state: DriveAt) -> float:
    return natural_frequency(state.stiffness, state.drive.table_mass)


def _position_panel(axes: Axes, declared: DriveAt, single: Sequence[Solved]) -> None:
    """Change of stiffness along the stroke that each explanation foretells; where it is the same they share a line."""
    length = declared.drive.screw.length
    positions = np.linspace(0.05 * length, 0.9 * length, _POINTS)
    groups: list[tuple[list[str], FloatArray]] = []
    for solved in single:
        name, change = solved.candidate.name.removesuffix(" stiffness"), _foretold(declared, solved, positions)
        alike = [names for names, curve in groups if _same(curve, change)]
        if alike:
            alike[0].append(name)
        else:
            groups.append(([name], change))
    for (names, curve), colour in zip(groups, cycle(_COLOURS), strict=False):
        axes.plot(1e3 * positions, curve, color=colour, lw=1.8, label=fill(", ".join(names), _LEGEND_WIDTH))
    measured = 100.0 * (single[0].state.stiffness / declared.stiffness - 1.0)
    axes.plot([1e3 * declared.position], [measured], "o", color=MEASURED, ms=5, label="measured")
    dress(axes, "nut from the bearing at the motor [mm]", "stiffness beside the declared [%]")
    _legend_below(axes)


def _same(one: FloatArray, other: FloatArray) -> bool:
    """Whether two curves [%] agree to a ten-thousandth of a per cent where both are known."""
    known = np.isfinite(one) & np.isfinite(other)
    return bool(np.any(known)) and np.allclose(one[known], other[known], rtol=0.0, atol=1e-4)


def _foretold(declared: DriveAt, solved: Solved, positions: FloatArray) -> FloatArray:
    """Stiffness beside the declared drive's [%] at nut positions [m]; nan where the nut would leave the screw."""
    places = positions + solved.state.position - declared.position
    on_screw = places <= solved.state.drive.screw.length
    change = np.full(positions.shape, np.nan)
    after = stiffness_along(solved.state.drive, places[on_screw])
    change[on_screw] = 100.0 * (after / stiffness_along(declared.drive, positions[on_screw]) - 1.0)
    return change


def _legend_below(axes: Axes) -> None:
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.17), fontsize=8, frameon=False)
