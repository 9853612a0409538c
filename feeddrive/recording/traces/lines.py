"""Lines of a text as a sequence that is not held beside it: a line is cut out when it is asked for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import overload

import numpy as np
import numpy.typing as npt

_BLOCK = 1_000_000  # letters whose line ends are looked for at a time: four bytes each


class Lines(Sequence[str]):
    """The lines of a text, as `text.split("\\n")` has them; a slice is a view, and eight bytes a line are held.

    Attributes:
        text: that they are of.
    """

    def __init__(self, text: str, begins: npt.NDArray[np.int64] | None = None) -> None:
        self.text = text
        self._begins = _line_begins(text) if begins is None else begins  # and the begin of the line after the last

    def __len__(self) -> int:
        return len(self._begins) - 1

    @overload
    def __getitem__(self, index: int) -> str: ...
    @overload
    def __getitem__(self, index: slice) -> Lines: ...
    def __getitem__(self, index: int | slice) -> str | Lines:
        if isinstance(index, slice):
            first, last, _ = slice(index.start, index.stop).indices(len(self))
            return Lines(self.text, self._begins[first : max(first, last) + 1])
        at = range(len(self))[index]
        return self.text[self._begins[at] : self._begins[at + 1] - 1]

    def __iter__(self) -> Iterator[str]:
        for first in range(0, len(self), 20_000):
            yield from self[first : first + 20_000].block.split("\n") if len(self) else ()

    @property
    def block(self) -> str:
        """All of them as one text, without the end of the last."""
        return self.text[self._begins[0] : self._begins[-1] - 1] if len(self) else ""

    def first_with(self, sign: str) -> int | None:
        """Number of the first line that holds a sign; None where none does."""
        at = self.text.find(sign, int(self._begins[0]), int(self._begins[-1]) - 1)
        return None if at < 0 else int(np.searchsorted(self._begins, at, side="right")) - 1


def _line_begins(text: str) -> npt.NDArray[np.int64]:
    ends = [
        np.flatnonzero(np.frombuffer(text[at : at + _BLOCK].encode("utf-32-le", "surrogatepass"), np.uint32) == 10) + at
        for at in range(0, len(text), _BLOCK)
    ]
    return np.concatenate([[-1], *ends, [len(text)]]).astype(np.int64) + 1
