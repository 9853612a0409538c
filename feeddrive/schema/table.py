"""Reading one table of a file: quantities with unit, source and tolerance, and nothing unknown."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from feeddrive.errors import InputError, quoted
from feeddrive.schema.key import Key
from feeddrive.schema.section import Section, UndeclaredKeyError
from feeddrive.schema.toml_text import nearest, nearest_choice
from feeddrive.units.quantity import format_quantity, parse

_TABLE_KEYS = ("value", "source", "tolerance")

_OBEYED = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069]")
"""Letters that a terminal, an editor or a browser obeys: controls but line ends and tabs, and turns of direction."""


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
    """A table of a file.

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
        """Refuse keys that are not among `known`, naming the nearest of these.

        `elsewhere` are keys that mean something under other circumstances, to what is to be done then.
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

    def quantities(self, key: str, unit: str = "", origin: str = "") -> float | tuple[float, ...]:
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

    def optional(self, key: str, default: float | None = None, origin: str = "") -> float:
        """As `quantity`; where it is left out the default, or the declared one."""
        if key in self.entries:
            return self.quantity(key, origin=origin or key)
        if default is not None:
            return default
        declared = self._declared(key)
        assert declared is not None and declared.default is not None, key
        return parse(declared.default, declared.unit, self.place(key))

    def positive(self, key: str, unit: str = "", origin: str = "", usual: tuple[float, float] | None = None) -> float:
        """A value above zero.

        Raises:
            InputError: as `quantity`, or zero or negative.
        """
        value = self.quantity(key, unit, origin, usual)
        if value <= 0:
            shown = format_quantity(value, self._unit(self._declared(key), key, unit))
            raise InputError(
                f"{shown} is {'negative' if value < 0 else 'not above zero'}",
                self.place(key),
                "write a value above zero",
            )
        return value

    def listed(self, key: str, unit: str = "") -> tuple[float, ...]:
        """One quantity or a list of them, as a tuple in SI; raises as `quantities`."""
        value = self.quantities(key, unit, key)
        return value if isinstance(value, tuple) else (value,)

    def switch(self, key: str, default: bool = False) -> bool:
        """true or false, by default false.

        Raises:
            InputError: something else.
        """
        value = self.entries.get(key, default)
        if not isinstance(value, bool):
            raise InputError(f"{value!r} is neither true nor false", self.place(key), f"write {key} = true")
        return value

    def words(self, key: str, default: tuple[str, ...]) -> tuple[str, ...]:
        """A list of words, none twice.

        Raises:
            InputError: not a list of words.
        """
        value = self.entries.get(key, list(default))
        if not isinstance(value, list) or not value or not all(isinstance(word, str) for word in value):
            raise InputError("is not a list of words", self.place(key), f'write {key} = ["...", "..."]')
        return tuple(dict.fromkeys(value))

    def whole(self, key: str) -> int:
        """A whole number, its range and default as declared.

        Raises:
            InputError: missing without a default, not a whole number, or outside of what is possible.
        """
        declared = self._declared(key)
        assert declared is not None
        least, most = int(declared.minimum), int(declared.maximum)
        value = self.entries.get(key, None if declared.default is None else int(declared.default))
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

    def choice(self, key: str, allowed: Iterable[str] = (), default: str | None = None) -> str:
        """One of the words `allowed`, or of those declared, with the declared default; None if it must be given."""
        allowed, declared = tuple(allowed), self._declared(key)
        if not allowed and declared is not None:
            allowed, default = declared.choices, declared.default
        if declared is not None and declared.choices and set(allowed) - set(declared.choices):
            raise UndeclaredKeyError(f"{key} is declared as one of {declared.choices}")
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
    """The table of a whole file, its keys as a section declares them, with the source named for all its values.

    Raises InputError: `source` is not a text.
    """
    plain = Table(entries, where, Origins())
    return replace(plain, source=plain.text("source", ""), section=section)


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
