"""Figure of a measured frequency response: magnitude, phase, and coherence where it is known."""

from __future__ import annotations

import numpy as np

from feeddrive.recording.frequency_response import FrequencyResponse
from feeddrive.report.figures.drawing import MEASURED, ReportFigure, dress, new_figure
from feeddrive.servo.mechanics_response import decibel, degrees

_COHERENT = 0.8


def response_figure(response: FrequencyResponse) -> ReportFigure:
    """Draw a response over its positive frequencies; what is not coherent is pale."""
    shown = response.positive
    known = bool(np.any(np.isfinite(shown.coherence)))
    figure = new_figure(6.4 if known else 5.4)
    heights = [3, 2, 1] if known else [3, 2]
    panels = list(figure.subplots(len(heights), 1, sharex=True, height_ratios=heights))
    phase = degrees(shown.values)
    jumps = np.flatnonzero(np.abs(np.diff(phase)) > 180) + 1
    curves = (
        (shown.frequency, decibel(shown.values)),
        (np.insert(shown.frequency, jumps, shown.frequency[jumps]), np.insert(phase, jumps, np.nan)),
    )
    sure = np.where(shown.coherence > _COHERENT, 1.0, np.nan) if known else np.ones_like(shown.frequency)
    for panel, (frequency, values) in zip(panels, curves, strict=False):
        panel.plot(frequency, values, color=MEASURED, linewidth=0.8, alpha=0.35 if known else 1.0)
        panel.plot(frequency, values * np.interp(frequency, shown.frequency, sure), color=MEASURED, linewidth=1.4)
        panel.set_xscale("log")
    title = f"{response.given} to {response.output}"
    unit = "" if response.unit in ("", "1") else f", {response.unit}"
    dress(panels[0], "", f"magnitude [dB{unit}]", title)
    dress(panels[1], "", "phase [°]")
    panels[1].set_ylim(-190, 190)
    panels[1].set_yticks([-180, -90, 0, 90, 180])
    if known:
        panels[2].plot(shown.frequency, shown.coherence, color=MEASURED, linewidth=1.0)
        dress(panels[2], "", "coherence")
        panels[2].set_ylim(-0.05, 1.05)
    panels[-1].set_xlabel("frequency [Hz]", fontsize=9)
    panels[-1].set_xlim(shown.frequency[0], shown.frequency[-1])
    figure.align_ylabels(panels)
    pale = "; pale where the coherence is below 0.8" if known else ""
    return ReportFigure(
        "response", f"Frequency response: {title}", f"Measured frequency response, {title}{pale}.", figure
    )
