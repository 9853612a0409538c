"""One page per effect, from its file: what stands there is shown, and what it does to a residual is computed."""

from __future__ import annotations

import inspect
import math
import re
import sys
from dataclasses import replace
from pathlib import Path

import planted

from feeddrive.diagnosis.finding.candidates import CANDIDATES
from feeddrive.effects.base import Effect, Kind, Parameter
from feeddrive.effects.catalogue import EFFECTS, THERMAL_EFFECTS
from feeddrive.report.words.words import effect_words
from feeddrive.units.quantity import format_quantity

KINDS: dict[Kind, str] = {
    Kind.FRICTION: "Friction",
    Kind.TRANSMISSION: "Transmission",
    Kind.TRAVEL: "Travel",
    Kind.CHAIN: "Masses and stiffnesses",
    Kind.SOURCE: "Forces and torques",
    Kind.DRIVE: "Drive",
    Kind.TIMING: "Timing",
    Kind.SENSOR: "Sensors",
    Kind.HEAT: "Heat",
}
"""Headings of the list, in its order."""

DECLARED = "declared"
DISTINGUISHES = 1.0
"""Least error that a nearest imitator must leave, over the noise, for a scenario to distinguish it from the
effect: as much as the noise itself is seen over hundreds of independent values of a recording."""


def effects() -> dict[str, type[Effect]]:
    """Every effect by its name."""
    return {**EFFECTS, **THERMAL_EFFECTS}


def write_effect_pages(folder: Path, recovery: Path) -> None:
    """Write a page per effect and their list.

    Args:
        folder: for the pages; pictures are kept in it.
        recovery: docs/recovery.md, of which the row of each effect is quoted.
    """
    folder.mkdir(parents=True, exist_ok=True)
    rates = recovery_rates(recovery)
    for name, effect in effects().items():
        (folder / f"{name}.md").write_text(page(effect, folder, rates), encoding="utf-8")
    (folder / "index.md").write_text(index(), encoding="utf-8")


def index() -> str:
    """The list of all effects, by what they do."""
    parts = [
        "# Effects\n",
        "What a feed drive can have beyond its masses and springs. A plant file declares an effect in a block "
        '`[[effect]]` with `name = "…"`; `feeddrive diagnose` looks for those that are not declared. Each is one file '
        "in `feeddrive/effects/`, from which its page here is made.\n",
    ]
    for kind, words in KINDS.items():
        members = [one for one in effects().values() if one.kind == kind]
        if members:
            parts += [f"## {words}\n", "| effect | what it is | keys |", "|---|---|---|"]
            parts += [f"| [`{one.name}`]({one.name}.md) | {effect_words(one.name)} | {_keys(one)} |" for one in members]
            parts.append("")
    names = "\n".join(effects())
    return "\n".join([*parts, f"```{{toctree}}\n:hidden:\n\n{names}\n```\n"])


def page(effect: type[Effect], folder: Path, rates: dict[str, dict[str, str]]) -> str:
    """The page of one effect."""
    sentence, rest = documented(effect)
    parts = [
        f"# `{effect.name}`\n",
        f"**{_capital(effect_words(effect.name))}.** {sentence}\n",
        rest,
        "## In a plant file\n",
        written(effect),
        parameter_table(effect),
        "## Where it acts, and where it shows\n",
        facts(effect),
        picture(effect, folder),
        found_by(effect, rates),
    ]
    return "\n".join(part for part in parts if part) + "\n"


def documented(effect: type[Effect]) -> tuple[str, str]:
    """First sentence and the rest of the file that holds the law: equation, symbols, source."""
    text = inspect.cleandoc(sys.modules[effect.__module__].__doc__ or "")
    first, _, rest = text.partition("\n\n")
    rest = re.sub(r"`feeddrive\.[\w.]+`", lambda match: f"`{match[0].strip('`').rsplit('.', 1)[-1]}`", rest)
    return " ".join(first.split()), f"## Law\n\n{rest}\n"


def written(effect: type[Effect]) -> str:
    """The block of a plant file, at the size of the pictures where there is one."""
    values = planted.SIZES.get(effect.name)
    if values is None:
        return ""
    lines = [
        "```toml",
        "[[effect]]",
        f'name = "{effect.name}"',
        *(f'{key} = "{value}"' for key, value in values.items()),
    ]
    text = "\n".join([*lines, "```\n"])
    return re.sub(r'= "(-?[\d.]+)"$', r"= \1", text, flags=re.MULTILINE)


def parameter_table(effect: type[Effect]) -> str:
    """Keys with unit, physical range and default."""
    rows = ["| key | unit | physical range | default |", "|---|---|---|---|"]
    if effect.place_key:
        words = ", ".join(f'`"{one}"`' for one in effect.places) or "a word that the machine knows"
        default = f'`"{effect.default_place}"`' if effect.default_place else "must be given"
        rows.append(f"| `{effect.place_key}` | word | {words} | {default} |")
    for one in effect.parameters:
        default = (
            "must be given"
            if one.default is None
            else ("none" if one.table else format_quantity(one.default, one.unit))
        )
        rows.append(f"| `{one.key}` | {one.unit} | {_range(one)} | {default} |")
    return "\n".join(rows) + "\n"


def _range(parameter: Parameter) -> str:
    low, high = parameter.minimum, parameter.maximum
    if parameter.table:
        inside = _range(replace(parameter, table=False))
        return "a list" if inside == "any" else f"a list, each {inside}"
    if math.isinf(low) and math.isinf(high):
        return "any"
    if math.isinf(high):
        return f"{format_quantity(low, parameter.unit)} or more"
    return f"{format_quantity(low, parameter.unit)} to {format_quantity(high, parameter.unit)}"


def facts(effect: type[Effect]) -> str:
    """Kind, ports, signature, what a recording must hold."""
    alike = ", ".join(f"[`{name}`]({name}.md)" for name in effect.signature.confused_with) or "none known"
    rows = {
        "kind": str(effect.kind),
        "port": ", ".join(map(str, effect.ports)),
        "shows in": ", ".join(f"`{name}`" for name in effect.signature.channels),
        "as a function of": effect.signature.variable.replace("_", " "),
        "can look like": alike,
        "a recording must hold": needed(effect),
    }
    return "\n".join(["| | |", "|---|---|", *(f"| {key} | {value} |" for key, value in rows.items())]) + "\n"


def needed(effect: type[Effect]) -> str:
    """What a recording must hold, as the search asks for it."""
    for one in CANDIDATES:
        if one.name == effect.name:
            return (inspect.getdoc(one.needs) or "").splitlines()[0]
    if getattr(effect, "declared", False):
        return "It is declared; a level other than declared is found as [`friction_deviation`](friction_deviation.md)."
    if effect.kind == Kind.HEAT:
        return "Temperatures or growth over time, with the speed of the screw."
    return "Nothing: it carries, as a table, what no name explains."


def picture(effect: type[Effect], folder: Path) -> str:
    """What the effect leaves in a residual, and which scenario distinguishes it from its imitators."""
    one = planted.planted(effect.name)
    if one is None:
        return ""
    rows = planted.drawn(folder, one)["rows"]
    size = ", ".join(f"{key} {value}" for key, value in planted.SIZES[effect.name].items()).replace(" um", " µm")
    figure = f"```{{figure}} {effect.name}.png\n:alt: residual with {effect.name}\n\n"
    if effect.kind == Kind.HEAT:
        caption = f"`thermal_bench` at 750 rev/min for three hours, with {size} less without it."
        return f"## What it does\n\n{figure}{caption}\n```\n"
    text = f"{figure}`bench_axis` with {size}, less what the declared machine predicts from the motor motion.\n```\n"
    return f"## What it leaves in a residual\n\n{text}\n{scenarios_of(rows)}"


def scenarios_of(rows: list[dict[str, object]]) -> str:
    """The scenarios with what each leaves of the nearest imitators."""
    names = list(rows[0]["imitated"])  # type: ignore[call-overload]
    head = "".join(f" | with `{name}` fitted instead" for name in names)
    lines = [
        "## Which scenario shows it best\n",
        _verdict(rows, names),
        f"| scenario | declared machine{head} |",
        f"|---|---{'|---' * len(names)}|",
    ]
    for row in rows:
        imitated: dict[str, float] = row["imitated"]  # type: ignore[assignment]
        cells = "".join(f" | {_times(imitated[name])}" for name in names)
        lines.append(
            f"| [`{row['scenario']}`](../reference/scenarios.md) | {_times(float(str(row['declared'])))}{cells} |"
        )
    lines.append(
        "\nErrors are rms over the noise of the sensors, all channels together, no noise drawn: 1 is as large as it.\n"
    )
    return "\n".join(lines)


def _verdict(rows: list[dict[str, object]], names: list[str]) -> str:
    best = rows[0]
    left: dict[str, float] = best["imitated"]  # type: ignore[assignment]
    scenario = best["scenario"]
    if not names:
        return f"`{scenario}` shows it most clearly. Nothing in the catalogue looks like it.\n"
    nearest = min(left, key=lambda name: left[name])
    if left[nearest] >= DISTINGUISHES:
        rest = f"its nearest imitator, `{nearest}`, leaves {_times(left[nearest])} times the noise."
        return f"`{scenario}` distinguishes it: {rest}\n"
    return (
        f"At this size no shipped scenario settles it on this machine by itself. `{scenario}` comes nearest: "
        f"`{nearest}` in its place leaves {_times(left[nearest])} times the noise.\n"
    )


def _times(value: float) -> str:
    return f"{value:.0f}" if value >= 10 else f"{value:.2g}" if value >= 0.005 else "0"


def recovery_rates(path: Path) -> dict[str, dict[str, str]]:
    """Effect to its row in the table of docs/recovery.md; empty where there is none."""
    text = path.read_text(encoding="utf-8") if path.is_file() else ""
    found: dict[str, dict[str, str]] = {}
    for table in re.findall(r"(?:^\|[^\n]*\n)+", text, re.MULTILINE):
        head, *rows = [[cell.strip() for cell in line.strip("|\n ").split("|")] for line in table.splitlines()]
        if head[0] == "effect":
            for cells in rows[1:]:
                found.setdefault(cells[0].strip("`"), dict(zip(head, cells, strict=False)))
    return found


def found_by(effect: type[Effect], rates: dict[str, dict[str, str]]) -> str:
    """How often it is found where an independent simulator planted it."""
    row = rates.get(effect.name)
    if row is None:
        return ""
    sizes = [(key, row[key]) for key in ("2%", "10%", "50%") if key in row]
    counts = ", ".join(f"{value} where it makes up {key.replace('%', ' %')} of the error" for key, value in sizes)
    rest = "All cases: [recovery](../../recovery.md)."
    return f"## How often it is found\n\nNamed right, and nothing else: {counts}. {rest}\n"


def _keys(effect: type[Effect]) -> str:
    words = [effect.place_key] * bool(effect.place_key) + [one.key for one in effect.parameters]
    return ", ".join(f"`{word}`" for word in words)


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
