"""The content of .gz files, block by block, and no more of it than a recording can hold."""

from __future__ import annotations

import zlib
from collections.abc import Iterator

from feeddrive.errors import InputError

GZIP = b"\x1f\x8b"
"""First bytes of a .gz file."""

BLOCK = 4_000_000
"""Bytes that are read at once: many rows, and little beside the numbers of a long file."""

MOST_UNPACKED = 200
"""Size of a .gz file's content over its own from which it is no recording: a row differs from the one before by its
time at least, which takes two bytes, and has some hundred letters."""

SMALL = 64_000_000
"""Bytes up to which a content may be anything over the size of its .gz file."""


class Unpacker:
    """Content of a .gz file of one or several members, block by block."""

    def __init__(self, where: str) -> None:
        self.where, self.packed, self.unpacked = where, 0, 0
        self.inner = zlib.decompressobj(31)

    def __call__(self, raw: bytes) -> Iterator[bytes]:
        self.packed += len(raw)
        try:
            while raw:
                if self.inner.eof:
                    raw = raw.lstrip(b"\x00")  # padding, as tapes and some tools leave it
                    if not raw:
                        return
                    self.inner = zlib.decompressobj(31)
                part = self.inner.decompress(raw, BLOCK)
                raw = self.inner.unconsumed_tail or self.inner.unused_data
                self.unpacked += len(part)
                if self.unpacked > max(SMALL, MOST_UNPACKED * self.packed):
                    what = f"the .gz file holds more than {MOST_UNPACKED} times its own size"
                    raise InputError(what, self.where, "unpack it first, if it is a recording")
                if part:
                    yield part
        except zlib.error:
            raise self.damaged() from None

    def end(self) -> None:
        """Refuse a file that ends within a member."""
        if not self.inner.eof:
            raise self.damaged()

    def damaged(self) -> InputError:
        """Return the error of a file that is damaged."""
        return InputError("the .gz file is damaged or cut short", self.where, "copy or compress it again")


def unpacked(raw: bytes, where: str) -> bytes:
    """Return the content of the bytes of a .gz file.

    Raises:
        InputError: it is damaged, or holds more than a recording does.
    """
    unpack = Unpacker(where)
    content = b"".join(unpack(raw))
    unpack.end()
    return content
