"""Recordings with anything in them: read, checked, and prepared for a diagnosis of the bench axis."""

from __future__ import annotations

import gzip
import io
import math
import os
import random
import zlib
from collections.abc import Callable
from functools import cache
from pathlib import Path

from scipy.io import savemat

from feeddrive.diagnosis.preparation import prepared
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.recording import read_recording
from tests.fuzz.harness import Attempt

HEADINGS = ["time [s]", "motor_torque [N m]", "motor_angle [rad]", "table_position [m]"]

CELLS = [
    "", " ", "nan", "inf", "-inf", "1e999", "1e308", "-1e150", "1e-300", "5e-324", "0", "-0.0", "999", "1e6", "-58",
    "0x10", "1_0", "1,5", "1.5.2", "--1", "+", "e", "1e", "infinity", "None", "#N/A", "=1+1", "'1'", '"1"', "\t", ";",
    "12:00:01", "١٢", "１", "½", "\x1b[31m", "\u202e1", "\ufeff1", "9" * 400, "9" * 300_000, "1" + "0" * 400, "\x00",
    "1 2", "1e+0005", "true", "(1)", "1j",
]  # fmt: skip

HEADS = [
    "time [9**9**9 s]", "motor_torque [1 kg*2**2**2**2**2**2]", "motor_angle [rad^999999999]",
    "motor_angle [(((((rad)))))]", "motor_angle [" + "(" * 300 + "rad", "motor_angle [rad/0]", "time [s**-1]",
    "motor_torque [N m", "motor_torque N m]", "\x1b[2J [N m]", "\u202etorque\u2066 [N m]", "a" * 300_000 + " [m]",
    "a" * 300 + "_temperature [degC]", "x_temperature [degF]", "setpoint [m]",
    "setpoint [__import__('os').system('true')]", "cutting_force [N]", "motor_current [A]", "motor_speed [rpm]",
    "table_growth_1 [µm]", "motor_torque_share [%]", "screw_speed [rev/min]", "table_velocity [m/min]", "[m]", "",
    "time [s]", "motor_torque [nan]", "motor_torque [1e400 N m]", "motor_torque [N m # x]", "motor_torque [N\nm]",
    "motor_torque [N·m]", "motor_torque [ N m ]", "motor_torque [Nm]", "motor_torque [N m^0.5]", "motor_torque [dB]",
    "table_position [inch]",
]  # fmt: skip


def attempt(generator: random.Random, folder: Path) -> Attempt:
    """Write a recording that is broken in one or several ways."""
    kind, make = generator.choice(KINDS)
    path = make(generator, folder)
    decimal = generator.choice([None, None, None, ".", ","])
    return Attempt(f"{kind}, decimal={decimal}", lambda: _diagnosed_as_far_as_cheap(path, decimal))


def rows(generator: random.Random, count: int) -> list[list[str]]:
    """Return `count` rows of numbers of a bench axis that goes to and fro for four seconds."""
    step, radius, inertia = 4.0 / max(count, 1), 0.02 / (2 * math.pi), 6.4e-3
    turning = generator.uniform(2.0, 9.0)
    made = []
    for i in range(count):
        time = i * step
        angle = 30.0 * math.sin(turning * time)
        speed, acceleration = 30.0 * turning * math.cos(turning * time), -turning * turning * angle
        torque = inertia * acceleration + 0.5 * math.tanh(speed) + generator.gauss(0.0, 0.04)
        position = radius * angle + generator.gauss(0.0, 2e-8)
        made.append([f"{time:.6f}", f"{torque:.4f}", f"{angle:.7f}", f"{position:.9f}"])
    return made


def text(headings: list[str], table: list[list[str]], separator: str = ",", end: str = "\n") -> str:
    """Return the text of a table."""
    return end.join((separator.join(headings), *(separator.join(row) for row in table), ""))


def _written(folder: Path, data: bytes, name: str = "a.csv") -> Path:
    path = folder / name
    path.write_bytes(data)
    return path


def _cells(generator: random.Random, folder: Path) -> Path:
    table = rows(generator, 1000)
    for _ in range(generator.choice([1, 1, 1, 2, 5, 50])):
        row = generator.choice(table)
        row[generator.randrange(len(row))] = generator.choice(CELLS)
    return _written(folder, text(HEADINGS, table).encode("utf-8", "surrogatepass"))


def _numbers(generator: random.Random, folder: Path) -> Path:
    """One column, or a stretch of it, of numbers of any size."""
    table = rows(generator, generator.choice([120, 1000]))
    column = generator.randrange(4)
    size = 10.0 ** generator.choice([-320, -300, -150, -30, -12, -6, 6, 12, 30, 150, 300, 308])
    first = generator.choice([0, generator.randrange(len(table))])
    last = generator.choice([len(table), min(len(table), first + generator.randrange(1, 50))])
    for row in table[first:last]:
        row[column] = repr(float(row[column]) * size)
    return _written(folder, text(HEADINGS, table).encode())


def _headings(generator: random.Random, folder: Path) -> Path:
    headings = list(HEADINGS)
    for _ in range(generator.choice([1, 1, 2])):
        headings[generator.randrange(4)] = generator.choice(HEADS)
    return _written(folder, text(headings, rows(generator, 1000)).encode("utf-8", "surrogatepass"))


def _shape(generator: random.Random, folder: Path) -> Path:
    """Rows lost, doubled, cut, joined; blank rows; separators and line ends of every kind."""
    table = rows(generator, generator.choice([0, 1, 2, 99, 100, 101, 1000]))
    for _ in range(generator.choice([0, 1, 3])):
        if table:
            place = generator.randrange(len(table))
            change = generator.randrange(6)
            if change == 0:
                table[place : place + generator.randrange(1, 200)] = []
            elif change == 1:
                table[place:place] = [list(row) for row in table[place : place + generator.randrange(1, 40)]]
            elif change == 2:
                table[place] = table[place][: generator.randrange(5)]
            elif change == 3:
                table[place] = table[place] * generator.choice([2, 3])
            elif change == 4:
                table[place] = []
            else:
                generator.shuffle(table)
    separator, end = generator.choice([",", ";", "\t", " ", "|", ", "]), generator.choice(["\n", "\r\n", "\r", "\n\n"])
    made = text(HEADINGS, table, separator, end)
    if generator.random() < 0.3:
        made = made.replace(".", ",")
    return _written(folder, (generator.choice(["", "", "# c\n", "\n\n", "\x1a"]) + made).encode())


def _wide(generator: random.Random, folder: Path) -> Path:
    count = generator.choice([1000, 20_000, 1_000_000])
    line = ",".join(["1"] * count)
    head = generator.choice([",".join(HEADINGS), ",".join(f"c{i}" for i in range(count)), "time [s]" + "," * count])
    return _written(folder, "\n".join([head, *[line] * generator.choice([1, 2])]).encode())


def _bytes(generator: random.Random, folder: Path) -> Path:
    """Bytes changed at random in a good file, or nothing but random bytes."""
    data = bytearray(text(HEADINGS, rows(generator, 300)).encode())
    if generator.random() < 0.2:
        data = bytearray(generator.randbytes(generator.choice([1, 100, 5000])))
    for _ in range(generator.choice([1, 3, 30])):
        place = generator.randrange(len(data))
        data[place : place + generator.choice([0, 1, 1, 50])] = generator.randbytes(generator.choice([0, 1, 1, 2, 20]))
        if not data:
            break
    return _written(folder, bytes(data), generator.choice(["a.csv", "a.csv.gz", "a.mat", "a.txt"]))


def _encoding(generator: random.Random, folder: Path) -> Path:
    made = text([*HEADINGS[:3], "table_position [µm]"], rows(generator, 200))
    name = generator.choice(["utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32", "latin-1", "cp1252", "utf-7"])
    return _written(folder, made.encode(name)[generator.choice([0, 0, 1]) :])


def _gzip(generator: random.Random, folder: Path) -> Path:
    """Compressed files that are cut, damaged, doubled, or blow up."""
    data = gzip.compress(text(HEADINGS, rows(generator, 300)).encode())
    kind = generator.randrange(6)
    if kind == 0:
        data = data[: generator.randrange(len(data))]
    elif kind == 1:
        place = generator.randrange(len(data))
        data = data[:place] + generator.randbytes(3) + data[place + 3 :]
    elif kind == 2:
        data = data + gzip.compress(text(HEADINGS, rows(generator, 300)).encode())
    elif kind == 3:
        data = data + generator.randbytes(30)
    elif kind == 4:
        data = gzip.compress(data)
    else:
        data = _bomb(generator.choice([b"\x00", b"1,", b"1", b"\n", b"1,1,1,1\n"]))
    return _written(folder, data, generator.choice(["a.csv.gz", "a.csv", "a.mat"]))


@cache
def _bomb(letter: bytes) -> bytes:
    """Return a .gz of a megabyte that holds a gigabyte."""
    packer = zlib.compressobj(9, zlib.DEFLATED, 31)
    block = letter * (16_000_000 // len(letter))
    return b"".join([packer.compress(block) for _ in range(63)]) + packer.flush()


def _place(generator: random.Random, folder: Path) -> Path:
    """What is no file: a folder, a device, a pipe, a loop of links, nothing."""
    kind = generator.randrange(7)
    if kind == 0:
        return folder
    if kind == 1:
        return Path(generator.choice(["/dev/zero", "/dev/null", "/dev/urandom", "/dev/stdin", "/proc/self/mem"]))
    if kind == 2:
        os.mkfifo(folder / "a.csv")
    elif kind == 3:
        (folder / "a.csv").symlink_to(folder / "a.csv")
    elif kind == 4:
        return folder / ("a" * generator.choice([250, 300, 5000]) + ".csv")
    elif kind == 5:
        return folder / "a\x00.csv"
    return folder / generator.choice(["a.csv", "a.mat", "\x1b[31m.csv", "\udcff.csv"])


def _mat(generator: random.Random, folder: Path) -> Path:
    held = io.BytesIO()
    savemat(held, {"t": list(range(200)), "s": {"x": [1.0, 2.0]}, "n": "text"}, do_compression=generator.random() < 0.5)
    data = bytearray(held.getvalue())
    for _ in range(generator.choice([0, 1, 3, 20])):
        data[generator.randrange(len(data))] = generator.randrange(256)
    return _written(folder, bytes(data[: generator.choice([len(data), generator.randrange(len(data))])]), "a.mat")


def _good(generator: random.Random, folder: Path) -> Path:
    data = text(HEADINGS, rows(generator, 1000)).encode()
    if generator.random() < 0.5:
        return _written(folder, data)
    return _written(folder, gzip.compress(data), "a.csv.gz")


KINDS: list[tuple[str, Callable[[random.Random, Path], Path]]] = [
    ("cells", _cells), ("cells", _cells), ("numbers", _numbers), ("headings", _headings), ("shape", _shape),
    ("wide", _wide), ("bytes", _bytes), ("bytes", _bytes), ("encoding", _encoding), ("gzip", _gzip), ("place", _place),
    ("mat", _mat), ("good", _good),
]  # fmt: skip


@cache
def _plant() -> Plant:
    return read_plant(plants_folder() / "bench_axis.toml")


def _diagnosed_as_far_as_cheap(path: Path, decimal: str | None) -> None:
    prepared(_plant(), [read_recording(path, decimal=decimal)], [], 0.75)
