"""Opening a file: bytes, checksum, decompression, and text out of whatever a logger writes."""

from __future__ import annotations

import gzip
import hashlib
import io
import zlib
from dataclasses import dataclass
from pathlib import Path

from feeddrive.errors import InputError

_HDF5 = b"\x89HDF\r\n\x1a\n"
_GZIP = b"\x1f\x8b"
_BYTE_ORDER_MARKS = ((b"\xef\xbb\xbf", "utf-8-sig"), (b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"))
_HEAD = 65_536  # bytes: the header of a hundred channels
_MOST_BYTES = (
    4 << 30
)  # of a decompressed file: an hour of 64 channels at 8 kHz as text is 15 GB, and no reader holds it
_MOST_RATIO = 500  # numbers as text pack 3 to 60 times, a bomb 1000 times
_FREE = 64 << 20  # bytes up to which the ratio is not looked at: an axis at rest packs well too
_ALLOWED_CONTROLS = b"\t\n\r\f\x1a"  # 0x1a ends some DOS files


@dataclass(frozen=True)
class FileContent:
    """Bytes of a file after decompression, and the checksum of the file as it lies on the disk."""

    path: Path
    data: bytes
    sha256: str


def open_file(path: Path) -> FileContent:
    """Read a file, gunzip it if it is compressed.

    Raises:
        InputError: not found, a folder, unreadable, empty, or a damaged .gz.
    """
    where = str(path)
    if path.is_dir():
        raise InputError("is a folder, not a recording", where, "name a .csv, .csv.gz or .mat file")
    try:
        raw = path.read_bytes()
    except FileNotFoundError:
        raise InputError("no such file", where, "check the name and the folder") from None
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", where, "check the permissions of the file") from None
    data = _decompressed(raw, where) if raw.startswith(_GZIP) else raw
    if not data.strip():
        raise InputError("the file is empty", where, "record again or name another file")
    return FileContent(path, data, hashlib.sha256(raw).hexdigest())


def head_of(data: bytes) -> str:
    """Return the first letters of a file as text, whatever its encoding, for recognising its format; \\n ends lines."""
    start = data[:_HEAD]
    encoding = next((name for mark, name in _BYTE_ORDER_MARKS if start.startswith(mark)), None)
    if encoding is None:
        return start.decode("latin-1").replace("\r\n", "\n")
    even = start[: len(start) // 2 * 2] if encoding == "utf-16" else start
    return even.decode(encoding, errors="ignore").lstrip("\ufeff").replace("\r\n", "\n")


def is_hdf5(data: bytes) -> bool:
    """Tell whether these are the bytes of an HDF5 file, which is what .mat v7.3 is."""
    return data.startswith(_HDF5) or data[512:520] == _HDF5 or data.startswith(b"MATLAB 7.3")


def decode(content: FileContent) -> tuple[str, tuple[str, ...]]:
    """Return the text of a file with line ends as \\n, and what is to be said about its encoding.

    Raises:
        InputError: the file is not text.
    """
    data, where = content.data, str(content.path)
    _refuse_known_binary(data, where)
    encoding = next((name for mark, name in _BYTE_ORDER_MARKS if data.startswith(mark)), "utf-8")
    notes: tuple[str, ...] = ()
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError:
        text, notes = data.decode("latin-1"), ("not UTF-8; read as Latin-1",)
    if any(ord(letter) < 32 and letter.encode() not in _ALLOWED_CONTROLS for letter in set(text)):
        raise InputError("is not a text file", where, "name a .csv or .csv.gz file, or a .mat file with its mapping")
    return text.replace("\r\n", "\n").replace("\r", "\n").rstrip("\x1a"), notes


def _decompressed(raw: bytes, where: str) -> bytes:
    """Decompress block by block, so that a small file that unpacks to a disk full of zeros is refused on the way."""
    parts: list[bytes] = []
    size = 0
    try:
        with gzip.GzipFile(fileobj=io.BytesIO(raw)) as stream:
            while part := stream.read(1 << 22):
                size += len(part)
                if size > _MOST_BYTES or (size > _FREE and size > _MOST_RATIO * len(raw)):
                    what = f"the .gz file unpacks to more than {size // 1_000_000} MB from {len(raw) // 1000} kB"
                    raise InputError(what, where, "unpack and look at it first, or compress the recording alone")
                parts.append(part)
    except (EOFError, OSError, zlib.error):
        raise InputError("the .gz file is damaged or cut short", where, "copy or compress it again") from None
    return b"".join(parts)


def _refuse_known_binary(data: bytes, where: str) -> None:
    if is_hdf5(data) or data.startswith(b"MATLAB"):
        raise InputError("is a .mat file by its content", where, "give it the ending .mat and a mapping (--map)")
    if data.startswith(b"PK\x03\x04"):
        raise InputError("is a workbook or zip archive, not CSV", where, "save the sheet as CSV")
