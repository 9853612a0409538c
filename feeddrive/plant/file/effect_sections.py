"""The effects of a plant file: its `[[effect]]` tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

from feeddrive.effects.base import Effect, Parameter, Port, TransmissionEffect, Value
from feeddrive.effects.catalogue import EFFECTS, THERMAL_EFFECTS
from feeddrive.errors import InputError
from feeddrive.plant.file.ratings import declares_heat_alone, read_stroke
from feeddrive.schema.table import Table
from feeddrive.schema.toml_text import nearest


def read_effects(top: Table, known: Mapping[str, type[Effect]] | None = None) -> tuple[Effect, ...]:
    """The effects of a file, in its order; `known` is name to class, by default of all that the machine may have.

    Raises InputError: unknown name, key or port, a value that is missing or out of its range, tables that do not fit.
    """
    catalogue = _declared(top) if known is None else known
    effects: list[Effect] = []
    for table in top.tables("effect"):
        name = table.text("name")
        label = next_label(name, effects)
        effects.append(_effect(replace(table, where=f"{table.where} ({name})"), label, catalogue, top))
    return tuple(effects)


def _declared(top: Table) -> dict[str, type[Effect]]:
    on_heat: Mapping[str, type[Effect]] = THERMAL_EFFECTS if "thermal" in top.entries else {}
    return {**({} if declares_heat_alone(top.entries) else EFFECTS), **on_heat}


def next_label(name: str, before: Sequence[Effect]) -> str:
    """The label that the plant will give to the next effect of that name."""
    count = sum(effect.name == name for effect in before)
    return name if count == 0 else f"{name}_{count + 1}"


def _effect(table: Table, label: str, catalogue: Mapping[str, type[Effect]], top: Table) -> Effect:
    name = table.entries["name"]
    if name not in catalogue:
        raise InputError(_unknown(name), table.where, nearest(name, catalogue))
    effect, table = catalogue[name], table.of_kind(name)
    keys = [parameter.key for parameter in effect.parameters]
    along = _along_stroke(effect, table, top)
    table.refuse_unknown(("name", "port", "source", *([effect.place_key] if effect.place_key else []), *keys))
    values = {
        parameter.key: _value(table, parameter, f"{label}.{parameter.key}")
        for parameter in effect.parameters
        if parameter.key in table.entries or (parameter.default is None and parameter.key not in along)
    }
    values |= {key: end for key, end in along.items() if key not in table.entries}
    port = Port(table.choice("port", effect.ports)) if "port" in table.entries else None
    place = table.text(effect.place_key, effect.default_place or None) if effect.place_key else ""
    try:
        made = effect.of(port, place, **values)
    except InputError as error:
        raise InputError(error.what, table.where, error.mend) from None
    _refuse_bad_curve(made, table.where)
    return made


def _value(table: Table, parameter: Parameter, origin: str) -> Value:
    """A value or list; next to zero it is one of nothing, as a search may find it."""
    if parameter.table:
        return table.quantities(parameter.key, parameter.unit, origin)
    return table.quantity(parameter.key, parameter.unit, origin, may_vanish=True)


def _along_stroke(effect: type[Effect], table: Table, top: Table) -> dict[str, float]:
    """Ends of the declared stroke [m] for an effect that counts along it; none for others.

    Raises:
        InputError: the effect leaves them out, and no stroke is declared.
    """
    keys = effect.stroke_keys if issubclass(effect, TransmissionEffect) else ()
    if not keys or all(key in table.entries for key in keys):
        return {}
    stroke = read_stroke(top)
    if stroke is None:
        mend = f'write {keys[0]} and {keys[1]} here, or stroke = ["0 mm", "500 mm"] in [table]'
        raise InputError("acts along the stroke, which is not declared", table.where, mend)
    return dict(zip(keys, stroke, strict=True))


def _unknown(name: str) -> str:
    if name in THERMAL_EFFECTS:
        return f"{name} acts on heat, which this plant does not declare"
    return (
        f"{name} acts on motion, which this plant does not declare" if name in EFFECTS else f"unknown effect {name!r}"
    )


def _refuse_bad_curve(effect: Effect, where: str) -> None:
    """Refuse tables of unequal length, or positions that do not ascend."""
    tables = {p.key: effect.values[p.key] for p in effect.parameters if p.table and p.key in effect.values}
    lengths = {key: len(value) if isinstance(value, tuple) else 1 for key, value in tables.items()}
    if len(set(lengths.values())) > 1:
        what = " and ".join(f"{key} has {length}" for key, length in lengths.items())
        raise InputError(f"{what} values", where, "write lists of equal length")
    for key in ("position", "time"):
        nodes = tables.get(key)
        if isinstance(nodes, tuple) and any(b <= a for a, b in pairwise(nodes)):
            raise InputError(f"{key} does not ascend", where, f"write each {key} in ascending order, none twice")
