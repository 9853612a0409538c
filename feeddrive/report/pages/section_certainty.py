"""What the report says of certainty: effects that look alike, what to record next, correlation, the simulated loop."""

from __future__ import annotations

from feeddrive.diagnosis.certainty.certainty_result import Ambiguity, Correlation, NextExperiment
from feeddrive.diagnosis.judging.result import Diagnosis, ParameterResult
from feeddrive.diagnosis.simulated.simulation_result import ErrorFigure, RefinedValue, SimulationResult
from feeddrive.effects.base import Value
from feeddrive.report.pages.markup import Cell, bullets, paragraph, section, table
from feeddrive.report.words.number_text import DASH, error_text, fixed, significant, with_unit
from feeddrive.report.words.parameters import parameter_text
from feeddrive.report.words.words import effect_words, joined, plain

_LARGEST_MATRIX = 10
_SCENARIOS_SHOWN = 4


def ambiguous_section(diagnosis: Diagnosis) -> str:
    """Sets of effects that these data cannot tell apart, the reason, and the experiment that would."""
    lines = [joined([f"{effect_words(name)} ({name})" for name in names]) for names in diagnosis.ambiguous]
    if not lines:
        return ""
    reasons = "".join(paragraph(f"{_names(one)}: {one.reason}") for one in diagnosis.alike)
    note = (
        "Each of a set explains these data within 5 % of the same error, and the data give less than 20 to 1 "
        "against it. The one with fewest parameters was taken."
    )
    return section("What these data cannot tell apart", bullets(lines), reasons, paragraph(note, "note"))


def experiments_section(diagnosis: Diagnosis) -> str:
    """Scenarios that would settle what is open."""
    if not diagnosis.next_experiments:
        return ""
    listed = bullets([_sentence(one) for one in diagnosis.next_experiments])
    rows = [_ranked(one) for one in diagnosis.next_experiments if one.ranking]
    heads = ["Question", "Scenarios, the best first"]
    note = (
        "Every shipped scenario that this axis can run was run by the plant with the effects found. To tell apart: "
        "distance of the two predictions in standard deviations of the sensor noise after the rival is fitted to both "
        "recordings; 3 is a hint, 5 settles it. To know better: width of the interval after it over that before."
    )
    return section("Which experiment next", listed, table(heads, rows) if rows else "", paragraph(note, "note"))


def correlation_section(diagnosis: Diagnosis) -> str:
    """Correlations of the fitted parameters, the condition number, and which are known only together."""
    known = diagnosis.correlation
    if known is None:
        return ""
    warned = bullets(known.remarks) if known.remarks else paragraph("No two parameters are known only together.")
    condition = paragraph(f"Condition number of what was fitted: {significant(known.condition, 2)}.")
    note = (
        "Correlation of the errors of two parameters: near ±1 they can be changed together at hardly any cost, and "
        "each is known only with the other. A condition number above 30 says the same of several at once."
    )
    return section("Which parameters hang together", warned, _matrix(known), condition, paragraph(note, "note"))


def experiment_sentences(diagnosis: Diagnosis) -> list[str]:
    """What to run next, one sentence each."""
    return [f"{_sentence(one)}." for one in diagnosis.next_experiments]


def _sentence(one: NextExperiment) -> str:
    return one.sentence[:1].upper() + one.sentence[1:]


def _names(one: Ambiguity) -> str:
    return joined([effect_words(name) for name in one.names])


def _ranked(one: NextExperiment) -> list[str | Cell]:
    question = f"{plain(one.question[0])} known better" if len(one.question) == 1 else joined(list(one.question))
    shown = [f"{name} {significant(figure, 2)}" for name, figure in one.ranking[:_SCENARIOS_SHOWN]]
    return [question, ", ".join(shown)]


def _matrix(known: Correlation) -> str:
    """The matrix below its diagonal; nothing where it is too large to be read."""
    if len(known.names) > _LARGEST_MATRIX:
        return ""
    heads = ["", *(f"#{_short(name)}" for name in known.names[:-1])]
    rows = [
        [
            _short(name),
            *(_signed(known.matrix[i][j]) if j < i else DASH for j in range(len(known.names) - 1)),
        ]
        for i, name in enumerate(known.names)
        if i > 0
    ]
    return table(heads, rows)


def _signed(rho: float) -> str:
    """A correlation with its sign; nothing has none."""
    text = fixed(rho, 2)
    return f"+{text}" if float(f"{rho:.2f}") > 0 else text


def _short(name: str) -> str:
    effect, _, key = name.rpartition(".")
    return f"{effect_words(effect)}: {plain(key)}"


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
        heads = ["Channel", "#before", "#after"]
        rows = [[plain(run.channel), _percent(run.before), _percent(run.after)]]
    else:
        kinds = ("declared", "as attributed", "refined in simulation", "as reported")
        heads = ["Channel", *(f"#{kind}" for kind in kinds)]
        figures = [(c.name, c.unit, c.before, c.after_attribution, c.after_refinement, c.after) for c in run.channels]
        rows = [[plain(name), *(_cell(one, unit) for one in each)] for name, unit, *each in figures]
    kept_back = [f"{effect_words(name)}: {reason}" for name, reason in run.not_refined.items()]
    stated = paragraph(run.statement) if run.statement else ""
    stayed = paragraph("Not refined:") + bullets(kept_back) if kept_back else ""
    parts = (table(heads, rows), stated, _refined(run), stayed, paragraph(NOTE, "note"))
    return section("Closed-loop simulation error", *parts)


def simulation_lines(run: SimulationResult) -> list[str]:
    """The closed loop in lines for the terminal."""
    change = f"{_percent(run.before)} before, {_percent(run.after)} after"
    lines = [f"closed-loop simulation, {run.channel}, unfiltered: {change}"]
    named = run.after_refinement if run.kept else run.after_attribution
    alone = ""
    if named is not None and _percent(named) != _percent(run.after):
        lines[0] += " with the tables of what no name explains"
        alone = "effects alone: "
    if run.after_attribution is not None and run.after_refinement is not None:
        figures = f"as attributed {_percent(run.after_attribution)}, refined {_percent(run.after_refinement)}"
        lines[0] += f" ({alone}{figures})"
    lines += [f"  {run.statement}"] if run.statement else []
    lines += [f"  not refined: {name}, {reason}" for name, reason in run.not_refined.items()]
    return lines


def _refined(run: SimulationResult) -> str:
    """Values before and after the refinement."""
    if not run.refined:
        return ""
    heads = ["Value", "#as attributed", "#refined" if run.kept else "refined, not kept"]
    return table(heads, [_refined_row(one) for one in run.refined])


def _refined_row(one: RefinedValue) -> list[str | Cell]:
    shown = [parameter_text(one.key, ParameterResult(_plain(v), one.unit)).value for v in (one.before, one.after)]
    return [f"{effect_words(one.effect)}, {plain(one.key)}", *shown]


def _plain(value: Value) -> float | list[float]:
    return list(value) if isinstance(value, tuple) else value


def _cell(figure: ErrorFigure | None, unit: str) -> str:
    return DASH if figure is None else f"{error_text(figure.rms, unit)}, {_percent(figure.relative)}"


def _percent(share: float) -> str:
    """Two decimals, so that what a refinement gains is seen."""
    return with_unit(fixed(100 * share, 2), "%")
