"""What lies in a folder: recordings, archives and dumps of a control, whatever is there by now.

Files in sub-folders and members of zip archives are recordings of their own. A file whose size or time has not changed
since it was read is not opened again.
"""

from __future__ import annotations

import hashlib
import tempfile
import time
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from feeddrive.errors import InputError, printable
from feeddrive.recording import Recording, read_recording
from feeddrive.recording.files.opening import first_bytes, head_of

PASSED_OVER = (".toml", ".html", ".htm", ".png", ".jpg", ".jpeg", ".pdf", ".svg", ".md", ".py", ".npz", ".ini", ".bak")
"""Endings of what lies beside recordings."""

UNFINISHED = (".tmp", ".part", ".partial", ".crdownload", ".filepart")
"""Endings under which programs write a file before they give it its name."""

YOUNG = 60.0
"""Seconds after its last change within which a file that cannot be read is taken to be still being written."""

MOST_MEMBER = 4_000_000_000
MOST_RATIO = 500
SMALL = 64_000_000
"""Bounds of a member of an archive: its bytes, and its ratio to what is packed beyond so many bytes."""


@dataclass(frozen=True)
class Source:
    """A file, or a member of an archive.

    Attributes:
        key: path below the folder, with "!" before the name inside an archive.
        path: of the file or archive.
        member: name inside the archive; empty for a file.
        size: bytes, of a member unpacked.
        changed: when, seconds since 1970; of a member's archive.
    """

    key: str
    path: Path
    member: str
    size: int
    changed: float

    @property
    def young(self) -> bool:
        """Whether it was changed just now, so that it may still be being written."""
        return time.time() - self.changed < YOUNG


def sources(folder: Path, own: Path) -> Iterator[Source | tuple[str, str]]:
    """What lies in a folder and below, by name; a pair of key and reason for an archive that cannot be opened.

    Args:
        folder: to look into.
        own: folder of results, which is left out.

    Raises:
        InputError: no such folder.
    """
    if not folder.is_dir():
        raise InputError("no such folder", str(folder), "name the folder that recordings are added to")
    own = own.resolve()
    for path in sorted(folder.rglob("*")):
        relative = path.relative_to(folder)
        hidden = any(part.startswith(".") for part in relative.parts)
        if hidden or own == path.resolve() or own in path.resolve().parents or not path.is_file():
            continue
        if path.suffix.lower() in PASSED_OVER:
            continue
        try:
            state = path.stat()
        except OSError:
            continue  # it went away
        key = printable(relative.as_posix())
        if path.suffix.lower() == ".zip":
            yield from _members(path, key, state.st_mtime)
        else:
            yield Source(key, path, "", state.st_size, state.st_mtime)


def _members(path: Path, key: str, changed: float) -> Iterator[Source | tuple[str, str]]:
    try:
        with zipfile.ZipFile(path) as archive:
            inside = sorted(archive.infolist(), key=lambda one: one.filename)
    except (OSError, zipfile.BadZipFile, ValueError, NotImplementedError) as error:
        yield key, f"the archive cannot be opened ({printable(str(error))})"
        return
    for one in inside:
        name = one.filename
        if one.is_dir() or Path(name).suffix.lower() in PASSED_OVER or Path(name).name.startswith("."):
            continue
        yield Source(f"{key}!{printable(name)}", path, name, one.file_size, changed)


@contextmanager
def as_file(source: Source) -> Iterator[Path]:
    """The file of a source; a member is unpacked into a place of its own for as long as it is needed.

    Raises:
        InputError: a member that cannot be unpacked, or is larger than any recording.
    """
    if not source.member:
        yield source.path
        return
    with tempfile.TemporaryDirectory(prefix="feeddrive_") as place:
        target = Path(place) / (Path(source.member).name or "member")
        try:
            with zipfile.ZipFile(source.path) as archive:
                one = archive.getinfo(source.member)
                swollen = one.file_size > SMALL and one.file_size > MOST_RATIO * max(one.compress_size, 1)
                if one.file_size > MOST_MEMBER or swollen:
                    raise InputError(f"unpacks to {one.file_size} bytes", source.key, "unpack it yourself, and look")
                with archive.open(one) as packed, target.open("wb") as written:
                    _copy(packed, written, one.file_size, source.key)
        except (OSError, zipfile.BadZipFile, RuntimeError, NotImplementedError, EOFError, KeyError) as error:
            raise InputError(f"cannot be unpacked ({error})", source.key, "pack the archive again") from None
        yield target


def _copy(packed: object, written: object, size: int, where: str) -> None:
    """Copy no more than was declared."""
    left = size
    while block := packed.read(1_000_000):  # type: ignore[attr-defined]
        left -= len(block)
        if left < 0:
            raise InputError("unpacks to more than it declares", where, "pack the archive again")
        written.write(block)  # type: ignore[attr-defined]


@dataclass(frozen=True)
class Opened:
    """A recording that was read.

    Attributes:
        recording: as read, under its key.
        head: beginning of its text.
        digest: of its samples: the same for copies, packed or renamed.
    """

    recording: Recording
    head: str
    digest: str


def opened(source: Source, mapping: Path | None, decimal: str | None) -> Opened:
    """Read a source.

    Raises:
        InputError: it is no recording that can be used, or it changed while it was read.
    """
    with as_file(source) as path:
        before = path.stat()
        head = head_of(first_bytes(path))
        recording = read_recording(path, mapping, decimal=decimal)
        after = path.stat()
    if (before.st_size, before.st_mtime) != (after.st_size, after.st_mtime):
        raise InputError("changed while it was read", source.key, "it is read the next time")
    digest = hashlib.sha256()
    for name in sorted(recording.channels):
        digest.update(name.encode())
        digest.update(np.ascontiguousarray(recording.channels[name]).tobytes())
    return Opened(recording, head, digest.hexdigest())
