"""Opening a file: bytes, checksum, decompression, and text out of whatever a logger writes."""

from __future__ import annotations

import hashlib
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from feeddrive.errors import InputError
from feeddrive.recording.files.unpacking import GZIP, Unpacker, unpacked

_HDF5 = b"\x89HDF\r\n\x1a\n"
BYTE_ORDER_MARKS = ((b"\xef\xbb\xbf", "utf-8-sig"), (b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"))
_HEAD = 65_536  # bytes: the header of a hundred channels
_ALLOWED_CONTROLS = b"\t\n\r\f\x1a"  # 0x1a ends some DOS files


@dataclass(frozen=True)
class FileContent:
    """Bytes of a file after decompression, and the checksum of the file as it lies on the disk."""

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
    """Return the first bytes of a file after decompression, as many as tell its format.

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
        data = unpacked(raw, str(path)) if raw.startswith(GZIP) else raw
    if not data.strip():
        raise InputError("the file is empty", str(path), "record again or name another file")
    return FileContent(path, data, hashlib.sha256(raw).hexdigest())


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
    """Return the text of a file with line ends as \\n, and remarks about its encoding.

    Raises:
        InputError: the file is not text.
    """
    data, where = content.data, str(content.path)
    refuse_known_binary(data, where)
    encoding = next((name for mark, name in BYTE_ORDER_MARKS if data.startswith(mark)), "utf-8")
    notes: tuple[str, ...] = ()
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError:
        text, notes = data.decode("latin-1"), ("not UTF-8; read as Latin-1",)
    if any(ord(letter) < 32 and letter.encode() not in _ALLOWED_CONTROLS for letter in set(text)):
        raise InputError("is not a text file", where, "name a .csv or .csv.gz file, or a .mat file with its mapping")
    return text.replace("\r\n", "\n").replace("\r", "\n").rstrip("\x1a"), notes


def refuse_known_binary(data: bytes, where: str) -> None:
    """Refuse what is no text by its first bytes.

    Raises:
        InputError: a .mat file, or a workbook.
    """
    if is_hdf5(data) or data.startswith(b"MATLAB"):
        raise InputError("is a .mat file by its content", where, "give it the ending .mat and a mapping (--map)")
    if data.startswith(b"PK\x03\x04"):
        raise InputError("is a workbook or zip archive, not CSV", where, "save the sheet as CSV")
