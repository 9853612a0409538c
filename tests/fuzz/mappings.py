"""Mapping files with anything in them, each beside a foreign file that a good one would read."""

from __future__ import annotations

import io
import random
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
from scipy.io import savemat

from feeddrive.recording import read_recording
from tests.fuzz.harness import Attempt

GOOD = """format = "feeddrive-map/1"
[time]
variable = "t"
unit = "s"
[channels.motor_torque]
variable = ["u", "k"]
unit = "N/V * V"
factor = "0.4 m"
hold = "zero_order"
[channels.motor_angle]
variable = "matrix"
unit = "rad"
column = 2
offset = "1 rad"
[channels.nut_temperature]
variable = "s.T"
unit = "degC"
"""

TEXT = """format = "feeddrive-map/1"
sample_time = "1 ms"
[file]
header_row = 1
first_row = 2
separator = ";"
decimal = ","
[channels.motor_torque]
variable = "u"
unit = "N m"
[channels.table_position]
variable = "x"
unit = "mm"
"""

UNITS = [
    "9**9**9 s", "1 kg*2**2**2**2**2**2", "s^999999999", "(" * 70 + "s", "s/0", "1/0", "s*0", "0", "m" * 5000, "", " ",
    "rad/s^2", "rpm", "Hz", "dB", "__import__('os')", "s if 1 else m", "s; m", "lambda: s", "s[0]", "'s'", "s\n",
    "\u202es", "\x1b[0m", "K", "degF", "N m/(rad/s)^(2/3)", "N m/(rad/s)^(2/0)", "N m^1e9", "N m^-7", "µm", "1e-3 s",
    "1e400 s", "nan", "inf s", "10^6 s", "s^s", "%", "°", "kg·m²", "N^²", "s**", "**s", "s * / m", "()", "s()", "s=m",
    "ppm",
]  # fmt: skip

VALUES = [
    "0", "-1", "1", "2", "1e308", "-1e308", "1e-320", "nan", "inf", "true", "[]", "{}", '""', '"x"', "1e150",
    "9" * 5000, "0x" + "f" * 20_000, "1979-05-27", "[1, 2]", '["u", 1]', '["u", "u", "u"]', '"1 ms"', '"-1 ms"',
    '"1e400 s"', '"0 s"', '"1e-300 s"', '"1e300 s"', '"' + "a" * 300_000 + '"', '"\\u001b[31m"', '"\\u202e"',
    "'''\n\n'''", "[" * 200 + "]" * 200, "-0", "+5", "1_000", "999999999999999999999", "18446744073709551616",
    '"9**9**9 s"', '"2 mm"', '"1 N m"', '"zero_order"', '"interval_before"', '"."', '","', '"\\t"', '";"',
]  # fmt: skip

KEYS = [
    "variable", "unit", "factor", "offset", "hold", "column", "header_row", "first_row", "separator", "decimal",
    "sample_time", "format", "description", "time", "channels", "file", "\\u001b", '"\\u202e"',
    '"' + "k" * 300_000 + '"', '""', "a.b.c",
]  # fmt: skip


LINES = [
    "[", "[[channels]]", "[channels.x]", "[time]", "[file]", "[channels.time]", "\x00", "= 1",
    "[channels." + "a" * 9000 + "_temperature]",
]  # fmt: skip


def attempt(generator: random.Random, folder: Path) -> Attempt:
    """Write a mapping that is broken in one or several ways, and the file that it is for."""
    kind, change = generator.choice(KINDS)
    base = generator.choice([GOOD, TEXT])
    mapping, data = folder / "map.toml", folder / ("a.mat" if base is GOOD else "a.csv")
    data.write_bytes(_mat() if base is GOOD else _csv())
    mapping.write_bytes(change(generator, base))
    decimal = generator.choice([None, None, ".", ","])
    return Attempt(f"{kind}, {data.name}, decimal={decimal}", lambda: read_recording(data, mapping, decimal=decimal))


@cache
def _mat() -> bytes:
    time = np.arange(400) * 1e-3
    held = io.BytesIO()
    matrix = np.column_stack((time, 30 * np.sin(9 * time), np.cos(time)))
    savemat(held, {"t": time, "u": np.sin(20 * time), "k": 3.0, "matrix": matrix, "s": {"T": 20 + time}, "name": "axis",
                   "short": time[:99], "huge": 1e300 * np.sin(time), "cube": np.ones((3, 4, 5)), "complex": time + 1j,
                   "none": np.zeros((0, 0)), "cells": np.array([1, "a"], dtype=object)})  # fmt: skip
    return held.getvalue()


@cache
def _csv() -> bytes:
    time = np.arange(400) * 1e-3
    lines = [f"{i};{np.sin(20 * t):.5f};{10 * np.sin(9 * t):.5f}" for i, t in enumerate(time)]
    return "\n".join(["n;u;x", *lines]).replace(".", ",").encode()


def _good(generator: random.Random, base: str) -> bytes:
    return base.encode()


def _values(generator: random.Random, base: str) -> bytes:
    """Values of keys exchanged for others."""
    lines = base.splitlines()
    held = [i for i, line in enumerate(lines) if " = " in line]
    for _ in range(generator.choice([1, 1, 1, 2, 4])):
        place = generator.choice(held)
        lines[place] = f"{lines[place].split(' = ')[0]} = {generator.choice(VALUES)}"
    return "\n".join(lines).encode("utf-8", "surrogatepass")


def _units(generator: random.Random, base: str) -> bytes:
    lines = base.splitlines()
    held = [i for i, line in enumerate(lines) if line.startswith(("unit", "factor", "offset", "sample_time"))]
    for _ in range(generator.choice([1, 1, 2])):
        place, unit = generator.choice(held), generator.choice(UNITS)
        number = "" if lines[place].startswith("unit") else generator.choice(["1 ", "0.4 ", "1e300 ", "1e-300 ", ""])
        escaped = "".join(c if c.isprintable() and c not in '"\\' else f"\\u{ord(c):04x}" for c in number + unit)
        lines[place] = f'{lines[place].split(" = ")[0]} = "{escaped}"'
    return "\n".join(lines).encode()


def _variables(generator: random.Random, base: str) -> bytes:
    names = [
        "t",
        "u",
        "k",
        "x",
        "n",
        "name",
        "short",
        "huge",
        "cube",
        "complex",
        "none",
        "cells",
        "s",
        "s.T",
        "s.T.x",
        ".",
        "matrix",
    ]
    lines = base.splitlines()
    for place, line in enumerate(lines):
        if line.startswith("variable") and generator.random() < 0.5:
            chosen = ", ".join(f'"{generator.choice(names)}"' for _ in range(generator.choice([1, 1, 2, 40])))
            lines[place] = f"variable = [{chosen}]"
    return "\n".join(lines).encode()


def _keys(generator: random.Random, base: str) -> bytes:
    """Lines added, lost, doubled and moved."""
    lines = base.splitlines()
    for _ in range(generator.choice([1, 2, 5])):
        place = generator.randrange(len(lines) + 1)
        kind = generator.randrange(4)
        if kind == 0:
            lines[place:place] = [f"{generator.choice(KEYS)} = {generator.choice(VALUES)}"]
        elif kind == 1 and len(lines) > 1:
            lines[place : place + 1] = []
        elif kind == 2 and len(lines) > 1:
            lines[place:place] = [generator.choice(lines)]
        else:
            lines[place:place] = [generator.choice(LINES)]
    return "\n".join(lines).encode()


def _bytes(generator: random.Random, base: str) -> bytes:
    data = bytearray(base.encode())
    for _ in range(generator.choice([1, 3, 10])):
        place = generator.randrange(len(data) + 1)
        data[place : place + generator.choice([0, 1, 5])] = generator.randbytes(generator.choice([0, 1, 4]))
    return bytes(data)


def _whole(generator: random.Random, base: str) -> bytes:
    whole = [
        b"",
        b"\x00",
        b"\xff\xfe" + base.encode("utf-16-le"),
        b"[" * 100_000,
        b"a = " + b"[" * 100_000,
        b"a." * 50_000 + b"a = 1",
        b"\xef\xbb\xbf" + base.encode(),
        base.encode() * 2,
        b"a = {" * 5000,
        generator.randbytes(500),
        b"#" * 3_000_000,
        base.replace("\n", "\r\n").encode(),
        b'format = "feeddrive-map/1"',
    ]
    return generator.choice(whole)


KINDS: list[tuple[str, Callable[[random.Random, str], bytes]]] = [
    ("good", _good), ("values", _values), ("values", _values), ("values", _values), ("units", _units),
    ("units", _units), ("variables", _variables), ("keys", _keys), ("keys", _keys), ("bytes", _bytes),
    ("bytes", _bytes), ("whole", _whole),
]  # fmt: skip
