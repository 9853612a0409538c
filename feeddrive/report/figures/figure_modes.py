"""Figure of a machine's natural frequencies along its stroke."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from feeddrive.plant.analysis.mode_map import ModeMap, mode_map
from feeddrive.plant.plant import Plant
from feeddrive.report.figures.drawing import AFTER, BEFORE, ReportFigure, dress, legend_above, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SHOWN = 3
"""Modes that are drawn."""

_POINTS = 61


def modes_figure(plant: Plant) -> ReportFigure:
    """The first natural frequencies, motor held and free, and the static stiffness, over the stroke.

    Raises:
        InputError: no stroke is declared.
    """
    stroke = plant.stroke
    found = mode_map(plant, None if stroke is None else np.linspace(*stroke, _POINTS), SHOWN)
    figure = new_figure(5.2)
    frequency, stiffness = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1.2))
    brake = plant.drive is not None and plant.drive.motor.brake is not None
    _draw_frequencies(frequency, found, "motor held by its brake" if brake else "motor held: its anti-resonances")
    stiffness.plot(1e3 * found.positions, 1e-6 * found.stiffness, color="#333333")
    low, high = float(np.min(found.stiffness)), float(np.max(found.stiffness))
    stiffness.set_ylim(0, 1.15e-6 * high)
    dress(stiffness, "table position [mm]", "stiffness [N/µm]", "static stiffness at the table, motor held")
    return ReportFigure("modes", "Natural frequencies along the stroke", _caption(found, low, high), figure)


def _draw_frequencies(axes: Axes, found: ModeMap, held: str) -> None:
    places = 1e3 * found.positions
    for frequencies, colour, style, label in (
        (found.free, BEFORE, "-", "motor free: resonances"),
        (found.held, AFTER, "--", held),
    ):
        for number in range(min(SHOWN, frequencies.shape[1])):
            axes.plot(places, frequencies[:, number], color=colour, linestyle=style, label="" if number else label)
    axes.set_ylim(0, None)
    dress(axes, "", "natural frequency [Hz]")
    legend_above(axes, 2)


def _caption(found: ModeMap, low: float, high: float) -> str:
    first = found.held[:, 0]
    place = 1e3 * found.positions[int(np.argmin(first))]
    return (
        f"The first frequency with the motor held goes from {first.min():.4g} to {first.max():.4g} Hz and is lowest "
        f"with the table at {place:.4g} mm; the stiffness at the table goes from {1e-6 * low:.4g} to "
        f"{1e-6 * high:.4g} N/µm."
    )
