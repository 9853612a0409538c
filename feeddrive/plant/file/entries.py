"""Reading one table of a plant file: quantities with unit, source and tolerance, and nothing unknown."""

from __future__ import annotations

import difflib
import re
import tomllib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from feeddrive.effects.base import Value
from feeddrive.errors import InputError, quoted
from feeddrive.schema.key import Key
from feeddrive.schema.section import Section, UndeclaredKeyError
from feeddrive.units.quantity import parse

_TABLE_KEYS = ("value", "source", "tolerance")

_OBEYED = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069]")
"""Letters that a terminal, an editor or a browser obeys: controls but line ends and tabs, and turns of direction."""

_MOST_CHOICES = 14
"""Words that an error lists; the structures, kinds and channels are fewer."""

MOST_LEVELS = 12
"""Tables inside tables in a file: three times what any of ours needs, and far below what Python can walk through."""


@dataclass
class Origins:
    """Where the values come from, gathered while a file is read: value key to source."""

    found: dict[str, str] = field(default_factory=dict)

    def note(self, key: str, source: str, tolerance: str) -> None:
        """Remember the source of a value and how well it is known; a value without either is not noted."""
        spread = f"± {tolerance.removeprefix('±').strip()}" if tolerance else ""
        text = ", ".join(part for part in (source, spread) if part)
        if text:
            self.found[key] = text


@dataclass(frozen=True)
class Table:
    """A table of a plant file.

    Attributes:
        entries: what stands in it.
        where: file and table, for messages.
        origins: gathers the sources.
        source: of every value that names none itself.
        section: that declares its keys; a key that it does not hold cannot be read. None for a table of any keys.
    """

    entries: Mapping[str, Any]
    where: str
    origins: Origins
    source: str = ""
    section: Section | None = None

    def place(self, key: str) -> str:
        """File, table and key, for messages."""
        return f"{self.where}.{key}"

    def refuse_unknown(self, known: Iterable[str], elsewhere: Mapping[str, str] | None = None) -> None:
        """Refuse keys that are not among `known`.

        Args:
            known: keys that may stand here.
            elsewhere: keys that mean something under other circumstances, to what is to be done then.

        Raises:
            InputError: unknown key; names the nearest known one.
        """
        known = tuple(known)
        if self.section is not None and (undeclared := set(known) - set(self.section.names())):
            raise UndeclaredKeyError(f"{self.section.path} declares no {', '.join(sorted(undeclared))}")
        for key in self.entries:
            if key not in known:
                mend = (elsewhere or {}).get(key) or self._counts_elsewhere(key) or nearest(key, known)
                raise InputError(f'unknown key "{key}"', self.where, mend)

    def refuse_undeclared(self, elsewhere: Mapping[str, str] | None = None) -> None:
        """Refuse keys that the section does not declare; arguments and errors as `refuse_unknown`."""
        assert self.section is not None
        self.refuse_unknown(self.section.names(), elsewhere)

    def of_kind(self, word: str) -> Table:
        """The table with the keys of one kind alone, as its section declares them."""
        return self if self.section is None else replace(self, section=self.section.of_kind(word))

    def quantity(
        self,
        key: str,
        unit: str = "",
        origin: str = "",
        usual: tuple[float, float] | None = None,
        may_vanish: bool = False,
    ) -> float:
        """A value in SI.

        Args:
            key: in this table.
            unit: SI unit; that of the declaration if left out.
            origin: key under which its source is noted.
            usual: range in which this very key is usual [unit]; that of its unit where it is None.
            may_vanish: whether a value next to zero means the same as zero.

        Raises:
            InputError: missing, without unit, of another dimension, not a number, or a million times outside of what
                is usual.
        """
        declared = self._declared(key)
        unit = self._unit(declared, key, unit)
        usual = usual or (declared.usual if declared else None)
        written = self._written(key, origin, unit)
        if isinstance(written, list):
            mend = _with(f'write e.g. {key} = "1 {unit}"', declared)
            raise InputError("is a list, one value is needed", self.place(key), mend)
        return self._parsed(declared, written, unit, self.place(key), usual, may_vanish)

    def quantities(self, key: str, unit: str = "", origin: str = "") -> Value:
        """A value in SI, or a list of them as a tuple, which may pass through zero.

        Raises:
            InputError: as `quantity`, and an empty list.
        """
        declared = self._declared(key)
        unit = self._unit(declared, key, unit)
        written = self._written(key, origin, unit)
        if not isinstance(written, list):
            return self._parsed(declared, written, unit, self.place(key), None, True)
        if not written:
            raise InputError("is an empty list", self.place(key), _with(f'write e.g. {key} = ["1 {unit}"]', declared))
        places = (f"{self.place(key)}[{i}]" for i in range(len(written)))
        pairs = zip(written, places, strict=True)
        return tuple(self._parsed(declared, item, unit, place, None, True) for item, place in pairs)

    def whole(self, key: str, least: int, most: int, default: int | None = None) -> int:
        """A whole number.

        Args:
            key: in this table.
            least, most: ends of what is possible.
            default: where it is left out; None if it must be given.

        Raises:
            InputError: missing without a default, not a whole number, or outside of what is possible.
        """
        declared = self._declared(key)
        value = self.entries.get(key, default)
        if value is None:
            raise InputError("is missing", self.place(key), _with(f"write {key} = {max(least, 1)}", declared))
        if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
            what = f"{quoted(value)} is not a whole number from {least} to {most}"
            raise InputError(what, self.place(key), _with(f"write e.g. {key} = {max(least, 1)}", declared))
        return value

    def text(self, key: str, default: str | None = None) -> str:
        """A text.

        Raises:
            InputError: missing without a default, empty, not a text, or with letters that a terminal obeys.
        """
        declared = self._declared(key)
        value = self.entries.get(key, default)
        if value is None:
            raise InputError("is missing", self.place(key), _with(f'write {key} = "..."', declared))
        if not isinstance(value, str) or (key in self.entries and not value.strip()):
            raise InputError(f"{value!r} is not a text", self.place(key), f'write {key} = "..."')
        if found := _OBEYED.search(value):
            raise InputError(f"holds {quoted(found[0])}, which is no letter", self.place(key), "take it out")
        return value

    def choice(self, key: str, allowed: Iterable[str], default: str | None = None) -> str:
        """One of some words.

        Raises:
            InputError: as `text`, and a word that is not among them.
        """
        allowed = tuple(allowed)
        declared = self._declared(key)
        if (
            declared is not None
            and declared.choices
            and (set(allowed) - set(declared.choices) or declared.default != default)
        ):
            raise UndeclaredKeyError(f"{key} is declared as one of {declared.choices}, by default {declared.default}")
        if key not in self.entries and default is None:
            raise InputError("is missing", self.place(key), f"write one of {', '.join(allowed)}")
        value = self.text(key, default)
        if value not in allowed:
            raise InputError(f'"{value}" is not possible', self.place(key), nearest_choice(value, allowed))
        return value

    def table(self, key: str) -> Table:
        """A table inside this one; an empty one where there is none.

        Raises:
            InputError: not a table.
        """
        entries = self.entries.get(key, {})
        if not isinstance(entries, dict):
            raise InputError("is not a table", self._below(key), f"write it as [{key}]")
        return self._inner(key, entries, self._below(key))

    def tables(self, key: str) -> list[Table]:
        """The tables of an array `[[key]]`; none where there is none.

        Raises:
            InputError: not an array of tables.
        """
        listed = self.entries.get(key, [])
        if not isinstance(listed, list) or not all(isinstance(entries, dict) for entries in listed):
            raise InputError("is not a list of tables", self._below(key), f"write each as [[{key}]]")
        return [self._inner(key, entries, f"{self._below(key)} {i}") for i, entries in enumerate(listed, 1)]

    def _below(self, key: str) -> str:
        return f"{self.where}, {key}"

    def _inner(self, key: str, entries: Mapping[str, Any], where: str) -> Table:
        section = None if self.section is None else self.section.inner(key)
        plain = Table(entries, where, self.origins)
        return Table(entries, where, self.origins, plain.text("source", self.source), section)

    def _declared(self, key: str) -> Key | None:
        return None if self.section is None else self.section.key(key)

    def _unit(self, declared: Key | None, key: str, unit: str) -> str:
        """The unit to read a key in: the declared one, which a reader may repeat but not contradict."""
        if declared is None or not declared.unit:
            return unit
        if unit not in ("", declared.unit):
            raise UndeclaredKeyError(f"{key} is declared in {declared.unit} and read in {unit}")
        return declared.unit

    def _parsed(
        self,
        declared: Key | None,
        written: object,
        unit: str,
        where: str,
        usual: tuple[float, float] | None,
        may_vanish: bool,
    ) -> float:
        """A quantity; what is wrong with it is reported with what the key means."""
        try:
            return parse(written, unit, where, usual, may_vanish)
        except InputError as error:
            raise InputError(error.what, error.where, _with(error.mend, declared)) from None

    def _counts_elsewhere(self, key: str) -> str:
        """The remedy for a key that is declared, but not under the circumstances of this file; "" for any other."""
        if self.section is None or key not in self.section.keys or not self.section.keys[key].when:
            return ""
        return f"leave it out; it counts {self.section.keys[key].when}"

    def _written(self, key: str, origin: str, unit: str) -> object:
        """What is written for a value, its source noted."""
        if key not in self.entries:
            mend = _with(f'write {key} = "... {unit}"'.replace(" 1", ""), self._declared(key))
            raise InputError("is missing", self.place(key), mend)
        written = self.entries[key]
        if not isinstance(written, dict):
            self.origins.note(origin, self.source, "")
            return written
        inner = Table(written, self.place(key), self.origins)
        inner.refuse_unknown(_TABLE_KEYS)
        if "value" not in written:
            raise InputError("has no value", self.place(key), f'write {key} = {{ value = "... {unit}" }}')
        tolerance = inner.text("tolerance", "")
        _check_tolerance(tolerance, unit, inner.place("tolerance"))
        self.origins.note(origin, inner.text("source", self.source), tolerance)
        return written["value"]


def whole_file(entries: Mapping[str, Any], where: str, section: Section) -> Table:
    """The table of a whole file, with the source that it names for all of its values.

    Args:
        entries: of the file.
        where: its path, for messages.
        section: that declares its keys.

    Raises:
        InputError: `source` is not a text.
    """
    plain = Table(entries, where, Origins())
    return replace(plain, source=plain.text("source", ""), section=section)


def declares_heat_alone(entries: Mapping[str, Any]) -> bool:
    """Whether a plant file has a thermal section and no structure: no chain can be made of it."""
    return "thermal" in entries and "structure" not in entries


def read_toml(path: Path, kind: str) -> dict[str, Any]:
    """Parse a TOML file; a byte order mark is passed over.

    Args:
        path: of the file.
        kind: what it is, for messages, such as "plant file".

    Raises:
        InputError: not found, not readable, not UTF-8, or not TOML (with line and column).
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
    near = difflib.get_close_matches(word, known, n=1, cutoff=0.5)
    return f'did you mean "{near[0]}"?' if near else f"known are {', '.join(known)}"


def _with(mend: str, declared: Key | None) -> str:
    """A remedy with what the key means, its unit and range."""
    return mend if declared is None else f"{mend}; {declared.says()}"


def _check_tolerance(tolerance: str, unit: str, where: str) -> None:
    """Refuse a tolerance that is neither a share nor in the unit of its value."""
    if not tolerance:
        return
    number = tolerance.removeprefix("±").strip()
    try:
        size = parse(number, "1", where)
    except InputError:
        size = parse(number, unit, where)
    if size < 0:
        raise InputError(f"{tolerance} is negative", where, 'write e.g. tolerance = "5 %"')
