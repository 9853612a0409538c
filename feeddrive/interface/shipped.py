"""What comes with feeddrive: machines, scenarios and effects by name."""

from __future__ import annotations

from typing import Any

from feeddrive.effects.base import Effect
from feeddrive.effects.catalogue import EFFECTS, THERMAL_EFFECTS
from feeddrive.errors import InputError
from feeddrive.files import shipped_plants, shipped_scenarios
from feeddrive.interface.axis import load
from feeddrive.interface.shown import Listing, Shown
from feeddrive.plant.file.effect_sections import read_effects
from feeddrive.plant.file.plant_schema import plant_table
from feeddrive.report.words.words import effect_words
from feeddrive.schema.toml_text import nearest, parse_toml


def list_plants() -> tuple[str, ...]:
    """Names of the shipped machines, as `load` takes them.

    >>> import feeddrive as fd
    >>> "bench_axis" in fd.list_plants()
    True
    """
    return tuple(path.stem for path in shipped_plants())


def list_scenarios() -> tuple[str, ...]:
    """Names of the shipped scenarios, as `run` and `sweep` take them.

    >>> import feeddrive as fd
    >>> "step_position" in fd.list_scenarios()
    True
    """
    return tuple(path.stem for path in shipped_scenarios())


class Catalogue(Shown):
    """Every effect that a plant file may hold and a diagnosis may find: name, kind, ports, keys with their units."""

    def __iter__(self) -> Any:
        """The names."""
        return iter((*EFFECTS, *THERMAL_EFFECTS))

    def __len__(self) -> int:
        return len(EFFECTS) + len(THERMAL_EFFECTS)

    def listing(self) -> Listing:
        """The table."""
        records = [
            {
                "name": effect.name,
                "kind": str(effect.kind),
                "ports": ", ".join(map(str, effect.ports)),
                "keys": ", ".join(
                    [effect.place_key] * bool(effect.place_key)
                    + [f"{one.key} [{one.unit}]" for one in effect.parameters]
                ),
            }
            for effect in (*EFFECTS.values(), *THERMAL_EFFECTS.values())
        ]
        rows = [[str(cell) for cell in record.values()] for record in records]
        return Listing("Effects", ("name", "kind", "port", "keys [SI unit]"), rows, records)


def list_effects() -> Catalogue:
    """The catalogue of effects.

    >>> import feeddrive as fd
    >>> "backlash" in fd.list_effects()
    True
    """
    return Catalogue()


class Shipped(Shown):
    """Machines, scenarios and effects that come with feeddrive, each in a line."""

    def listing(self) -> Listing:
        """The machines."""
        return self.tables()[0]

    def tables(self) -> tuple[Listing, ...]:
        """Machines, scenarios, effects."""
        found = self.record()
        plants = [list(one.values()) for one in found["plants"]]
        effects = []
        for one in found["effects"]:
            keys = ", ".join([one["place"]] * bool(one["place"]) + [f"{k} [{unit}]" for k, unit in one["keys"].items()])
            effects.append([one["name"], effect_words(one["name"]), ", ".join(one["ports"]), keys])
        scenarios = [[name, str(entries.get("description", ""))] for name, entries in _scenarios().items()]
        tables = (
            Listing("Plants", ("name", "machine", "structure"), plants, found["plants"]),
            Listing("Scenarios", ("name", "what happens"), scenarios),
            Listing("Effects", ("name", "what it is", "port", "keys"), effects, found["effects"]),
        )
        return tuple(one for one in tables if one.rows)

    def record(self) -> dict[str, Any]:
        """Everything as plain values."""
        axes = {path.stem: load(path) for path in shipped_plants()}
        return {
            "plants": [
                {
                    "name": name,
                    "machine": one.name,
                    "structure": one.plant.chain.structure if one.has_motion else "heat alone",
                }
                for name, one in axes.items()
            ],
            "scenarios": list(_scenarios()),
            "effects": [
                {
                    "name": one.name,
                    "kind": str(one.kind),
                    "ports": [str(port) for port in one.ports],
                    "place": one.place_key,
                    "keys": {parameter.key: parameter.unit for parameter in one.parameters},
                }
                for one in (*EFFECTS.values(), *THERMAL_EFFECTS.values())
            ],
        }


def _scenarios() -> dict[str, dict[str, Any]]:
    return {path.stem: parse_toml(path.read_text(encoding="utf-8"), str(path)) for path in shipped_scenarios()}


def shipped() -> Shipped:
    """Machines, scenarios and effects that come with feeddrive."""
    return Shipped()


def effect(name: str, **values: object) -> Effect:
    """One effect of the catalogue, for `Axis.with_effects`.

    Args:
        name: of the catalogue, see `list_effects`.
        **values: its keys, as in a plant file: strings with units, or numbers in SI; `port` where there is a choice.

    Raises:
        InputError: unknown name or key, a value that is missing, of another dimension or out of its range.

    >>> import feeddrive as fd
    >>> fd.effect("backlash", width="7.5 um").values["width"]
    7.5e-06
    """
    known: dict[str, type[Effect]] = {**EFFECTS, **THERMAL_EFFECTS}
    if name not in known:
        raise InputError(f'no effect "{name}"', "effect", nearest(name, known))
    units = {one.key: one.unit for one in known[name].parameters}
    entry = {key: _written(value, units.get(key, "1")) for key, value in values.items()}
    catalogue: dict[str, type[Effect]] = dict(THERMAL_EFFECTS) if name in THERMAL_EFFECTS else EFFECTS
    top = plant_table({"effect": [{"name": name, **entry}]}, f"effect({name!r})")
    return read_effects(top, catalogue)[0]


def _written(value: object, unit: str) -> object:
    """A value as a plant file would hold it; a number is in SI already."""
    if isinstance(value, list | tuple):
        return [_written(one, unit) for one in value]
    if isinstance(value, int | float) and not isinstance(value, bool) and unit != "1":
        return f"{float(value)!r} {unit}"
    return value
