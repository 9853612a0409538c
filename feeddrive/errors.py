"""The errors that reach a person: what is wrong, where it is, and how to mend it."""

from __future__ import annotations

import re
import unicodedata

LONGEST_QUOTE = 70
"""Letters of a file that an error repeats: enough to find the place, and less than a line of a terminal."""

LONGEST_PART = 400
"""Letters of what, where and mend each: a path with row and column, or a sentence with two quotes."""

_HIDDEN = ("Cc", "Cf", "Cs", "Zl", "Zp")
"""Unicode categories that a terminal obeys or does not show: controls, direction and joining marks, half letters."""


class InputError(ValueError):
    """Unusable input, told in one line: what, where, the mend.

    The command line prints it without a traceback and ends with exit status 2. Whatever stands in it is made printable,
    and cut where it is too long, so that a file cannot write on the terminal through its error.

    Args:
        what: what is wrong, in the words of the person who made the file.
        where: file, and row, column or key in it; empty if there is none.
        mend: what to do about it; empty if nothing can be done.
    """

    def __init__(self, what: str, where: str = "", mend: str = "") -> None:
        self.what = _part(what)
        self.where = _part(where)
        self.mend = _part(mend)
        super().__init__(self.what, self.where, self.mend)

    def __str__(self) -> str:
        line = f"{self.where}: {self.what}" if self.where else self.what
        if self.mend:
            line = f"{line}; {self.mend}"
        return " ".join(line.split())


class ValidityWarning(UserWarning):
    """Physics that leaves the range in which its formula holds."""


def quoted(value: object, longest: int = LONGEST_QUOTE) -> str:
    """Return a value from a file as an error or a note may repeat it: printable, on one line, not too long.

    Args:
        value: a text, which is shown without quotation marks, or anything else, which is shown as Python writes it.
        longest: letters that are shown at most.
    """
    try:
        text = value if isinstance(value, str) else repr(value)
    except (ValueError, RecursionError):  # a whole number of more than 4300 digits; a table in a table in a table ...
        text = f"a {type(value).__name__} too long to show"
    if len(text) > 20 * longest:  # what is cut away need not be made printable
        text = f"{text[: 10 * longest]}{text[-10 * longest :]}"
    return _cut(" ".join(printable(text).split()), longest)


def printable(text: str) -> str:
    """Return a text with all that a terminal obeys or hides shown as an escape such as \\x1b; line ends become spaces.

    Letters that turn the direction of writing, that have no width, and halves of letters are among these.
    """
    if text.isascii() and text.isprintable():
        return text
    return "".join(map(_visible, text))


def _visible(letter: str) -> str:
    if letter in "\t\n\r\f\v":
        return " "
    if unicodedata.category(letter) not in _HIDDEN:
        return letter
    code = ord(letter)
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def _part(text: str) -> str:
    """Return a part of an error, what it quotes and the part as a whole cut to what a person reads."""
    if len(text) > 20 * LONGEST_PART:
        text = f"{text[: 10 * LONGEST_PART]}{text[-10 * LONGEST_PART :]}"
    text = re.sub(r'"([^"]*)"', lambda match: f'"{_cut(match[1], LONGEST_QUOTE)}"', printable(text))
    return _cut(text, LONGEST_PART)


def _cut(text: str, longest: int) -> str:
    """Return a text with its middle left out where it is too long."""
    if len(text) <= longest:
        return text
    kept = longest - 3
    return f"{text[: kept - kept // 3]}...{text[-(kept // 3) :]}"
