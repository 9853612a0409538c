"""Large traces: lines are cut out when they are asked for, and reading takes no more than 2.5 times the file."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from feeddrive.recording.traces.lines import Lines
from tests.analytic import trace_files as traces

MOST = 2.5
"""Memory beside the program's own, as a multiple of the file."""
ROWS, BLOCK = 1_000_000, 20_000

_PEAK = """
import resource, sys
from pathlib import Path
from feeddrive.recording.files.reading import read_recording
read_recording(Path(sys.argv[2]))  # what is loaded for a small one
own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
rows = len(read_recording(*map(Path, sys.argv[1::2])))
print(rows, 1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - own))
"""


@pytest.mark.parametrize("text", ["", "a", "a\n", "\n\n", "µ;1,5\nb\n\nlonger \U0001f600 line\nend", "x\n" * 50_000])
def test_lines_are_those_of_split(text: str) -> None:
    lines, split = Lines(text), text.split("\n")
    assert list(lines) == split and len(lines) == len(split) and lines.block == text
    assert [lines[i] for i in (0, -1)] == [split[0], split[-1]]
    for part in (slice(1, None), slice(0, 2), slice(2, 1), slice(-2, None), slice(5, 9)):
        assert list(lines[part]) == split[part] and list(lines[part][:1]) == split[part][:1]
    with pytest.raises(IndexError):
        lines[len(split)]
    for sign in ("e", "\U0001f600", "?"):
        wanted = next((i for i, line in enumerate(split) if sign in line), None)
        assert lines.first_with(sign) == wanted


def _twincat() -> Iterator[str]:
    yield "\r\n".join([line for line in traces.twincat().split("\n") if not line[:1].isdigit()][:-1]) + "\r\n"
    for first in range(0, ROWS, BLOCK):
        row = np.arange(first, first + BLOCK)
        time = row * 1e-3
        place, speed, _ = traces.motion(time)
        fast = np.column_stack([time * 1e3, place, speed, traces.current(time)]).tolist()
        slow = [f"\t{4.0 * i}\t20.5" if 4 * i < ROWS else "" for i in row.tolist()]
        yield "".join("\t".join(map(repr, cells)) + rest + "\r\n" for cells, rest in zip(fast, slow, strict=True))


def _capture() -> Iterator[tuple[int, list[list[float]]]]:
    for first in range(0, ROWS, BLOCK):
        row = np.arange(first, first + BLOCK)
        place, speed, _ = traces.motion(2e-3 * row)
        flow = traces.current(2e-3 * row)
        columns = [row + 5e3, place, place + speed / 80, flow, traces.TORQUE_CONSTANT * flow, 60 * speed]
        yield first, np.column_stack(columns).tolist()


def _edge_table() -> Iterator[str]:
    yield "," + ",".join(traces.edge_rows(1)[0]) + "\n"
    for first, rows in _capture():
        yield "".join(f"{first + i},{','.join(map(repr, row))}\n" for i, row in enumerate(rows))


def _edge_json() -> Iterator[str]:
    head, _, rest = traces.edge_json(30).partition('"Payload": [')
    yield f'{head}"Payload": ['
    for first, rows in _capture():
        items = [json.dumps({"HFData": rows[i : i + 30]}) for i in range(0, BLOCK, 30)]
        yield (", " if first else "") + ", ".join(items)
    yield "]" + rest[rest.rindex("]") + 1 :]


def _scope() -> Iterator[str]:
    head = traces.tncscope(rows=1).replace("%COUNT=1\r", f"%COUNT={ROWS}\r").split("\r\n")
    yield "\r\n".join(head[:-2]) + "\r\n"
    for first in range(0, ROWS, BLOCK):
        time = 3e-3 * np.arange(first, first + BLOCK)
        place, speed, _ = traces.motion(time)
        rows = np.column_stack([time * 1e6, place, place + speed / 50.0, 60.0 * speed, traces.current(time)]).tolist()
        yield "".join(" " + "; ".join(f"{cell:.9e}" for cell in row) + "; \r\n" for row in rows)


def _halscope(begin: str, row: str) -> Callable[[], Iterator[str]]:
    def parts() -> Iterator[str]:
        yield begin
        for first in range(0, ROWS, BLOCK):
            place, speed, _ = traces.motion(1e-3 * np.arange(first, first + BLOCK))
            yield "".join(row % (a, a + b / 50) for a, b in zip(place.tolist(), speed.tolist(), strict=True))

    return parts


def _operate() -> Iterator[str]:
    whole, _ = traces.sinumerik_trace(rows=10)
    head = whole[: whole.index("<rec ")]
    yield (
        head.replace("0.004000", "0.002000")
        .replace('datapointCount="10"', f'datapointCount="{ROWS}"')
        .replace('datapointCount="4"', f'datapointCount="{ROWS}"')
    )
    for first in range(0, ROWS, BLOCK):
        time = 2e-3 * np.arange(first, first + BLOCK)
        place, speed, _ = traces.motion(time)
        rows = np.column_stack([time, traces.current(time), place, 60.0 * speed]).tolist()
        yield "".join('<rec time="{:.6f}" f1="{:.6f}" f2="{:.6f}" f3="{:.6f}"/>\n'.format(*row) for row in rows)
    yield whole[whole.rindex("</dataFrame>") :]


_OLD = _halscope(
    "Sampling period is 1000000 nSec \n\n", "joint.0.pos-fb %+.14f joint.0.pos-cmd %+.14f \n"
)  # fmt: skip
_NEW = _halscope("# Sampling period is 1000000 ns\njoint.0.pos-fb;joint.0.pos-cmd\n", "%.14f;%.14f\n")


_UNITS = """format = "feeddrive-map/1"
description = "halscope log"
rate = "1 kHz"

[channels.table_position]
variable = "joint.0.pos-fb"
unit = "mm"

[channels.setpoint]
variable = "joint.0.pos-cmd"
unit = "mm"
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "parts"),
    [("a.csv", _twincat), ("a_hfdata.csv", _edge_table), ("a.json", _edge_json), ("a.sco", _scope),
     ("a.xml", _operate), ("old.log", _OLD), ("new.log", _NEW)],
)  # fmt: skip
def test_large_trace_is_read_in_two_and_a_half_times_the_file(
    name: str, parts: Callable[[], Iterator[str]], tmp_path: Path
) -> None:
    """The bytes are given up for the text, the text for its numbers, and no object stands for a line or a cell."""
    path = tmp_path / name
    with path.open("w", encoding="utf-8", newline="") as file:
        file.writelines(parts())
    small = tmp_path / "small.csv"
    small.write_text(traces.twincat(), encoding="utf-8")
    files = [str(path), str(small)]
    if path.suffix == ".log":  # halscope says no units
        mapping = tmp_path / "map.toml"
        mapping.write_text(_UNITS, encoding="utf-8")
        files.append(str(mapping))
    ran = subprocess.run([sys.executable, "-c", _PEAK, *files], capture_output=True, text=True, check=True)
    rows, peak = map(int, ran.stdout.split())
    sys.stdout.write(f"{name}: {path.stat().st_size / 1e6:.0f} MB, {peak / path.stat().st_size:.2f} times\n")
    assert rows == ROWS and peak < MOST * path.stat().st_size
