"""The errors that reach a person: what is wrong, where it is, and how to mend it."""

from __future__ import annotations


class InputError(ValueError):
    """Unusable input, told in one line: what, where, the mend.

    The command line prints it without a traceback and ends with exit status 2.

    Args:
        what: what is wrong, in the words of the person who made the file.
        where: file, and row, column or key in it; empty if there is none.
        mend: what to do about it; empty if nothing can be done.
    """

    def __init__(self, what: str, where: str = "", mend: str = "") -> None:
        self.what = what
        self.where = where
        self.mend = mend
        super().__init__(what, where, mend)

    def __str__(self) -> str:
        line = f"{self.where}: {self.what}" if self.where else self.what
        if self.mend:
            line = f"{line}; {self.mend}"
        return " ".join(line.split())


class ValidityWarning(UserWarning):
    """Physics that leaves the range in which its formula holds."""
