"""When a recording was made: by a pattern of its name, from its content, or from a name that holds a date.

The time is that of the clock that wrote it; time zones are passed over, as a control writes its own all year.
"""

from __future__ import annotations

import re
from datetime import datetime, timedelta

from feeddrive.errors import InputError

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
_FILETIME = re.compile(r"Starttime of export\"?[\t;, ]+\"?(\d{17,19})(?!\d)")
_LINES = 60
"""Lines at the beginning of a file in which its date is looked for; a header ends before."""


def stamp_of(name: str, head: str, pattern: str) -> tuple[datetime, str] | None:
    """When a recording was made, and where that stands; None where nothing tells.

    Args:
        name: of the file, or of the member of an archive.
        head: beginning of its text.
        pattern: of `strptime` for a part of the name, such as "%Y%m%d_%H%M"; empty for none.

    Raises:
        InputError: a pattern that the name does not hold.
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
    for line in head.split("\n")[:_LINES]:
        if not _TOLD.search(line):
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
