"""The effects of a plant file: its `[[effect]]` tables."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from feeddrive.effects.base import Effect
from feeddrive.effects.catalogue import EFFECTS, find_effect
from feeddrive.errors import InputError
from feeddrive.plant.entries import Table, nearest


def read_effects(top: Table) -> tuple[Effect, ...]:
    """The effects, in the order of the file.

    Raises:
        InputError: unknown name, key or port, a value that is missing or out of its range, tables that do not fit.
    """
    effects: list[Effect] = []
    for table in top.tables("effect"):
        name = table.text("name")
        label = next_label(name, effects)
        effects.append(_effect(Table(table.entries, f"{table.where} ({name})", table.origins, table.source), label))
    return tuple(effects)


def next_label(name: str, before: Sequence[Effect]) -> str:
    """The label that the plant will give to the next effect of that name."""
    count = sum(effect.name == name for effect in before)
    return name if count == 0 else f"{name}_{count + 1}"


def _effect(table: Table, label: str) -> Effect:
    name = table.entries["name"]
    if name not in EFFECTS:
        raise InputError(f"unknown effect {name!r}", table.where, nearest(name, EFFECTS))
    effect = find_effect(name)
    keys = [parameter.key for parameter in effect.parameters]
    table.refuse_unknown(("name", "port", "source", *keys))
    values = {
        parameter.key: (table.quantities if parameter.table else table.quantity)(
            parameter.key, parameter.unit, f"{label}.{parameter.key}"
        )
        for parameter in effect.parameters
        if parameter.key in table.entries or parameter.default is None
    }
    port = table.choice("port", effect.ports, effect.ports[0])
    try:
        made = effect.of(next(known for known in effect.ports if known == port), **values)
    except InputError as error:
        raise InputError(error.what, table.where, error.mend) from None
    _refuse_bad_curve(made, table.where)
    return made


def _refuse_bad_curve(effect: Effect, where: str) -> None:
    """Refuse tables of unequal length, or positions that do not ascend."""
    tables = {p.key: effect.values[p.key] for p in effect.parameters if p.table and p.key in effect.values}
    lengths = {key: len(value) if isinstance(value, tuple) else 1 for key, value in tables.items()}
    if len(set(lengths.values())) > 1:
        told = " and ".join(f"{key} has {length}" for key, length in lengths.items())
        raise InputError(f"{told} values", where, "write lists of equal length")
    position = tables.get("position")
    if isinstance(position, tuple) and any(b <= a for a, b in pairwise(position)):
        raise InputError("position does not ascend", where, "write the positions in ascending order, none twice")
