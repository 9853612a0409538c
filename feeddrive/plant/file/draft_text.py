"""The text of a drafted plant file: its values, what each section is, and every further key as a comment."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping
from typing import Any

from feeddrive.parts.catalogue.part_files import catalogue
from feeddrive.plant.file.drafting import RESOLUTIONS, Drafted, Wishes
from feeddrive.plant.file.plant_schema import OF_PARTS, PLANT
from feeddrive.schema.key import Key, Kind
from feeddrive.schema.section import Section

_ORDER = (
    "motor", "coupling", "ball_screw", "support", "bearing.near", "bearing.far", "nut", "table", "guide", "damping",
)  # fmt: skip
_UNUSED = ("brake", "belt", "gear", "transmission")
_LEAST_UNIT = {"m": "mm", "rad": "deg", "rad/s": "rev/min", "m/s": "m/min", "N/m": "N/µm", "kg m^2": "kg cm^2"}
_WIDTH = 116


def draft_text(made: Drafted, wishes: Wishes) -> str:
    """The text of a plant file.

    Args:
        made: its values.
        wishes: structure and name.
    """
    lines = [
        f"# {wishes.name}, drafted from the parts catalogue. Values with a source of guess are still to be settled.",
        "# What stands behind # may be written too; `feeddrive keys plant` says what each key means.",
        'format = "feeddrive-plant/1"',
        f'name = "{wishes.name}"',
        f'structure = "{wishes.structure}"',
        'sensor = [{ channel = "motor_torque", kind = "current", at = "motor" },',
        f'          {{ channel = "motor_angle", kind = "encoder", at = "motor", {_resolution("motor_angle")} }},',
        f'          {{ channel = "table_position", kind = "scale", at = "table", {_resolution("table_position")} }}]',
    ]
    for name in _ORDER:
        if name in made.sections:
            lines += ["", *_section(name, made, wishes)]
    for effect in made.sections.get("effect", ()):
        lines += ["", "[[effect]]", *(_line(key, value) for key, value in effect.items())]
    lines += ["", *_further(made, wishes)]
    return "\n".join(lines) + "\n"


def _resolution(channel: str) -> str:
    value, why = RESOLUTIONS[f"{channel}.resolution"]
    return f'resolution = {{ value = "{value}", source = "guess: {why}" }}'


def _section(name: str, made: Drafted, wishes: Wishes) -> list[str]:
    declared = _declared(name)
    written: Mapping[str, Any] = made.sections[name]
    remark = f"    # {made.remarks[name]}" if name in made.remarks else ""
    lines = [f"[{name}]{remark}"]
    for key, value in written.items():
        lines.append(_line(key, value))
        if f"{name}.{key}" in made.guesses and not isinstance(value, Mapping):
            lines += _comment(f"guess: {made.guesses[f'{name}.{key}']}")
    known = [key for key in declared.keys.values() if key.name not in (*written, "source") and _counts(key, wishes)]
    named = written.get("part", written.get("carriage", ""))
    part = catalogue()[named].sections.get(name.partition(".")[0], {}) if named in catalogue() else {}
    return lines + [line for key in known for line in _offered(key, part.get(key.name))]


def _declared(name: str) -> Section:
    section = PLANT
    for step in name.split("."):
        section = section.inner(step)
    return section


def _counts(key: Key, wishes: Wishes) -> bool:
    """Whether a key counts in a machine of parts of that structure."""
    if "where no carriage is named" in key.when or "with a geometry" in key.when:
        return False
    return "structure" not in key.when or f'"{wishes.structure}"' in key.when or OF_PARTS in key.when


def _further(made: Drafted, wishes: Wishes) -> list[str]:
    """Sections that are not used, as comments."""
    lines = ["# Sections that may be added:"]
    for name in _UNUSED:
        keys = [key.name for key in PLANT.inner(name).keys.values() if key.name != "source" and _counts(key, wishes)]
        lines += _comment(f"[{name}] {PLANT.inner(name).meaning}: {', '.join(keys)}")
    effects = ", ".join(PLANT.inner("effect").kinds)
    lines += _comment(f"[[effect]] name = one of {effects}; `feeddrive keys plant.effect.NAME`")
    lines += _comment("[controller], [thermal]: `feeddrive keys plant.controller`, `feeddrive keys plant.thermal`")
    return lines


def _offered(key: Key, printed: object) -> list[str]:
    """A key that may be written, as a comment; with what the part gives it where it does."""
    if printed is not None:
        return _comment(f"{key.name} = {_toml(printed)}  # of the part: {key.meaning}")
    ends = f", usual {key.usual_range}" if key.usual else ""
    default = f", {key.default} if left out" if key.default else ""
    return _comment(f"{key.name} = {_blank(key)}  # {key.meaning}{default}{ends}")


def _blank(key: Key) -> str:
    """What a value of the key looks like."""
    if key.choices:
        return " | ".join(f'"{choice}"' for choice in key.choices)
    if key.kind in (Kind.WHOLE, Kind.SWITCH) or key.unit == "1":
        return "..."
    one = f'"... {_LEAST_UNIT.get(key.unit, key.unit)}"' if key.unit else '"..."'
    return f"[{one}, {one}]" if key.kind is Kind.QUANTITIES else one


def _comment(text: str) -> list[str]:
    return textwrap.wrap(text, _WIDTH, initial_indent="# ", subsequent_indent="#   ", break_on_hyphens=False)


def _line(key: str, value: Any) -> str:
    return f"{key} = {_toml(value)}"


def _toml(value: Any) -> str:
    if isinstance(value, Mapping):
        return f"{{ {', '.join(_line(key, one) for key, one in value.items())} }}"
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, Iterable):
        return f"[{', '.join(map(_toml, value))}]"
    return f"{value}"
