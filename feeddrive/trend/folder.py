"""What lies in a folder: recordings, archives and dumps of a control, and when each was made.

Files in sub-folders and members of zip archives are recordings of their own. A file whose size or time has not changed
since it was read is not opened again. Its date is taken from a pattern of its name, from its content, or from a date
in its name: the time of the clock that wrote it; time zones are passed over, as a control writes its own all year.
"""

from __future__ import annotations

import hashlib
import re
import tempfile
import time
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np

from feeddrive.errors import InputError, printable
from feeddrive.recording import Recording, read_recording
from feeddrive.recording.files.opening import first_bytes, head_of

_CLOCK = r"(?:[T ,;\t]+(?P<hour>[01]?\d|2[0-3]):(?P<minute>[0-5]\d)(?::(?P<second>[0-5]\d))?)?"
_TIME = r"(?:[T _-]{1,2}(?P<hour>[01]\d|2[0-3])[:.h-]?(?P<minute>[0-5]\d)(?:[:.m-]?(?P<second>[0-5]\d))?)?"
_NAME = re.compile(
    r"(?<!\d)(?P<year>(?:19|20)\d\d)[-_.]?(?P<month>0[1-9]|1[0-2])[-_.]?(?P<day>0[1-9]|[12]\d|3[01])"
    + _TIME
    + r"(?!\d)"
)
_ISO = re.compile(
    r"(?<!\d)(?P<year>(?:19|20)\d\d)-(?P<month>0[1-9]|1[0-2])-(?P<day>0[1-9]|[12]\d|3[01])"
    r"(?:[T ](?P<hour>[01]\d|2[0-3]):(?P<minute>[0-5]\d)(?::(?P<second>[0-5]\d))?)?"
)
_DOTTED = re.compile(
    r"(?<!\d)(?P<day>0?[1-9]|[12]\d|3[01])\.(?P<month>0?[1-9]|1[0-2])\.(?P<year>(?:19|20)\d\d)" + _CLOCK
)
_TOLD = re.compile(r"start|date|datum|time|zeit|record|created|stamp", re.IGNORECASE)
_FILETIME = re.compile(r"Starttime of export\"?[\t;:, ]+\"?(\d{17,19})(?!\d)")
_UNIX = re.compile(r"^%TIME=(\d{9,10})\s*$.*?(?:^%DIFFTIMEUTC=(-?\d{1,6})\s*$|\[)", re.MULTILINE | re.DOTALL)
_XML_START = re.compile(r"<frameHeader\b[^>]*\bstartTime=\"([^\"]{10,40})\"")
_LINES = 60
"""Lines at the beginning of a file in which its date is looked for; a header ends before."""


def stamp_of(name: str, head: str, pattern: str) -> tuple[datetime, str] | None:
    """When a recording was made, and where that stands: in its name by a pattern of `strptime`, or its head; or None.

    Raises InputError for a pattern, such as "%Y%m%d_%H%M", that the name does not hold.
    """
    if pattern:
        return _by_pattern(name, pattern), "name, by the pattern"
    written = _from_content(head)
    if written is not None:
        return written, "content"
    match = _NAME.search(name)
    found = None if match is None else _moment(match)
    return None if found is None else (found, "name")


def read_moment(text: str, where: str) -> datetime:
    """A moment as a person writes it, "2026-01-31" or "2026-01-31 14:30".

    Raises:
        InputError: it is none.
    """
    match = _ISO.fullmatch(text.strip())
    found = None if match is None else _moment(match)
    if found is None:
        raise InputError(f'"{text}" is no date', where, 'write it as "2026-01-31" or "2026-01-31 14:30"')
    return found


def _from_content(head: str) -> datetime | None:
    filetime = _FILETIME.search(head)
    if filetime is not None:  # 100 ns since 1601
        return datetime(1601, 1, 1) + timedelta(microseconds=int(filetime[1]) // 10)
    unix = _UNIX.search(head)
    if unix is not None:  # TNCscope: s since 1970, and what the control's own time is ahead of UTC
        return datetime(1970, 1, 1) + timedelta(seconds=int(unix[1]) + int(unix[2] or 0))
    started = _XML_START.search(head)
    match = None if started is None else _ISO.search(started[1])
    if match is not None and _moment(match) is not None:
        return _moment(match)
    told = False
    for line in head.split("\n")[:_LINES]:
        below, told = told, _TOLD.search(line) is not None
        if not told and not below:  # a date below the word is the first of a column
            continue
        for pattern in (_ISO, _DOTTED):
            match = pattern.search(line)
            found = None if match is None else _moment(match)
            if found is not None:
                return found
    return None


def _moment(match: re.Match[str]) -> datetime | None:
    parts = match.groupdict()
    year, month, day, hour, minute, second = (
        int(parts[key] or 0) for key in ("year", "month", "day", "hour", "minute", "second")
    )
    try:
        return datetime(year, month, day, hour, minute, second)
    except ValueError:  # the 31st of a shorter month
        return None


def _by_pattern(name: str, pattern: str) -> datetime:
    """A moment by a pattern of `strptime` that a part of the name meets, the longest part first."""
    if not any(mark in pattern for mark in ("%d", "%j", "%c", "%x")):
        raise InputError(f'the pattern "{pattern}" names no day', "stamp", "write it as for strptime: %Y%m%d_%H%M")
    for length in range(len(name), 0, -1):
        for begin in range(len(name) - length + 1):
            try:
                return datetime.strptime(name[begin : begin + length], pattern)
            except ValueError:
                continue
    raise InputError(f'the name does not hold the pattern "{pattern}"', name, "write it as for strptime: %Y%m%d_%H%M")


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
    """What lies in a folder and below, by name, `own` left out; a pair of key and reason for an archive not opened.

    Raises InputError for no such folder.
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
