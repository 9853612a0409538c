"""The report: one HTML file that holds everything it shows."""

from __future__ import annotations

from html import escape
from pathlib import Path

from feeddrive.compensation.actions import Actions
from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.files import write_text_atomically
from feeddrive.report.certainty import ambiguous_section, correlation_section, experiments_section
from feeddrive.report.figures.drawing import RenderedFigure
from feeddrive.report.figures.figure_unexplained import STEM
from feeddrive.report.figures.figures import render_figures
from feeddrive.report.figures.style import STYLE
from feeddrive.report.pages.markup import figure, paragraph, section, text
from feeddrive.report.pages.section_actions import actions_section
from feeddrive.report.pages.section_calibrated import calibrated_section
from feeddrive.report.pages.section_changes import changes_section, since_section
from feeddrive.report.pages.section_measured import measured_section
from feeddrive.report.pages.section_unexplained import unexplained_section
from feeddrive.report.pages.sections import (
    effects_section,
    error_section,
    verdict_section,
)
from feeddrive.report.records import UNKNOWN, Occasion, form_section, recordings_section, stamp_section, tried_section
from feeddrive.report.selection import MOST_CHANNELS_IN_DETAIL, drawn_series
from feeddrive.report.simulated import simulation_section
from feeddrive.report.words.people import share_text


def write_report(
    diagnosis: Diagnosis,
    path: Path,
    rendered: tuple[RenderedFigure, ...] | None = None,
    occasion: Occasion = UNKNOWN,
    todo: Actions | None = None,
    bench: str = "",
) -> None:
    """Write the report as one file without outside resources; an old one is replaced as a whole.

    The report itself has no scripts; those of a bench run in a frame of its own, which sees nothing of the report.

    Args:
        diagnosis: what was found.
        path: the HTML file; its folder is made if need be.
        rendered: figures drawn before by `render_figures`; drawn here if left away.
        occasion: when and by which command it was made.
        todo: what to do, and what it brings.
        bench: page for a second tab, on which the machine as diagnosed can be tried; no tabs without.

    Raises:
        InputError: the file cannot be written.
    """
    figures = render_figures(diagnosis) if rendered is None else rendered
    write_text_atomically(path, report_page(diagnosis, figures, occasion, todo, bench))


def report_page(
    diagnosis: Diagnosis, figures: tuple[RenderedFigure, ...], occasion: Occasion = UNKNOWN,
    todo: Actions | None = None, bench: str = "",
) -> str:  # fmt: skip
    """The page as text, in the order in which a servo engineer asks."""
    tried = "".join(figure(one) for one in figures if one.stem == "tried")
    explaining = "".join(figure(one) for one in figures if one.stem.startswith(("explains", "curve")))
    left = "".join(figure(one) for one in figures if one.stem.startswith(STEM))
    others = [one for one in figures if not one.stem.startswith(("explains", "curve", "tried", STEM))]
    sections = (
        form_section(diagnosis, occasion),
        verdict_section(diagnosis),
        error_section(diagnosis),
        actions_section(diagnosis, todo),
        effects_section(diagnosis) + explaining,
        calibrated_section(diagnosis),
        measured_section(diagnosis),
        changes_section(diagnosis) + since_section(diagnosis),
        ambiguous_section(diagnosis) + experiments_section(diagnosis),
        correlation_section(diagnosis),
        simulation_section(diagnosis),
        section("Measured and predicted", *map(figure, others), _not_drawn(diagnosis)),
        unexplained_section(diagnosis, left),
        tried_section(diagnosis, tried),
        recordings_section(diagnosis),
        stamp_section(diagnosis, occasion),
    )
    return page(f"Diagnosis of {diagnosis.plant}", _under_title(diagnosis), _with_bench("".join(sections), bench))


def _with_bench(report: str, bench: str) -> str:
    """The report as the first of two tabs, the bench as the second; the report alone where there is no bench."""
    if not bench:
        return report
    tabs = "".join(
        f'<input type="radio" name="tab" id="tab-{key}"{checked}><label for="tab-{key}">{name}</label>'
        for key, name, checked in (("report", "Report", " checked"), ("bench", "Bench", ""))
    )
    frame = f'<iframe title="Bench" loading="lazy" sandbox="allow-scripts allow-downloads" srcdoc="{escape(bench)}">'
    return (
        f'<div class="tabs">{tabs}\n<div class="pane-report">{report}</div>\n'
        f'<div class="pane-bench">{frame}</iframe></div></div>\n'
    )


def _under_title(diagnosis: Diagnosis) -> str:
    """Which files were fitted and judged."""
    fitted = ", ".join(stamp.file for stamp in diagnosis.fit) or "no file"
    judged = ", ".join(stamp.file for stamp in diagnosis.validate) or "the last part of each"
    return f"Fitted: {fitted}. Judged on: {judged}."


def _not_drawn(diagnosis: Diagnosis) -> str:
    """Say so where the number of figures was limited."""
    pairs = sum(len(recording.channels) for recording in diagnosis.recordings)
    drawn = len(drawn_series(diagnosis))
    if pairs <= drawn:
        return ""
    return paragraph(
        f"Series drawn: {drawn} of {pairs} ({share_text(drawn / pairs)}), at most "
        f"{MOST_CHANNELS_IN_DETAIL} channels in detail; all series are in prediction.csv.",
        "note",
    )


def page(title: str, under: str, body: str) -> str:
    """The frame of the page."""
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{text(title)}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n"
        f"<h1>{text(title)}</h1>\n{paragraph(under, 'under')}\n{body}</body>\n</html>\n"
    )
