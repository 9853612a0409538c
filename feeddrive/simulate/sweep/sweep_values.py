"""What a sweep varies: `key=a:b:n`, `key=v1,v2,v3`, or `key=a~b` for random values.

    controller.position_gain=40:80:9 1/s         unit at the end, or at both ends
    plant.table.mass=100 kg:200 kg:5
    controller.position_feedback=motor,table     words, also plant and controller files
    plant.effect.guide_friction.coulomb=50~90 N  random between 50 N and 90 N
    controller.feed_forward.torque=0.8,1,1.2     without dimension

Keys are those of `feeddrive run --set`.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.units.quantity import split_quantity

MOST_RUNS = 100_000
"""Runs of a sweep at most: tables beyond it are a slip of a count more often than meant."""

Value = float | int | str
"""Value of a parameter, in its unit; or a word."""

_COMMA = re.compile(r",(?![^\[]*\])")
"""Between values; commas within brackets belong to a list."""

_STEPS = re.compile(r"([^:]+):([^:]+):([^:]*)")
_DIGITS = 12
"""Significant digits of a value between two ends, so that 0.3 is not written 0.30000000000000004."""


@dataclass(frozen=True)
class Parameter:
    """A value that is varied.

    Attributes:
        key: dotted, as of `--set`.
        unit: in which values are written; "1" without dimension, "" for words.
        values: in that unit; for a random one its two ends.
        random: whether values are drawn between the two ends.
    """

    key: str
    unit: str
    values: tuple[Value, ...]
    random: bool = False

    def text(self, value: Value) -> str:
        """A value as it would be written after `--set key=`."""
        if isinstance(value, str):
            return value
        return f"{value!r} {self.unit}" if self.unit != "1" else repr(value)


def read_parameters(texts: list[str]) -> tuple[Parameter, ...]:
    """The parameters of `--vary` texts.

    Raises:
        InputError: no key=values, a key given twice, no or too many points, ends that are no quantities of one unit.
    """
    found: dict[str, Parameter] = {}
    for text in texts:
        parameter = _parameter(text)
        if parameter.key in found:
            raise InputError(f"{parameter.key} is varied twice", "--vary", "keep one of them")
        found[parameter.key] = parameter
    if not found:
        raise InputError("nothing is varied", "--vary", 'write e.g. --vary "controller.position_gain=40:80:9 1/s"')
    return tuple(found.values())


def _parameter(text: str) -> Parameter:
    key, sign, written = (part.strip() for part in text.partition("="))
    if not sign or not key or not written:
        what = f'"{text}" is not key=values'
        raise InputError(what, "--vary", 'write e.g. --vary "controller.position_gain=40:80:9 1/s"')
    steps = _STEPS.fullmatch(written)
    if steps is not None:
        return _stepped(key, *steps.groups())
    if re.match(r"[+-]?\.?\d.*~", written):
        low, _, high = written.partition("~")
        unit, ends = _quantities([low, high], key)
        if not ends[0] < ends[1]:
            raise InputError(f"{written} is no range", f"--vary {key}", "write the smaller end first")
        return Parameter(key, unit, ends, random=True)
    return _listed(key, written)


def _stepped(key: str, low: str, high: str, points: str) -> Parameter:
    count, _, unit_behind = points.strip().partition(" ")
    if unit_behind:
        high = f"{high} {unit_behind}"
    if not count.isdecimal() or len(count) > _DIGITS:
        what = f'"{count}" is not a number of points'
        raise InputError(what, f"--vary {key}", "write first:last:points, e.g. 40:80:9 1/s")
    number = int(count)
    if number < 2:
        raise InputError(f"{number} points", f"--vary {key}", "write at least 2, or one value by --set")
    if number > MOST_RUNS:
        raise InputError(f"{number} points", f"--vary {key}", f"at most {MOST_RUNS} runs are possible")
    unit, ends = _quantities([low, high], key)
    if ends[0] == ends[1]:
        raise InputError("first and last value are the same", f"--vary {key}", "write a range, or one value by --set")
    between = [float(f"{value:.{_DIGITS}g}") for value in np.linspace(ends[0], ends[1], number)]
    whole = all(isinstance(end, int) for end in ends) and all(value.is_integer() for value in between)
    return Parameter(key, unit, tuple(int(value) if whole else value for value in between))


def _listed(key: str, written: str) -> Parameter:
    items = [item.strip() for item in _COMMA.split(written)]
    if re.match(r"[+-]?\.?\d[^,]*:", written):
        raise InputError(f'"{written}" is no range', f"--vary {key}", "write first:last:points, e.g. 40:80:9 1/s")
    if len(items) < 2:
        raise InputError("one value is not varied", f"--vary {key}", "write two or more, or use --set")
    if any(not item for item in items):
        raise InputError(f'"{written}" has an empty value', f"--vary {key}", "write v1,v2,v3")
    if len(set(items)) < len(items):
        raise InputError(f'"{written}" has a value twice', f"--vary {key}", "keep one of them")
    try:
        unit, values = _quantities(items, key)
    except InputError:
        if all(re.match(r"[+-]?\.?\d", item) for item in items):
            raise
        return Parameter(key, "", tuple(items))
    return Parameter(key, unit, values)


def _quantities(items: list[str], key: str) -> tuple[str, tuple[float | int, ...]]:
    """Their common unit and their numbers; a unit at the last one holds for bare ones before it."""
    where = f"--vary {key}"
    pairs = [split_quantity(item.strip().strip('"'), where) for item in items]
    unit = pairs[-1][1]
    for item, (_, own) in zip(items, pairs, strict=True):
        if own not in (unit, "1"):
            raise InputError(f'"{item.strip()}" is not in {unit}', where, "write all values in one unit")
    if unit != "1":
        return unit, tuple(number for number, _ in pairs)
    # counts stay whole numbers, as keys such as `trajectory.runs` need them
    return unit, tuple(
        int(number) if re.fullmatch(r'"?[+-]?\d+"?', item.strip()) else number
        for item, (number, _) in zip(items, pairs, strict=True)
    )
