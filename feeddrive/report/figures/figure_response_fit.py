"""The figure of a measured frequency response: measured, declared and found, the coherence below."""

from __future__ import annotations

import numpy as np

from feeddrive.diagnosis.responses.response_result import ResponseResult
from feeddrive.report.figures.drawing import AFTER, BEFORE, MEASURED, ReportFigure, dress, new_figure

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
