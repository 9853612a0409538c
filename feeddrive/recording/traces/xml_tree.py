"""XML of controls, read without anything that XML can do to a reader: no DTD, no entities, no outside files."""

from __future__ import annotations

from collections.abc import Callable
from xml.etree.ElementTree import Element, ParseError, XMLParser

from feeddrive.errors import InputError

_DEEPEST = 200  # elements inside each other; controls write about ten


Taker = Callable[[str, str, dict[str, str]], bool]
"""Told of the beginning ("start") or "end" of an element by tag and attributes; takes it where it returns True."""

_BLOCK = 1_000_000  # letters that are parsed at a time


def parse_xml(text: str, where: str, takes: Taker | None = None) -> Element:
    """Parse the text of a file.

    Args:
        text: of the file.
        where: its name.
        takes: elements out of the tree, one by one as they come: a tree takes ten times its text.

    Raises:
        InputError: not XML or cut short, with its line; a DTD; elements nested deeper than any control writes.
    """
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        what = "the XML holds a DTD, which no control writes and which can blow up a reader"
        raise InputError(what, where, "export the trace again from the control")
    builder = _Builder(takes)
    parser = XMLParser(target=builder)
    try:
        for first in range(0, len(text), _BLOCK):
            parser.feed(text[first : first + _BLOCK])
        return parser.close()
    except ParseError as error:
        line = error.position[0]
        what = f"is not whole XML: {str(error).split(':')[0]}"
        raise InputError(what, f"{where}, line {line}", "copy or export it again") from None
    except _TooDeepError:
        raise InputError("the XML is nested too deeply", where, "export the trace again from the control") from None


class _TooDeepError(Exception):
    pass


class _Builder:
    """Builds the tree of elements; counts how deep it is."""

    def __init__(self, takes: Taker | None) -> None:
        self._takes = takes
        self._open: list[Element] = []
        self._root: Element | None = None

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        """Open an element."""
        taken = self._takes is not None and self._takes("start", tag, attributes)
        element = Element(tag, {} if taken else attributes)
        if self._open and not taken:
            self._open[-1].append(element)
        elif self._root is None:
            self._root = element
        self._open.append(element)
        if len(self._open) > _DEEPEST:
            raise _TooDeepError

    def end(self, tag: str) -> None:
        """Close the element that was opened last."""
        if self._takes is not None:
            self._takes("end", tag, {})
        self._open.pop()

    def data(self, text: str) -> None:
        """Add text to the open element; text behind an inner element is not used by any control."""
        if self._open and not len(self._open[-1]):
            self._open[-1].text = (self._open[-1].text or "") + text

    def close(self) -> Element:
        """Return the root."""
        assert self._root is not None  # expat refuses a document without element
        return self._root
