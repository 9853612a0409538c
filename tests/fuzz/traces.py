"""Damaged trace files of every format: refused in one line, or read right; no channel comes under the name of another.

What is read of a damaged text is compared with what was written. Flipped digits cannot be seen by any reader, so a
signal may hold as many foreign values as bytes or lines were touched, and a channel that slipped holds only such.
"""

from __future__ import annotations

import gzip
import random
import tempfile
from collections.abc import Callable
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from feeddrive.cli.main import main
from feeddrive.errors import InputError
from feeddrive.recording import read_recording
from feeddrive.recording.files.opening import open_file
from feeddrive.recording.traces.channel_choice import Wishes
from feeddrive.recording.traces.opened import read_trace, understand
from feeddrive.recording.traces.trace import Trace
from tests.analytic import test_trace_containers as containers
from tests.analytic import trace_files as made
from tests.fuzz.harness import Attempt

SAMPLES = Path(__file__).parents[1] / "data" / "traces"
WISHES = Wishes(sample_time=1e-3)

TEXTS: dict[str, Callable[[], str]] = {
    "a.csv": made.twincat,
    "b.csv": lambda: made.twincat(";", ","),
    "c.csv": lambda: made.twincat(",", "."),
    "d.csv": lambda: made.twincat(" ", "."),
    "e.sco": made.tncscope,
    "f.xml": lambda: made.sinumerik_trace(rows=400)[0],
    "g.json": lambda: made.edge_json(rows=400),
    "h_hfdata.csv": lambda: made.edge_csv(rows=400),
    "i.log": made.halscope_old,
    "j.log": made.halscope_new,
    "k.txt": made.halsampler,
    "l.txt": lambda: made.halsampler(numbered=False, overrun=False),
    "m.xml": lambda: gzip.decompress((SAMPLES / "sinumerik_frf" / "freq_trace.xml.gz").read_bytes()).decode("latin-1"),
}
"""Texts by the name of their file."""

NEEDED = {"a.h5": "h5py", "b.mat": "h5py", "c.tdms": "nptdms", "d.mf4": "asammdf", "e.parquet": "pyarrow"}
BINARIES = [name for name, library in NEEDED.items() if find_spec(library) is not None]
SEPARATORS = ["\t", ";", ",", ":", " ", "|"]


@cache
def text_of(name: str) -> str:
    """Return an undamaged text."""
    return TEXTS[name]()


def attempt(generator: random.Random, folder: Path) -> Attempt:
    """Write a trace file that is damaged in one or several ways."""
    if BINARIES and generator.random() < 0.2:
        return _binary(generator, folder)
    name = generator.choice(list(TEXTS))
    text, touched, how = text_of(name), 0, []
    for _ in range(generator.choice([1, 1, 1, 2, 3])):
        damage = generator.choice(DAMAGES)
        text, more = damage(generator, text)
        touched += more
        how.append(damage.__name__.strip("_"))
    path = folder / name
    data = text.encode(generator.choice(["utf-8", "utf-8", "utf-8", "latin-1", "utf-16"]), "replace")
    if generator.random() < 0.1:
        path, data = folder / f"{name}.gz", gzip.compress(data)
    path.write_bytes(data)
    what = f"{name}: {', '.join(how)}"
    if generator.random() < 0.1:
        return Attempt(f"{what}, by the command line", lambda: main(["read", str(path), "--json"]))
    return Attempt(what, lambda: judge(path, name, touched))


def judge(path: Path, name: str, touched: int) -> int:
    """Read a file and compare what is read with what was written.

    Args:
        path: the damaged file.
        name: of the text that it was made from.
        touched: bytes and lines that the damage may have changed.
    """
    found = read_trace(open_file(path), WISHES)
    if not isinstance(found, Trace):
        return 0
    for signal in found.signals:
        right = values_of(name).get(signal.name)
        if right is None or not signal.values.size:
            continue
        wrong = int(np.sum(~np.isin(signal.values, right) & np.isfinite(signal.values)))
        if wrong > touched + 2:
            raise AssertionError(f"{signal.name} holds {wrong} of {signal.values.size} values that are not its own")
    if understand(found, WISHES, str(path)).choice.blocking:
        raise InputError("a question is left", str(path), "answer it")
    read_recording(path)
    return 0


@cache
def values_of(name: str) -> dict[str, Any]:
    """Return the values of each signal of an undamaged text, sorted."""
    with tempfile.TemporaryDirectory() as place:
        path = Path(place) / name
        path.write_text(text_of(name), encoding="utf-8", newline="")
        found = read_trace(open_file(path), WISHES)
    return {signal.name: np.unique(signal.values) for signal in found.signals} if isinstance(found, Trace) else {}


def _binary(generator: random.Random, folder: Path) -> Attempt:
    """Cut a binary file, or change bytes of it."""
    name = generator.choice([name for name in BINARIES if name != "d.mf4" or generator.random() < 0.1])  # it is slow
    path = folder / name
    containers.FORMATS[name](path)
    data = bytearray(path.read_bytes())
    if generator.random() < 0.4:
        data = data[: generator.randrange(8, len(data))]
    for _ in range(generator.choice([0, 1, 3, 20])):
        data[generator.randrange(len(data))] = generator.randrange(256)
    path.write_bytes(data)
    return Attempt(f"{name}: cut or flipped", lambda: read_recording(path) and 0)


def _truncate(generator: random.Random, text: str) -> tuple[str, int]:
    return text[: generator.randrange(len(text) + 1)], 1


def _flip(generator: random.Random, text: str) -> tuple[str, int]:
    count = generator.choice([1, 2, 5])
    letters = list(text)
    for _ in range(count if letters else 0):
        letters[generator.randrange(len(letters))] = chr(
            generator.choice([generator.randrange(32, 127), 0, 10, 9, 0xE4])
        )
    return "".join(letters), 2 * count


def _header_flip(generator: random.Random, text: str) -> tuple[str, int]:
    head = min(len(text), 1500)
    if not head:
        return text, 0
    at = generator.randrange(head)
    return text[:at] + chr(generator.randrange(32, 127)) + text[at + 1 :], 2


def _lines(text: str) -> list[str]:
    return text.split("\n")


def _swap_lines(generator: random.Random, text: str) -> tuple[str, int]:
    lines = _lines(text)
    a, b = generator.randrange(len(lines)), generator.randrange(len(lines))
    lines[a], lines[b] = lines[b], lines[a]
    return "\n".join(lines), 2


def _shuffle_lines(generator: random.Random, text: str) -> tuple[str, int]:
    lines = _lines(text)
    generator.shuffle(lines)
    return "\n".join(lines), 0


def _delete_lines(generator: random.Random, text: str) -> tuple[str, int]:
    lines = _lines(text)
    start = generator.randrange(len(lines))
    del lines[start : start + generator.choice([1, 2, 50])]
    return "\n".join(lines), 0


def _repeat_line(generator: random.Random, text: str) -> tuple[str, int]:
    lines = _lines(text)
    at = generator.randrange(len(lines))
    lines.insert(at, lines[at])
    return "\n".join(lines), 0


def _swap_separators(generator: random.Random, text: str) -> tuple[str, int]:
    old, new = generator.sample(SEPARATORS, 2)
    return text.replace(old, new), 0


def _swap_separators_of_a_line(generator: random.Random, text: str) -> tuple[str, int]:
    lines = _lines(text)
    at = generator.randrange(len(lines))
    old, new = generator.sample(SEPARATORS, 2)
    lines[at] = lines[at].replace(old, new)
    return "\n".join(lines), 3


def _drop_a_cell(generator: random.Random, text: str) -> tuple[str, int]:
    """Take a cell with its separator out of every line below some line: what slips silently if it can."""
    lines = _lines(text)
    separator = generator.choice(SEPARATORS)
    first, cell = generator.randrange(len(lines)), generator.randrange(6)
    last = generator.choice([first + 1, len(lines)])
    for at in range(first, min(last, len(lines))):
        cells = lines[at].split(separator)
        if len(cells) > cell + 1:
            del cells[cell]
            lines[at] = separator.join(cells)
    return "\n".join(lines), 1


def _odd_cell(generator: random.Random, text: str) -> tuple[str, int]:
    odd = ["", "nan", "inf", "1e999", "1,5", "--1", "9" * 5000, "\x1b[31m", "\u202e1", "0x10", "1_0", "٣", '"', "true"]
    lines = _lines(text)
    at, separator = generator.randrange(len(lines)), generator.choice(SEPARATORS)
    cells = lines[at].split(separator)
    cells[generator.randrange(len(cells))] = generator.choice(odd)
    lines[at] = separator.join(cells)
    return "\n".join(lines), 3


def _line_ends(generator: random.Random, text: str) -> tuple[str, int]:
    return text.replace("\r\n", "\n").replace("\n", generator.choice(["\r\n", "\r", "\n\n", "\n"])), 0


DAMAGES: list[Callable[[random.Random, str], tuple[str, int]]] = [
    _truncate, _flip, _flip, _header_flip, _header_flip, _swap_lines, _shuffle_lines, _delete_lines, _repeat_line,
    _swap_separators, _swap_separators_of_a_line, _drop_a_cell, _drop_a_cell, _odd_cell, _line_ends,
]  # fmt: skip
