"""Figures of a measured frequency response and of measured numbers, alone and beside what a machine declares."""

from __future__ import annotations

import numpy as np

from feeddrive.diagnosis.numbers.numbers_result import NumbersResult
from feeddrive.diagnosis.responses.response_result import ResponseResult
from feeddrive.recording.frequency_response import FrequencyResponse
from feeddrive.report.figures.drawing import AFTER, BEFORE, MEASURED, NOISE, ReportFigure, dress, new_figure
from feeddrive.report.words.explained_words import value_text
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


_HEIGHT = 6.2


def response_fit_figure(result: ResponseResult) -> ReportFigure:
    """Magnitude, phase and coherence over the frequency."""
    response = result.problem.response
    known = not np.all(np.isnan(response.coherence))
    figure = new_figure(_HEIGHT)
    ratios = (3, 2, 1) if known else (3, 2)
    panels = figure.subplots(len(ratios), 1, sharex=True, height_ratios=ratios)
    curves = (
        ("measured", response.values, MEASURED, "."),
        ("declared plant", result.before, BEFORE, "-"),
        ("plant as found", result.after, AFTER, "-"),
    )
    for label, values, colour, style in curves:
        look = {"markersize": 3.0, "linestyle": "none", "marker": style} if style == "." else {"linewidth": 1.3}
        panels[0].semilogx(response.frequency, 20 * np.log10(np.abs(values)), color=colour, label=label, **look)
        panels[1].semilogx(response.frequency, np.degrees(np.angle(values)), color=colour, **look)
    dress(panels[0], "", "magnitude [dB, SI]", f"{response.output} over {response.given}".replace("_", " "))
    dress(panels[1], "" if known else "frequency [Hz]", "phase [°]")
    panels[1].set_yticks([-180, -90, 0, 90, 180])
    if known:
        panels[2].semilogx(response.frequency, response.coherence, color=MEASURED, linewidth=1.0)
        panels[2].set_ylim(0.0, 1.05)
        dress(panels[2], "frequency [Hz]", "coherence")
    panels[0].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, fontsize=8.5, frameon=False)
    caption = "Lines of low coherence weigh little; resonances and anti-resonances should lie on the measured ones."
    return ReportFigure("response", "Measured response before and after", caption, figure)


MOST_CAUSES = 6
_ROW, _MARGIN = 0.32, 1.3


def numbers_figure(result: NumbersResult) -> ReportFigure:
    """One panel a number: error in per cent by explanation, its tolerance as a band."""
    causes = result.singles[:MOST_CAUSES]
    names = ["as declared", "most likely values"]
    names += [f"{one.value.words}: {value_text(one.value, one.value.number(one.coordinate))}" for one in causes]
    predicted = [result.declared, result.after, *(one.predicted for one in causes)]
    measured = result.problem.measured
    figure = new_figure(_MARGIN + _ROW * len(names))
    panels = np.atleast_1d(figure.subplots(1, len(measured), sharey=True))
    places = np.arange(len(names))[::-1]
    for column, (axes, number) in enumerate(zip(panels, measured, strict=True)):
        errors = [100 * (float(values[column]) / number.value - 1) for values in predicted]
        band = 200 * number.deviation / number.value
        axes.axvspan(-band, band, color=NOISE, alpha=0.25, label="tolerance of the number")
        axes.axvline(0.0, color=NOISE, linewidth=0.8)
        axes.plot(errors[:1], places[:1], "o", color=BEFORE, label="declared")
        axes.plot(errors[1:2], places[1:2], "o", color=AFTER, label="most likely")
        axes.plot(errors[2:], places[2:], "s", color="#444444", markersize=4.5, label="one value alone")
        dress(axes, "error [%]", "", _short(number.name))
        axes.tick_params(labelleft=column == 0)
    panels[0].set_yticks(places, names, fontsize=8.5)
    panels[0].set_ylim(-0.6, len(names) - 0.4)
    lines, texts = panels[0].get_legend_handles_labels()
    figure.legend(lines, texts, loc="outside upper right", ncols=len(texts), fontsize=8.5, frameon=False)
    caption = (
        "How far each explanation misses each measured number; the band is the number's own tolerance. "
        "An explanation counts where all its points lie within the bands."
    )
    return ReportFigure("explanations", "Explanations against measured numbers", caption, figure)


def _short(name: str) -> str:
    return name.replace("_", " ").replace("natural frequency", "frequency").replace("axial stiffness", "stiffness")
