"""Mapping files: which variable of a foreign file is which channel, times what, in which unit.

    format = "feeddrive-map/1"
    sample_time = "1 ms"            # where the file holds no time, in place of [time]

    rate = "500 Hz"                 # trace files: of the one grid; with times of its own a file needs nothing else
    part = 1                        # trace files: the stretch between gaps, 1 for the first; the longest if left out

    [time]
    variable = "t"
    unit = "s"

    [channels.motor_torque]
    variable = ["gtau", "vir"]      # multiplied sample by sample; single numbers are spread
    unit = "N/V * V"                # of their product
    factor = "0.4 mm"               # a number, or a number with its unit
    offset = "0.1 N m"              # added last, in a unit of the channel
    hold = "zero_order"             # acts from its sample to the next; or "interval_before"
    column = 1                      # of a matrix

    [file]                          # text files only
    header_row = 1                  # 0 if there is none: the columns are then "1", "2", ...
    first_row = 2
    separator = ";"
    decimal = ","

Nothing in the file is evaluated.
"""

from __future__ import annotations

import difflib
import sys
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any

from feeddrive.errors import InputError, quoted
from feeddrive.recording.channels import channel_unit
from feeddrive.recording.files.csv_file import Layout
from feeddrive.recording.files.opening import opened
from feeddrive.schema.mapping import MAPPING
from feeddrive.schema.toml_text import refuse_other_format
from feeddrive.units.quantity import Conversion, parse, split_quantity, unit_conversion

FORMAT = "feeddrive-map/1"
LONGEST = 1_000_000
"""Bytes of a mapping file at most; a hundred channels take ten thousand."""

LONGEST_LINE = 2000
"""Letters of a line at most; the time that a key takes to read grows with the square of its dots."""

_TOP_KEYS = MAPPING.names()
_VARIABLE_KEYS = MAPPING.sections["time"].names()
_FILE_KEYS = MAPPING.sections["file"].names()


class Hold(Enum):
    """For which time a sample stands."""

    ZERO_ORDER = "zero_order"
    """From its time stamp to the next; positions are read at the stamp."""
    INTERVAL_BEFORE = "interval_before"
    """From the stamp before to its own; read one row later."""


@dataclass(frozen=True)
class Variable:
    """A channel as it stands in a foreign file: si = conversion(factor * product of the variables) + offset.

    Attributes:
        names: variables that are multiplied.
        factor: number [1].
        conversion: from the unit of factor and variables to the unit of the channel.
        offset: added last [unit of the channel].
        hold: for which time a sample stands.
        column: of a matrix, 1 for the first.
    """

    names: tuple[str, ...]
    factor: float
    conversion: Conversion
    offset: float
    hold: Hold
    column: int


@dataclass(frozen=True)
class FileMapping:
    """A mapping file.

    Attributes:
        name: name of the mapping file.
        time: the time variable; None if `sample_time` stands for it.
        sample_time: [s]; None if the file holds the time.
        channels: canonical channel -> its variable.
        layout: where the table stands in a text file.
        rate: of the one grid of a trace file [Hz]; None for that of its slowest channel.
        part: of a trace file between gaps, 1 for the first; None for the longest.
    """

    name: str
    time: Variable | None
    sample_time: float | None
    channels: dict[str, Variable]
    layout: Layout
    rate: float | None = None
    part: int | None = None


def read_mapping(path: Path) -> FileMapping:
    """Read a mapping file.

    Raises:
        InputError: not found, not TOML, another format, unknown key or channel, a unit that does not fit.
    """
    where = str(path)
    tree = _toml(path, where)
    refuse_other_format(tree, FORMAT, where)
    _refuse_unknown(tree, _TOP_KEYS, where)
    if ("time" in tree and "sample_time" in tree) or not {"time", "sample_time", "rate"} & set(tree):
        mend = 'e.g. sample_time = "1 ms", or rate = "1 kHz" for a trace file that has its own time'
        raise InputError("needs either [time] or sample_time", where, mend)
    channels = _table(tree, "channels", where)
    if not channels:
        raise InputError("maps no channel", where, "add e.g. [channels.motor_torque]")
    read = {name: _variable(channels, name, channel_unit(name, where), f"{where}, channels") for name in channels}
    time = _variable(tree, "time", "s", where) if "time" in tree else None
    sample_time = parse(tree["sample_time"], "s", f"{where}, sample_time") if "sample_time" in tree else None
    if sample_time is not None and sample_time <= 0.0:
        raise InputError("the sample time is not positive", f"{where}, sample_time", 'e.g. "1 ms"')
    rate = parse(tree["rate"], "Hz", f"{where}, rate") if "rate" in tree else None
    if rate is not None and rate <= 0.0:
        raise InputError("the rate is not positive", f"{where}, rate", 'e.g. "1 kHz"')
    part = _count(tree["part"], 1, f"{where}, part") if "part" in tree else None
    return FileMapping(path.name, time, sample_time, read, _layout(_table(tree, "file", where), where), rate, part)


def _toml(path: Path, where: str) -> dict[str, Any]:
    with opened(path, "mapping file") as file:
        raw = file.read(LONGEST + 1)
    if len(raw) > LONGEST:
        raise InputError(f"is longer than {LONGEST // 1000} kB", where, "name a mapping file")
    longest = max(map(len, raw.splitlines()), default=0)
    if longest > LONGEST_LINE:
        raise InputError(f"has a line of {longest} letters", where, "write one key to a line")
    try:
        return tomllib.loads(raw.decode("utf-8"))
    except RecursionError:
        raise InputError("is nested too deeply", where, "write one table to a channel") from None
    except ValueError as error:  # besides its own, those of numbers that Python does not convert, and of the encoding
        raise InputError(f"is not TOML: {quoted(str(error), 120)}", where, "correct that line") from None


def _variable(tree: dict[str, Any], key: str, needed: str, where: str) -> Variable:
    """Read the table of one variable, whose channel is in the unit `needed`."""
    table, where = _table(tree, key, where), f"{where}.{key}" if where.endswith("channels") else f"{where}, {key}"
    _refuse_unknown(table, _VARIABLE_KEYS, where)
    factor, conversion = _conversion(table, needed, where)
    offset_unit = "K" if needed == "degC" else needed
    offset = parse(table["offset"], offset_unit, f"{where}, offset") if "offset" in table else 0.0
    hold = _choice(table.get("hold", "zero_order"), [kind.value for kind in Hold], f"{where}, hold")
    column = _count(table.get("column", 1), 1, f"{where}, column")
    return Variable(_names(table, where), factor, conversion, offset, Hold(hold), column)


def _names(table: dict[str, Any], where: str) -> tuple[str, ...]:
    names = table.get("variable")
    listed = names if isinstance(names, list) else [names]
    if not listed or not all(isinstance(name, str) and name for name in listed):
        raise InputError("needs the variable that it is read from", where, 'e.g. variable = "t"')
    return tuple(listed)


def _conversion(table: dict[str, Any], needed: str, where: str) -> tuple[float, Conversion]:
    """Return the number of the factor, and the conversion of the units of variables and factor together."""
    unit = table.get("unit")
    if not isinstance(unit, str):
        raise InputError("needs the unit of what the file holds", where, f'e.g. unit = "{needed}"')
    written = table.get("factor", 1.0)
    if isinstance(written, bool) or not isinstance(written, str | int | float):
        raise InputError("the factor is not a number", f"{where}, factor", 'e.g. factor = 2.0 or factor = "0.4 mm/rad"')
    if isinstance(written, int) and abs(written) > sys.float_info.max:
        raise InputError("the factor is beyond what can be computed with", f"{where}, factor", "e.g. factor = 2.0")
    factor, factor_unit = split_quantity(str(written), f"{where}, factor")
    if factor_unit == "1":
        return factor, unit_conversion(unit, needed, f"{where}, unit")
    together = f"({unit}) * ({factor_unit})"
    # A factor such as 10 K/V carries no zero of its own: a temperature is then offset by the key `offset`.
    target = "K" if needed == "degC" else needed
    if needed == "N m":
        together, target = _lever(together, where)
    return factor, unit_conversion(together, target, f"{where}, unit times factor")


def _lever(together: str, where: str) -> tuple[str, str]:
    """Accept a lever arm as travel per angle (N * mm/rad) as well as as a length (N * mm)."""
    try:
        unit_conversion(together, "N m/rad", where)
    except InputError:
        return together, "N m"
    return together, "N m/rad"


def _layout(table: dict[str, Any], where: str) -> Layout:
    where = f"{where}, file"
    _refuse_unknown(table, _FILE_KEYS, where)
    header = _count(table["header_row"], 0, f"{where}.header_row") if "header_row" in table else None
    first = _count(table["first_row"], 1, f"{where}.first_row") if "first_row" in table else None
    if header is not None and first is not None and first <= header:
        raise InputError("the first row of numbers does not follow the header", where, "first_row > header_row")
    separator = _choice(table["separator"], [",", ";", "\t"], f"{where}.separator") if "separator" in table else None
    decimal = _choice(table["decimal"], [".", ","], f"{where}.decimal") if "decimal" in table else None
    return Layout(header, first, separator, decimal)


def _table(tree: dict[str, Any], key: str, where: str) -> dict[str, Any]:
    table = tree.get(key, {})
    if not isinstance(table, dict):
        raise InputError(f"{key} is not a table", where, f"write it as [{key}]")
    return table


def _choice(value: object, allowed: list[str], where: str) -> str:
    if not isinstance(value, str) or value not in allowed:
        raise InputError(f"'{quoted(value)}' is not possible", where, f"write one of {', '.join(map(repr, allowed))}")
    return value


def _count(value: object, smallest: int, where: str) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not smallest <= value <= LONGEST:
        raise InputError(f"{quoted(value)} is not a whole number from {smallest} on", where, f"e.g. {smallest}")
    return value


def _refuse_unknown(given: Iterable[str], known: tuple[str, ...], where: str) -> None:
    for key in given:
        if key not in known:
            near = difflib.get_close_matches(key, known, n=1, cutoff=0.0)[0]
            raise InputError(f'unknown key "{key}"', where, f'did you mean "{near}"?')
