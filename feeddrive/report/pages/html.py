"""The report: one HTML file that holds everything it shows."""

from __future__ import annotations

from html import escape
from pathlib import Path

from feeddrive.compensation.actions import Actions
from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.files import write_text_atomically
from feeddrive.report.figures.drawing import RenderedFigure
from feeddrive.report.figures.figures import STEM, render_figures
from feeddrive.report.figures.selection import MOST_CHANNELS_IN_DETAIL, drawn_series
from feeddrive.report.pages.markup import figure, paragraph, section, text
from feeddrive.report.pages.section_actions import actions_section
from feeddrive.report.pages.section_certainty import (
    ambiguous_section,
    correlation_section,
    experiments_section,
    simulation_section,
)
from feeddrive.report.pages.section_changes import changes_section, since_section
from feeddrive.report.pages.section_records import (
    UNKNOWN,
    Occasion,
    form_section,
    recordings_section,
    stamp_section,
    tried_section,
)
from feeddrive.report.pages.section_unexplained import unexplained_section
from feeddrive.report.pages.sections import (
    calibrated_section,
    effects_section,
    error_section,
    measured_section,
    verdict_section,
)
from feeddrive.report.words.number_text import share_text


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
    """Which files were fitted and judged; their folders stand with their checksums at the end."""
    fitted = ", ".join(Path(stamp.file).name for stamp in diagnosis.fit) or "no file"
    judged = ", ".join(Path(stamp.file).name for stamp in diagnosis.validate) or "the last part of each"
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


STYLE = """
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 28px 20px 60px; max-width: 900px; background: #fff; color: #1c1c1c;
  font: 15px/1.5 "Segoe UI", "Helvetica Neue", Arial, "Liberation Sans", "DejaVu Sans", sans-serif; }
h1 { font-size: 25px; line-height: 1.25; margin: 0 0 2px; overflow-wrap: break-word; }
h2 { font-size: 18px; margin: 34px 0 10px; padding-top: 12px; border-top: 1px solid #d9d9d9; }
p { margin: 6px 0; max-width: 75ch; overflow-wrap: break-word; }
.under { color: #5a5a5a; margin-bottom: 16px; }
.verdict { border: 1px solid #e3c9b5; border-left: 6px solid #d55e00; background: #fffaf6; padding: 10px 18px 12px; }
.verdict.clean { border-color: #b9d3e6; border-left-color: #0072b2; background: #f7fbfe; }
.verdict p { max-width: none; }
.main { font-size: 18px; line-height: 1.4; font-weight: 600; }
.note, figcaption { color: #4a4a4a; font-size: 13.5px; max-width: none; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; margin: 6px 0; font-size: 14px;
  font-variant-numeric: tabular-nums lining-nums; }
th { text-align: left; font-weight: 600; color: #4a4a4a; border-bottom: 1.5px solid #6b6b6b; padding: 4px 10px 4px 0;
  vertical-align: bottom; }
td { border-bottom: 1px solid #e6e6e6; padding: 5px 10px 5px 0; vertical-align: top; overflow-wrap: break-word; }
td:not(.number) { min-width: 9ch; } td:first-child { min-width: 13ch; }
th.number, td.number { text-align: right; padding-left: 8px; }
td.number { white-space: nowrap; }
th.number + th:not(.number), td.number + td:not(.number) { padding-left: 14px; }
.pairs tbody tr:nth-child(odd) td { border-bottom-color: #f3f3f3; }
.effects td:nth-child(2), .effects td:nth-child(5) { white-space: nowrap; }
.dense { font-size: 13px; } .dense td { padding-top: 2px; padding-bottom: 2px; }
code { font: 12.5px/1.4 "DejaVu Sans Mono", Consolas, Menlo, monospace; color: #3a3a3a; }
code.hash { font-size: 10.5px; overflow-wrap: anywhere; }
pre { white-space: pre-wrap; overflow-wrap: anywhere; background: #f5f5f5; padding: 6px 10px;
  font: 12.5px/1.5 "DejaVu Sans Mono", Consolas, Menlo, monospace; }
.form { display: flex; flex-wrap: wrap; gap: 4px 24px; margin: 0 0 14px; font-size: 13.5px; }
.form div { flex: 1 1 150px; border-bottom: 1px solid #b8b8b8; min-height: 38px; }
.form dt { margin: 0; font-weight: 400; color: #5a5a5a; } .form dd { margin: 0; }
dt { font-weight: 600; margin-top: 8px; } dd { margin: 0 0 4px 18px; max-width: 75ch; overflow-wrap: break-word; }
ul { margin: 6px 0; padding-left: 20px; } li { overflow-wrap: break-word; }
figure { margin: 18px 0 26px; break-inside: avoid; }
figure img { display: block; width: 100%; height: auto; }
figcaption { margin-top: 6px; }
.tabs > input { position: absolute; opacity: 0; }
.tabs > label { display: inline-block; padding: 5px 16px; margin: 0 4px 12px 0; border: 1px solid #b8b8b8;
  border-radius: 4px; cursor: pointer; }
.tabs > input:checked + label { background: #0072b2; border-color: #0072b2; color: #fff; }
.tabs > input:focus-visible + label { outline: 2px solid #d55e00; }
#tab-bench:not(:checked) ~ .pane-bench, #tab-bench:checked ~ .pane-report { display: none; }
.pane-bench { position: relative; left: 50%; width: min(1400px, 100vw - 24px); transform: translateX(-50%); }
.pane-bench iframe { display: block; width: 100%; height: max(900px, 100vh - 120px); border: 1px solid #d9d9d9; }
@media (max-width: 600px) {
  thead { display: none; }
  tr { display: block; border-bottom: 1px solid #c8c8c8; padding: 4px 0; }
  td, td.number, td.number + td:not(.number) { display: flex; gap: 1em; border: 0; padding: 2px 0; text-align: left;
    white-space: normal; }
  td::before { content: attr(data-label); flex: 0 0 38%; color: #6b6b6b; }
  td:not([data-label])::before, td:empty { display: none; }
  td > div { min-width: 0; }
  figure { overflow-x: auto; } figure img { min-width: 640px; } figcaption { position: sticky; left: 0; }
  body { padding: 16px 12px 40px; } h1 { font-size: 21px; } .main { font-size: 16px; }
  .verdict { padding: 8px 12px; } dd { margin-left: 10px; }
}
@media print {
  body { max-width: none; padding: 0; font-size: 10.5pt; }
  h2 { break-after: avoid; } tr, .verdict { break-inside: avoid; }
  .verdict { background: #fff; }
  .tabs > label, .pane-bench { display: none; } #tab-bench:checked ~ .pane-report { display: block; }
}
"""
