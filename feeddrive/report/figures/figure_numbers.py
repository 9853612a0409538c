"""The figure of measured numbers: what declared, most likely and single values miss."""

from __future__ import annotations

import numpy as np

from feeddrive.diagnosis.numbers.numbers_result import NumbersResult
from feeddrive.report.figures.drawing import AFTER, BEFORE, NOISE, ReportFigure, dress, new_figure
from feeddrive.report.words.numbers_words import value_text

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
