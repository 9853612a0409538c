"""XML of controls, read without anything that XML can do to a reader: no DTD, no entities, no outside files."""

from __future__ import annotations

from xml.etree.ElementTree import Element, ParseError, XMLParser

from feeddrive.errors import InputError

_DEEPEST = 200  # elements inside each other; controls write about ten


def parse_xml(text: str, where: str) -> Element:
    """Parse the text of a file.

    Raises:
        InputError: not XML or cut short, with its line; a DTD; elements nested deeper than any control writes.
    """
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        what = "the XML holds a DTD, which no control writes and which can blow up a reader"
        raise InputError(what, where, "export the trace again from the control")
    builder = _Builder()
    parser = XMLParser(target=builder)
    try:
        parser.feed(text)
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

    def __init__(self) -> None:
        self._open: list[Element] = []
        self._root: Element | None = None

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        """Open an element."""
        element = Element(tag, attributes)
        if self._open:
            self._open[-1].append(element)
        elif self._root is None:
            self._root = element
        self._open.append(element)
        if len(self._open) > _DEEPEST:
            raise _TooDeepError

    def end(self, tag: str) -> None:
        """Close the element that was opened last."""
        self._open.pop()

    def data(self, text: str) -> None:
        """Add text to the open element; text behind an inner element is not used by any control."""
        if self._open and not len(self._open[-1]):
            self._open[-1].text = (self._open[-1].text or "") + text

    def close(self) -> Element:
        """Return the root."""
        assert self._root is not None  # expat refuses a document without element
        return self._root
