"""The closed loop in the report and on the terminal: simulation errors, and what was refined in simulation."""

from __future__ import annotations

from feeddrive.diagnosis.judging.result import Diagnosis, ParameterResult
from feeddrive.diagnosis.simulated.simulation_result import ErrorFigure, RefinedValue, SimulationResult
from feeddrive.effects.base import Value
from feeddrive.report.pages.markup import Cell, bullets, number, paragraph, section, table, words
from feeddrive.report.parameters import parameter_text
from feeddrive.report.words.people import DASH, error_text, fixed, with_unit
from feeddrive.report.words.words import effect_words, plain

NOTE = (
    "The closed loop simulated from the set-point alone with the declared controller, over the judged samples in which "
    "it commanded the torque; unfiltered. Torque in shares of its rms, table position in shares of the following error."
)


def simulation_section(diagnosis: Diagnosis) -> str:
    """Closed-loop simulation error, where there is one, and the values that the refinement tried."""
    run = diagnosis.simulation
    if run is None:
        return ""
    if not run.channels:
        heads = [words("Channel"), number("before"), number("after")]
        rows = [[words(plain(run.channel)), number(_percent(run.before)), number(_percent(run.after))]]
    else:
        kinds = ("declared", "as attributed", "refined in simulation", "as reported")
        heads = [words("Channel"), *map(number, kinds)]
        figures = [(c.name, c.unit, c.before, c.after_attribution, c.after_refinement, c.after) for c in run.channels]
        rows = [[words(plain(name)), *(_cell(one, unit) for one in each)] for name, unit, *each in figures]
    kept_back = [f"{effect_words(name)}: {reason}" for name, reason in run.not_refined.items()]
    told = paragraph(run.statement) if run.statement else ""
    stayed = paragraph("Not refined:") + bullets(kept_back) if kept_back else ""
    parts = (table(heads, rows), told, _refined(run), stayed, paragraph(NOTE, "note"))
    return section("Closed-loop simulation error", *parts)


def simulation_lines(run: SimulationResult) -> list[str]:
    """The closed loop in lines for the terminal."""
    change = f"{_percent(run.before)} before, {_percent(run.after)} after"
    lines = [f"closed-loop simulation, {run.channel}, unfiltered: {change}"]
    if run.after_attribution is not None and run.after_refinement is not None:
        lines[0] += f" (as attributed {_percent(run.after_attribution)}, refined {_percent(run.after_refinement)})"
    lines += [f"  {run.statement}"] if run.statement else []
    lines += [f"  not refined: {name}, {reason}" for name, reason in run.not_refined.items()]
    return lines


def _refined(run: SimulationResult) -> str:
    """Values before and after the refinement."""
    if not run.refined:
        return ""
    heads = [words("Value"), number("as attributed"), number("refined" if run.kept else "refined, not kept")]
    return table(heads, [_refined_row(one) for one in run.refined])


def _refined_row(one: RefinedValue) -> list[Cell]:
    shown = [parameter_text(one.key, ParameterResult(_plain(v), one.unit)).value for v in (one.before, one.after)]
    return [words(f"{effect_words(one.effect)}, {plain(one.key)}"), *map(number, shown)]


def _plain(value: Value) -> float | list[float]:
    return list(value) if isinstance(value, tuple) else value


def _cell(figure: ErrorFigure | None, unit: str) -> Cell:
    return number(DASH if figure is None else f"{error_text(figure.rms, unit)}, {_percent(figure.relative)}")


def _percent(share: float) -> str:
    """Two decimals, so that what a refinement gains is seen."""
    return with_unit(fixed(100 * share, 2), "%")
