"""The text of a file, some megabytes at a time, so that reading takes little more memory than its numbers."""

from __future__ import annotations

import codecs
import hashlib
import re
from collections.abc import Iterator
from pathlib import Path

from feeddrive.errors import InputError
from feeddrive.recording.files.opening import BYTE_ORDER_MARKS, opened, refuse_known_binary
from feeddrive.recording.files.unpacking import BLOCK, GZIP, Unpacker

_CONTROLS = re.compile("[\x00-\x08\x0b\x0e-\x19\x1b-\x1f]")  # tab, line ends, form feed; 0x1a ends some DOS files


class TextFile:
    """A text file, plain or compressed, that is read once from its beginning to its end.

    Attributes:
        path: of the file.
        where: the path, as errors show it.
        notes: remarks about its encoding; complete when all is read.
    """

    def __init__(self, path: Path) -> None:
        self.path, self.where = path, str(path)
        self.notes: tuple[str, ...] = ()
        self._digest = hashlib.sha256()

    @property
    def sha256(self) -> str:
        """Checksum of the file as it lies on the disk; complete when all is read."""
        return self._digest.hexdigest()

    def blocks(self) -> Iterator[str]:
        """Read the file; line ends are \\n, and only the last block may end within a line end.

        Raises:
            InputError: not found, no file, unreadable, empty, damaged, or not text.
        """
        decode, held, anything = None, "", False
        for data, last in self._plain():
            if decode is None:
                refuse_known_binary(data, self.where)
                mark = next((name for sign, name in BYTE_ORDER_MARKS if data.startswith(sign)), "utf-8")
                decode = _Decoder(mark)
            text = held + decode(data, last)
            held = "\r" if text.endswith("\r") and not last else ""  # its \n may come with the next block
            text = text[: len(text) - len(held)]
            if "\r" in text:
                text = text.replace("\r\n", "\n").replace("\r", "\n")
            if _CONTROLS.search(text):
                mend = "name a .csv or .csv.gz file, or a .mat file with its mapping"
                raise InputError("is not a text file", self.where, mend)
            anything = anything or bool(text.strip())
            yield text
            self.notes = decode.notes
        if not anything:
            raise InputError("the file is empty", self.where, "record again or name another file")

    def _plain(self) -> Iterator[tuple[bytes, bool]]:
        """Read blocks of bytes after decompression, and whether each is the last; the last one may be empty."""
        with opened(self.path) as file:
            raw = file.read(BLOCK)
            unpack = Unpacker(self.where) if raw.startswith(GZIP) else None
            while raw:
                self._digest.update(raw)
                if unpack is None:
                    yield raw, False
                else:
                    yield from ((part, False) for part in unpack(raw))
                raw = file.read(BLOCK)
            if unpack is not None:
                unpack.end()
        yield b"", True


class _Decoder:
    """Bytes to text: the encoding that the file begins in, and Latin-1 from the first byte on that is none of it."""

    def __init__(self, encoding: str) -> None:
        self.decoder = codecs.getincrementaldecoder(encoding)("strict")
        self.notes: tuple[str, ...] = ()

    def __call__(self, data: bytes, last: bool) -> str:
        pending = self.decoder.getstate()[0]
        try:
            return self.decoder.decode(data, last)
        except UnicodeError:
            self.decoder = codecs.getincrementaldecoder("latin-1")("strict")
            self.notes = ("not UTF-8; read as Latin-1",)
            return self.decoder.decode(pending + data, last)
