"""Header of a TwinCAT 3 Scope export: which columns are times, which are channels, and their attributes.

Block 1 tells the export, block 2 holds one row for each attribute (`Name`, `Data-Type`, `Unit`, ...), in which the name
of the attribute stands again above every time column. Layout measured on exports of TwinCAT 3.4.3145.3; Beckhoff,
TE13xx TC3 Scope View, export options.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import combinations, pairwise
from math import comb

from feeddrive.errors import InputError

_STRUCTURES = ("Data-Type", "VariableSize", "SymbolBased", "IndexGroup", "IndexOffset", "Port", "ScaleFactor",
               "BitMask", "Offset")  # fmt: skip
"""Rows of one word for every channel, without blank or comma: they show the columns whatever separates. An export may
leave some of them out."""
_ATTRIBUTES = ("Name", "SymbolComment", "Data-Type", "SampleTime[ms]", "VariableSize", "SymbolBased", "IndexGroup",
               "IndexOffset", "SymbolName", "NetID", "Port", "Offset", "ScaleFactor", "BitMask", "Unit",
               "Unit ScaleFactor", "Unit Offset")  # fmt: skip
_UNIT_CELL = re.compile(r"\(None\)|\S+(?: \((?!None\))[^()]*\))?")
_NUMBER = re.compile(r"[+-]?\d")
"""Begins a row of numbers; attributes begin with a letter."""
_MOST_READINGS = 20_000  # ways of joining words that are tried: 3 joins in 50 words are 18 424


@dataclass(frozen=True)
class Header:
    """What stands above the numbers.

    Attributes:
        separator: of the cells.
        groups: channels of each time column, in the order of the columns.
        attributes: attribute -> one cell for each channel; only rows that could be split without doubt.
        start: of the export, 100 ns since 1601-01-01 UTC; 0 if the file does not say.
        first_line: index of the first line of numbers.
        notes: what was assumed.
    """

    separator: str
    groups: tuple[int, ...]
    attributes: dict[str, list[str]]
    start: int
    first_line: int
    notes: tuple[str, ...]


def read_header(lines: list[str], where: str) -> Header:
    """Read both blocks of the header.

    Raises:
        InputError: no second block, or rows of it that do not fit each other.
    """
    separator = lines[0][4:5]
    structure, mark = _structure(lines[:200], separator, where)
    top = max((i for i in range(structure + 1) if lines[i].startswith("Name" + separator)), default=structure)
    blank = (i for i in range(structure, len(lines)) if not lines[i].strip(separator + " ") or _NUMBER.match(lines[i]))
    end = next(blank, len(lines))
    marks = [cell == mark for cell in _cells(lines[structure], separator)]
    groups = _widths(marks)
    if any(width == 0 for width in groups):
        raise InputError("a time column has no channel", f"{where}, row {structure + 1}", "export it again")
    rows = {row: number for number in range(top, end) if (row := _attribute(lines[number], separator))}
    attributes = {
        name: cells
        for name, number in rows.items()
        if name not in ("Name", "SymbolComment")
        if (cells := _attribute_cells(lines[number], name, separator, groups)) is not None
    }
    names, remarks = _names(lines[top], separator, groups, attributes.get("SymbolName"), f"{where}, row {top + 1}")
    first = end
    while first < len(lines) and not lines[first].strip(separator + " "):  # an export may add an empty line
        first += 1
    return Header(separator, groups, {**attributes, "Name": names}, _start(lines[:top], separator), first, remarks)


def _structure(lines: list[str], separator: str, where: str) -> tuple[int, str]:
    """Return the index of the row that shows the columns, and the word that stands in it above every time."""
    for mark in (*_STRUCTURES, *(() if separator == " " else ("Name",))):
        found = [i for i, line in enumerate(lines) if line.startswith(mark + separator)]
        if found and (mark != "Name" or any(line.startswith("Starttime of export") for line in lines[: found[-1]])):
            return found[-1] if mark == "Name" else found[0], mark
    raise InputError("the rows that tell the channels are missing", where, "export it again, with its whole header")


def _attribute(line: str, separator: str) -> str:
    """Return the attribute that a row holds, the longest name that fits; empty if it is none."""
    return max((name for name in _ATTRIBUTES if line.startswith(name + separator)), key=len, default="")


def _cells(line: str, separator: str) -> list[str]:
    cells = [cell.strip().strip('"') for cell in line.split(separator)]
    while cells and not cells[-1]:  # old exports end each line with a separator
        cells.pop()
    return cells


def _widths(marks: list[bool]) -> tuple[int, ...]:
    """Return the channels of each group; marks tell for each cell whether a group begins there."""
    starts = [i for i, mark in enumerate(marks) if mark] + [len(marks)]
    return tuple(after - before - 1 for before, after in pairwise(starts))


def _attribute_cells(line: str, name: str, separator: str, groups: tuple[int, ...]) -> list[str] | None:
    """Return the cells of the channels, None where they cannot be split without doubt."""
    if separator == " ":
        parts = re.split(rf"(?:^| ){re.escape(name)}(?: |$)", line)[1:]
        split = [_UNIT_CELL.findall(part) if name == "Unit" else part.split() for part in parts]
    else:
        cells = [cell.strip().strip('"') for cell in line.split(separator)]
        starts = [i for i, cell in enumerate(cells) if cell == name] + [len(cells)]
        split = [cells[a + 1 : b] for a, b in pairwise(starts)]
    if len(split) != len(groups):
        return None
    while split and len(split[-1]) > groups[-1] and not split[-1][-1]:  # as many as a table program writes
        split[-1].pop()
    while len(split[-1]) < groups[-1]:  # empty cells at the end of a line are left out
        split[-1].append("")
    if any(len(cells) != width for cells, width in zip(split, groups, strict=True)):
        return None
    return [cell for cells in split for cell in cells]


def _names(
    line: str, separator: str, groups: tuple[int, ...], symbols: list[str] | None, where: str
) -> tuple[list[str], tuple[str, ...]]:
    if separator != " ":
        names = _attribute_cells(line, "Name", separator, groups)
        if names is None:
            what = f"the names do not fit the {sum(groups)} channels of {len(groups)} time columns"
            raise InputError(what, where, "export it again with the tab as separator")
        return names, ()
    return _names_between_blanks(line, groups, symbols, where)


def _names_between_blanks(
    line: str, groups: tuple[int, ...], symbols: list[str] | None, where: str
) -> tuple[list[str], tuple[str, ...]]:
    """Put the words of names together where a blank separates both words and names."""
    parts = [part.split() for part in re.split(r"(?:^| )Name(?= )", line)[1:]]
    mend = "export it again with the tab as separator"
    if len(parts) != len(groups):
        raise InputError("the names of the channels cannot be told apart", where, mend)
    tails = [symbol.rsplit(".", 1)[-1] for symbol in symbols or [""] * sum(groups)]
    names: list[str] = []
    joined = False
    for words, width in zip(parts, groups, strict=True):
        found = _joined(words, width, tails[len(names) : len(names) + width])
        if found is None:
            what = f"{len(words)} words make {width} names of channels, and which belong together cannot be told"
            raise InputError(what, where, mend)
        joined = joined or len(words) > width
        names.extend(found)
    note = "blanks separate words of names too: " + ", ".join(f'"{name}"' for name in names if " " in name)
    return names, ((note + " were put together",) if joined else ())


def _joined(words: list[str], width: int, tails: list[str]) -> list[str] | None:
    """Return the one reading of words as `width` names; None if there is none, or several are as good.

    A copy is named by the Scope as `name (1)`, so such a number belongs to a name that is there as well. Of what
    remains the best reading names most channels as their symbols, then joins the fewest different pairs of words.
    """
    if len(words) < width or comb(len(words) - 1, width - 1) > _MOST_READINGS:
        return None
    found: dict[tuple[int, int], list[list[str]]] = {}
    for cuts in combinations(range(1, len(words)), width - 1):
        ends = (0, *cuts, len(words))
        pieces = [words[a:b] for a, b in pairwise(ends)]
        names = [" ".join(piece) for piece in pieces]
        if len(set(names)) < width or not _copies_fit(names):
            continue
        joins = {pair for piece in pieces for pair in pairwise(piece)}
        matching = sum(name == tail for name, tail in zip(names, tails, strict=True))
        found.setdefault((-matching, len(joins)), []).append(names)
    if not found:
        return None
    best = found[min(found)]
    return best[0] if len(best) == 1 else None


def _copies_fit(names: list[str]) -> bool:
    for name in names:
        if name.startswith("(") and re.fullmatch(r"\(\d+\).*", name):
            return False
        copy = re.fullmatch(r"(.+) \(\d+\)", name)
        if copy is not None and copy[1] not in names:
            return False
    return True


def _start(lines: list[str], separator: str) -> int:
    for line in lines:
        plain = line.replace('"', "")
        found = re.match(rf"Starttime of export{re.escape(separator)}(\d{{17,19}})(?!\d)", plain)
        if found:
            return int(found[1])
    return 0
