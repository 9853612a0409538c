"""Values put in the place of what a scenario file says: `controller.position_gain=5 (m/min)/mm`."""

from __future__ import annotations

import copy
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from feeddrive.errors import InputError
from feeddrive.files import find_plant
from feeddrive.schema.toml_text import refuse_deep


def parse_overrides(texts: list[str]) -> dict[str, str]:
    """Dotted key to value of texts such as "trajectory.velocity=0.2 m/s".

    Raises:
        InputError: no "=", an empty key, or a key given twice.
    """
    found: dict[str, str] = {}
    for text in texts:
        key, sign, value = (part.strip() for part in text.partition("="))
        if not sign or not key or not value:
            raise InputError(f'"{text}" is not key=value', "--set", 'write e.g. --set trajectory.velocity="0.2 m/s"')
        if key in found:
            raise InputError(f"{key} is set twice", "--set", "keep one of them")
        found[key] = value
    return found


_FILES = re.compile(r"plant|controller|force\.[^.]+\.path")
"""Keys of a scenario that name a file."""


def with_absolute_paths(overrides: Mapping[str, str]) -> dict[str, str]:
    """The overrides of a scenario with every path absolute: what is typed counts from the current folder.

    What the file itself says counts from the folder of the file.

    Raises:
        InputError: a plant that is neither a file nor a shipped one.
    """
    return {key: _absolute(key, text) if _FILES.fullmatch(key) else text for key, text in overrides.items()}


def _absolute(key: str, text: str) -> str:
    if key != "plant":
        return str(Path(text).absolute())
    try:
        return str(find_plant(text).absolute())
    except InputError as error:
        raise InputError(error.what, f"--set {key}={text}", f"{error.mend}; paths count from {Path.cwd()}") from None


def with_overrides(entries: Mapping[str, Any], overrides: Mapping[str, str]) -> dict[str, Any]:
    """The entries with values put in; tables that are not there are made.

    Entries of lists are counted from 1, or called by their `name`.

    Raises:
        InputError: a key that leads into something that is no table, or to an entry that a list does not have.
    """
    result: dict[str, Any] = copy.deepcopy(dict(entries))
    for key, text in overrides.items():
        *path, last = key.split(".")
        at: Any = result
        for step in path:
            at = _inside(at, step, key)
        if isinstance(at, list):
            at[_place(at, last, key)] = _value(text)
        else:
            at[last] = _value(text)
        refuse_deep(result, f"--set {key}")
    return result


def _inside(at: Any, step: str, key: str) -> Any:
    """The table or list one step further."""
    if isinstance(at, list):
        return at[_place(at, step, key)]
    inner = at.setdefault(step, {})
    if not isinstance(inner, dict | list):
        raise InputError(f'"{step}" is a value, not a table', f"--set {key}", "leave out what follows it")
    return inner


def _place(entries: list[Any], step: str, key: str) -> int:
    """Where in a list an entry stands that is called by its number or its name."""
    names = [entry.get("name") for entry in entries if isinstance(entry, dict)]
    if names.count(step) == 1:
        return names.index(step)
    if not step.isdecimal() or len(step) > 9 or not 1 <= int(step) <= len(entries):  # a longer one is no count
        named = f", or name one of {', '.join(map(str, names))}" if any(names) else ""
        raise InputError(f"no entry {step}", f"--set {key}", f"count from 1 to {len(entries)}{named}")
    return int(step) - 1


def _value(text: str) -> Any:
    """A TOML value where the text is one, such as 5, true or ["1 mm", "2 mm"]; else the text itself."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except (ValueError, RecursionError):  # no TOML, or a number of too many digits, or too deep
        return text
