"""Values written into the text of a plant file, comments and order kept; checked by reading the text again."""

from __future__ import annotations

import re
from collections.abc import Mapping

from feeddrive.errors import InputError
from feeddrive.plant.file.entries import parse_toml

_HEADER = re.compile(r"^\s*\[([^\[\]]+)\]\s*(#.*)?$")
_LIST_HEADER = re.compile(r"^\s*\[\[([^\[\]]+)\]\]\s*(#.*)?$")


def with_written_values(text: str, changed: Mapping[str, tuple[str, str, str]]) -> str:
    """The text with other values.

    Args:
        text: TOML.
        changed: dotted key to value with its unit, tolerance and source; `effect.NAME.key` names an effect.

    Raises:
        InputError: a text in which a value cannot be placed.
    """
    for key, (value, tolerance, source) in changed.items():
        entry = f'{{ value = "{value}", tolerance = "{tolerance}", source = "{source}" }}'
        text = _placed(text, key, entry)
        read = _found(parse_toml(text, "plant with other values"), key)
        if not isinstance(read, Mapping) or read.get("value") != value:
            raise InputError(
                f"{key} cannot be written into this plant file", key, "write it by hand, on a line of its own"
            )
    return text


def _placed(text: str, key: str, entry: str) -> str:
    section, _, last = key.rpartition(".")
    lines = text.splitlines()
    start, end = _section(lines, section)
    assignment = re.compile(rf"^\s*{re.escape(last)}\s*=")
    for place in range(start, end):
        if assignment.match(lines[place]):
            comment = re.search(r"\s#(?=[^\"]*$).*$", lines[place])
            lines[place] = f"{last} = {entry}{comment.group(0) if comment else ''}"
            return "\n".join(lines) + "\n"
    if start == len(lines):
        lines += ["", f"[{section}]"]
        return "\n".join([*lines, f"{last} = {entry}"]) + "\n"
    return "\n".join([*lines[:start], f"{last} = {entry}", *lines[start:]]) + "\n"


def _section(lines: list[str], section: str) -> tuple[int, int]:
    """First line after the section's header and the line after its last; the end of the file where there is none."""
    of_effect = section.startswith("effect.")
    begun = None
    for number, line in enumerate(lines):
        header, listed = _HEADER.match(line), _LIST_HEADER.match(line)
        if begun is not None and (header or listed):
            return begun, number
        if of_effect and begun is None and re.match(rf'^\s*name\s*=\s*"{re.escape(section[7:])}"', line):
            begun = number + 1
        if header and header.group(1).strip() == section:
            begun = number + 1
    return (len(lines), len(lines)) if begun is None else (begun, len(lines))


def _found(entries: Mapping[str, object], key: str) -> object:
    at: object = entries
    for step in key.split("."):
        if isinstance(at, list):
            at = next((one for one in at if isinstance(one, Mapping) and one.get("name") == step), None)
        else:
            at = at.get(step) if isinstance(at, Mapping) else None
    return at
