"""Reading values of a scenario: optional quantities, whole numbers, switches, lists."""

from __future__ import annotations

from feeddrive.errors import InputError, quoted
from feeddrive.plant.file.entries import Table

MOST = 1_000_000_000
"""Bound of a whole number that nothing else bounds: above any count of lines or cycles, below what overflows."""


def optional(table: Table, key: str, unit: str, default: float) -> float:
    """A quantity in SI, or the default where it is left out.

    Raises:
        InputError: not a quantity of that unit.
    """
    return table.quantity(key, unit, key) if key in table.entries else default


def positive(table: Table, key: str, unit: str) -> float:
    """A quantity in SI above zero.

    Raises:
        InputError: missing, not a quantity of that unit, or not above zero.
    """
    value = table.quantity(key, unit, key)
    if not value > 0:
        raise InputError(f"{table.entries[key]} is not above zero", table.place(key), "write a positive value")
    return value


def quantities(table: Table, key: str, unit: str) -> tuple[float, ...]:
    """One quantity or a list of them, as a tuple in SI.

    Raises:
        InputError: missing, empty, or not quantities of that unit.
    """
    value = table.quantities(key, unit, key)
    return value if isinstance(value, tuple) else (value,)


def whole(table: Table, key: str, default: int | None = None, most: int = MOST) -> int:
    """A whole number of at least 0 and at most `most`.

    Raises:
        InputError: missing without a default, or not such a number.
    """
    value = table.entries.get(key, default)
    if value is None:
        raise InputError("is missing", table.place(key), f"write {key} = 1")
    if isinstance(value, bool) or not isinstance(value, int) or value < 0:
        raise InputError(f"{quoted(value)} is not a whole number", table.place(key), f"write e.g. {key} = 5")
    if value > most:
        raise InputError(f"{quoted(value)} is more than {most}", table.place(key), f"write {most} at most")
    return value


def boolean(table: Table, key: str, default: bool) -> bool:
    """true or false.

    Raises:
        InputError: something else.
    """
    value = table.entries.get(key, default)
    if not isinstance(value, bool):
        raise InputError(f"{value!r} is neither true nor false", table.place(key), f"write {key} = true")
    return value


def texts(table: Table, key: str, default: tuple[str, ...]) -> tuple[str, ...]:
    """A list of words, none twice.

    Raises:
        InputError: not a list of words.
    """
    value = table.entries.get(key, list(default))
    if not isinstance(value, list) or not value or not all(isinstance(word, str) for word in value):
        raise InputError("is not a list of words", table.place(key), f'write {key} = ["...", "..."]')
    return tuple(dict.fromkeys(value))
