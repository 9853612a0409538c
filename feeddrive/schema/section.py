"""A section of a file: its keys, the sections inside it, and those that a kind chooses.

A reader gets its table together with the section that declares it (`feeddrive.schema.table.Table`): a key that no
section declares cannot be read, and the reference is written from the same objects.

Sections are declared in a text, each a heading with the table of its keys (`feeddrive.schema.key`) below:

    [scenario.record] what is written down
    [[scenario.force]] one force on the table; several add          may stand more than once
    (scenario.force.sine) a sine                                    the kind "sine" of scenario.force
    [mapping.channels.*] one channel                                a section of any name
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

from feeddrive.schema.key import Key, keys


class UndeclaredKeyError(LookupError):
    """A reader asks for a key, a section or a unit that the schema does not hold: a mistake of the program."""


@dataclass(frozen=True)
class Section:
    """One section.

    Attributes:
        path: dotted, as `feeddrive keys` takes it: "plant.ball_screw".
        meaning: in a few words.
        keys: name to key.
        sections: sections inside it by their name.
        kinds: where the keys depend on a word, that word to the section of that kind; its keys come beside `keys`.
        kind_key: key that holds this word.
        listed: whether it may stand more than once, as `[[name]]`.
        any_name: whether the inner section named "*" is that of every name.
    """

    path: str
    meaning: str
    keys: Mapping[str, Key] = field(default_factory=dict)
    sections: Mapping[str, Section] = field(default_factory=dict)
    kinds: Mapping[str, Section] = field(default_factory=dict)
    kind_key: str = "kind"
    listed: bool = False
    any_name: bool = False

    def key(self, name: str) -> Key:
        """The key of that name.

        Raises:
            UndeclaredKeyError: there is none.
        """
        if name in self.keys:
            return self.keys[name]
        for kind in self.kinds.values():
            if name in kind.keys:
                return kind.keys[name]
        raise UndeclaredKeyError(f"{self.path} declares no key {name}")

    def inner(self, name: str) -> Section:
        """The section of that name inside this one.

        Raises:
            UndeclaredKeyError: there is none.
        """
        if name in self.sections:
            return self.sections[name]
        if self.any_name:
            return self.sections["*"]
        raise UndeclaredKeyError(f"{self.path} declares no section {name}")

    def of_kind(self, word: str) -> Section:
        """This section with the keys of one kind alone."""
        kind = self.kinds[word]
        return Section(kind.path, kind.meaning, {**self.keys, **kind.keys}, {**self.sections, **kind.sections})

    def names(self) -> tuple[str, ...]:
        """Every key and inner section that may stand here, of whatever kind."""
        inner = [name for name in self.sections if name != "*"]
        return tuple(dict.fromkeys([*self.keys, *inner, *(key for one in self.kinds.values() for key in one.keys)]))

    def walk(self) -> Iterator[Section]:
        """This section, those inside it, and those of its kinds."""
        yield self
        for section in (*self.kinds.values(), *self.sections.values()):
            yield from section.walk()


def keyed(*keys: Key) -> dict[str, Key]:
    """Keys by their name; of two of one name, which count under different circumstances, the first with both."""
    found: dict[str, Key] = {}
    for key in keys:
        found.setdefault(key.name, key)
    return found


_HEADING = re.compile(r"^(\[\[?|\()([\w.*]+)(?:\]\]?|\)) (.*)$", re.MULTILINE)


def sections(text: str) -> Section:
    """The section that a text declares first, with those below it that its path leads to."""
    _, *found = _HEADING.split(text)
    made: dict[str, tuple[str, Section]] = {}
    for bracket, path, meaning, table in zip(*(found[i::4] for i in range(4)), strict=True):
        made[path] = bracket, Section(path, meaning, keyed(*keys(table)), listed=bracket == "[[")
    for path, (bracket, section) in reversed(made.items()):  # what stands inside is whole before what holds it
        outer, _, name = path.rpartition(".")
        if outer not in made:
            return section
        around, holder = made[outer]
        if bracket == "(":
            holder = replace(holder, kinds={name: section, **holder.kinds})
        else:
            holder = replace(holder, sections={name: section, **holder.sections}, any_name=name == "*")
        made[outer] = around, holder
    raise ValueError("a text without a heading")
