"""Opening a file: bytes, checksum, decompression, and text out of whatever a logger writes, whole or block by block."""

from __future__ import annotations

import codecs
import hashlib
import os
import re
import stat
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

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


_HDF5 = b"\x89HDF\r\n\x1a\n"
BYTE_ORDER_MARKS = ((b"\xef\xbb\xbf", "utf-8-sig"), (b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"))
_HEAD = 65_536  # bytes: the header of a hundred channels
_ALLOWED_CONTROLS = b"\t\n\r\f\x1a"  # 0x1a ends some DOS files


@dataclass(eq=False)
class FileContent:
    """Bytes of a file after decompression, and the checksum of the file as it lies on the disk.

    Attributes:
        path: of the file.
        data: all bytes; those of a text no longer once `decode` has made letters of them.
        sha256: of the file.
    """

    path: Path
    data: bytes
    sha256: str


@contextmanager
def opened(path: Path, kind_of_file: str = "recording") -> Iterator[BinaryIO]:
    """Open a file for reading its bytes.

    Raises:
        InputError: not found, a folder, a pipe or a device, unreadable.
    """
    where = str(path)
    try:
        kind = os.stat(path).st_mode
        if stat.S_ISDIR(kind):
            raise InputError(f"is a folder, not a {kind_of_file}", where, "name the file in it")
        if not stat.S_ISREG(kind):  # which may never end, or wait for ever
            raise InputError("is a pipe or a device, not a file", where, "write it to a .csv file first")
        with path.open("rb") as file:
            yield file
    except FileNotFoundError:
        what = "no such file" if kind_of_file == "recording" else f"no such {kind_of_file}"
        raise InputError(what, where, "check the name and the folder") from None
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", where, "check its name and permissions") from None
    except ValueError as error:
        if isinstance(error, InputError) or "null" not in str(error):
            raise
        raise InputError("no such file", where, "a name holds no null byte") from None
    except MemoryError:
        raise InputError("takes more memory than there is", where, "cut the recording into parts") from None


def first_bytes(path: Path) -> bytes:
    """Return the first bytes of a file after decompression, as many as identify its format.

    Raises:
        InputError: as `opened`, or a damaged .gz.
    """
    with opened(path) as file:
        raw = file.read(_HEAD)
        return next(iter(Unpacker(str(path))(raw)), b"")[:_HEAD] if raw.startswith(GZIP) else raw


def open_file(path: Path) -> FileContent:
    """Read a file, gunzip it if it is compressed.

    Raises:
        InputError: not found, a folder, a pipe or a device, unreadable, empty, or a damaged .gz.
    """
    with opened(path) as file:
        raw = file.read()
        digest = hashlib.sha256(raw).hexdigest()
        data = unpacked(raw, str(path)) if raw.startswith(GZIP) else raw
        del raw
    if not data or data.isspace():
        raise InputError("the file is empty", str(path), "record again or name another file")
    return FileContent(path, data, digest)


def head_of(data: bytes) -> str:
    """Return the first letters of a file as text, whatever its encoding, for recognising its format; \\n ends lines."""
    start = data[:_HEAD]
    encoding = next((name for mark, name in BYTE_ORDER_MARKS if start.startswith(mark)), None)
    if encoding is None:
        return start.decode("latin-1").replace("\r\n", "\n")
    even = start[: len(start) // 2 * 2] if encoding == "utf-16" else start
    return even.decode(encoding, errors="ignore").lstrip("\ufeff").replace("\r\n", "\n")


def is_hdf5(data: bytes) -> bool:
    """Tell whether these are the bytes of an HDF5 file, which is what .mat v7.3 is."""
    return data.startswith(_HDF5) or data[512:520] == _HDF5 or data.startswith(b"MATLAB 7.3")


def decode(content: FileContent) -> tuple[str, tuple[str, ...]]:
    """Return the text of a file with line ends as \\n, and remarks about its encoding; its bytes are given up.

    Raises:
        InputError: the file is not text.
    """
    where = str(content.path)
    refuse_known_binary(content.data, where)
    data, content.data = content.data, b""
    encoding = next((name for mark, name in BYTE_ORDER_MARKS if data.startswith(mark)), "utf-8")
    if encoding != "utf-16":  # one copy at a time: a recording may be half of what fits
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    notes: tuple[str, ...] = ()
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError:
        text, notes = _other_text(data)
    del data
    if any(ord(letter) < 32 and letter.encode() not in _ALLOWED_CONTROLS for letter in set(text)):
        raise InputError("is not a text file", where, "name a .csv or .csv.gz file, or a .mat file with its mapping")
    return text.replace("\r\n", "\n").replace("\r", "\n").rstrip("\x1a"), notes


_DECLARED = re.compile(rb"\s*<\?xml[^>]{0,200}\bencoding=[\"']([A-Za-z0-9._-]{1,40})[\"']")


def _other_text(data: bytes) -> tuple[str, tuple[str, ...]]:
    """Return the text of bytes that are not UTF-8: in the encoding that XML declares, else Latin-1; and a remark."""
    declared = _DECLARED.match(data)
    try:
        if declared is not None:
            return data.decode(declared[1].decode("ascii")), ()
    except (UnicodeDecodeError, LookupError):
        pass
    return data.decode("latin-1"), ("not UTF-8; read as Latin-1",)


def refuse_known_binary(data: bytes, where: str) -> None:
    """Refuse what is no text by its first bytes.

    Raises:
        InputError: a .mat file, or a workbook.
    """
    if is_hdf5(data) or data.startswith(b"MATLAB"):
        raise InputError("is a .mat file by its content", where, "give it the ending .mat and a mapping (--map)")
    if data.startswith(b"PK\x03\x04"):
        if any(part in data[:4000] for part in (b"[Content_Types].xml", b"xl/", b"mimetype")):
            raise InputError("is a workbook, not CSV", where, "save the sheet as CSV")
        raise InputError("is a zip archive", where, "unpack it and name a file of it; feeddrive watch reads archives")


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
