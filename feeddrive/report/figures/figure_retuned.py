"""Step and circle under the present settings of a drive and under the recommended ones."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from feeddrive.metrology.circular import Circular
from feeddrive.metrology.loop_trial import LoopTrial, Ran
from feeddrive.report.figures.drawing import AFTER, BEFORE, ReportFigure, dress, new_figure

_LOOKS = ((BEFORE, "present"), (AFTER, "recommended"))


def step_figure(before: Sequence[LoopTrial], after: Sequence[LoopTrial]) -> ReportFigure | None:
    """Table position after a small step, every case; None where no step was run."""
    figure = new_figure(3.2)
    axes = figure.subplots()
    drawn = False
    for some, (colour, name) in zip((before, after), _LOOKS, strict=True):
        for place, one in enumerate(ran.step for ran in some if ran.step is not None):
            series = one.result.series
            axes.plot(
                1e3 * one.result.time,
                1e6 * (series["table_position"] - series["setpoint"][0]),
                color=colour,
                lw=1.0,
                label=name if not place else None,
            )
            drawn = True
    if not drawn:
        return None
    dress(axes, "time [ms]", "table position [µm]", "Step of the position")
    axes.legend(fontsize=8, frameon=False)
    return ReportFigure(
        "retuned_step", "Step of the position", "Every position and payload; friction and limits act.", figure
    )


def circle_figure(before: Sequence[LoopTrial], after: Sequence[LoopTrial]) -> ReportFigure | None:
    """Radial deviation over the angle of the circle, every case; None where no circle was run."""
    figure = new_figure(3.2)
    axes = figure.subplots()
    drawn = False
    for some, (colour, name) in zip((before, after), _LOOKS, strict=True):
        for place, found in enumerate(_radial(ran.circle) for ran in some if ran.circle is not None):
            axes.plot(*found, color=colour, lw=1.0, label=name if not place else None)
            drawn = True
    if not drawn:
        return None
    dress(axes, "angle along the circle [°]", "radial deviation [µm]", "Circle of 5 mm at 3 m/min")
    axes.legend(fontsize=8, frameon=False)
    caption = "Every position and payload; the axis reverses at 90° and 270°, where friction leaves its glitch."
    return ReportFigure("retuned_circle", "Circle", caption, figure)


def _radial(ran: Ran) -> tuple[np.ndarray, np.ndarray]:
    assert isinstance(ran.figure, Circular)
    angle = np.degrees(ran.figure.angle - ran.figure.angle[0])
    return angle, 1e6 * ran.figure.radial
