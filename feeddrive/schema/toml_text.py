"""TOML files as they are written: read, refused where they cannot be, and the nearest word to a misspelt one."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from feeddrive.errors import InputError

_MOST_CHOICES = 14
"""Words that an error lists; the structures, kinds and channels are fewer."""

MOST_LEVELS = 12
"""Tables inside tables in a file: three times what any of ours needs, and far below what Python can walk through."""


def read_toml(path: Path, kind: str) -> dict[str, Any]:
    """Parse a TOML file of a kind, such as "plant file"; a byte order mark is passed over.

    Raises InputError: not found, not readable, not UTF-8, or not TOML (with line and column).
    """
    where = str(path)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (FileNotFoundError, NotADirectoryError):
        raise InputError(f"no such {kind}", where, "check the name and the folder") from None
    except IsADirectoryError:
        raise InputError(f"is a folder, not a {kind}", where, "name a file in it") from None
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", where, "check the permissions of the file") from None
    except UnicodeDecodeError:
        raise InputError("is not a text in UTF-8", where, "save it as UTF-8") from None
    except ValueError:  # a name that no system knows, such as one with a zero byte
        raise InputError(f"no such {kind}", where, "check the name and the folder") from None
    return parse_toml(text, where)


def parse_toml(text: str, where: str) -> dict[str, Any]:
    """Parse TOML text.

    Raises:
        InputError: not TOML (with line and column), or tables in more than `MOST_LEVELS` levels.
    """
    parse_text: Callable[[str], dict[str, Any]] = tomllib.loads
    try:
        entries = parse_text(text)
    except (ValueError, RecursionError) as error:  # a plain ValueError: an integer beyond Python's digit limit
        raise InputError(f"is not TOML: {error}", where, "correct that line") from None
    refuse_deep(entries, where)
    return entries


_KINDS = {"plant": "plant", "scenario": "scenario", "controller": "controller", "map": "mapping"}
"""Word in the first line of a file, after "feeddrive-", to what the file is."""


def refuse_other_format(entries: Mapping[str, Any], wanted: str, where: str) -> None:
    """Refuse a file whose first line does not say the wanted format.

    Args:
        entries: of the file.
        wanted: such as "feeddrive-plant/1".
        where: for the message.

    Raises:
        InputError: it is another kind of file, by its first line, or none of this version.
    """
    written = str(entries.get("format"))
    if written == wanted:
        return
    kind, other = (_KINDS.get(text.removeprefix("feeddrive-").partition("/")[0]) for text in (wanted, written))
    if other is not None and other != kind:
        raise InputError(f"is a {other} file, not a {kind} file", where, f"name a {kind} file")
    raise InputError(f"is not a {kind} file of this version", where, f'write format = "{wanted}" in its first line')


def refuse_deep(entries: Mapping[str, Any], where: str) -> None:
    """Refuse tables and lists in more than `MOST_LEVELS` levels, which no file of ours has.

    Raises:
        InputError: it is so; names the first key.
    """
    level = list(entries.items())
    for _ in range(MOST_LEVELS):
        level = [(first, inner) for first, value in level for inner in _inside(value)]
    if level:
        raise InputError(
            f"tables or lists in more than {MOST_LEVELS} levels", f"{where}, {level[0][0]}", "write it flat"
        )


def _inside(value: Any) -> Iterable[Any]:
    """What a table or a list holds; nothing of a value."""
    return value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()


def nearest_choice(word: str, choices: Iterable[str]) -> str:
    """The mend for a word that is not among a few: the nearest one, and all of them where they fit into a line."""
    choices = tuple(choices)
    near = difflib.get_close_matches(word, choices, n=1, cutoff=0.5)
    listed = f"write one of {', '.join(choices)}" if len(choices) <= _MOST_CHOICES else ""
    guess = f'did you mean "{near[0]}"?' if near else ""
    return " ".join(part for part in (guess, listed) if part) or nearest(word, choices)


def nearest(word: str, known: Iterable[str]) -> str:
    """The mend for an unknown word: the nearest known one, or all of them where none is near."""
    known = tuple(known)
    begun = [name for name in known if len(word) > 1 and name.startswith(word)]
    near = begun if len(begun) == 1 else difflib.get_close_matches(word, known, n=1, cutoff=0.5)
    return f'did you mean "{near[0]}"?' if near else f"known are {', '.join(known)}"
