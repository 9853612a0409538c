"""`feeddrive list`: the machines, scenarios and effects that come with feeddrive."""

from __future__ import annotations

from typing import Any

from feeddrive.cli.output import JsonOption, OutOption, deliver, table
from feeddrive.effects.catalogue import EFFECTS, THERMAL_EFFECTS
from feeddrive.files import shipped_plants, shipped_scenarios
from feeddrive.interface.axis import load


def command(as_json: JsonOption = False, out: OutOption = None) -> None:
    """List the machines, scenarios and effects that come with feeddrive."""
    plants, effects, scenarios = _plants(), _effects(), [path.stem for path in shipped_scenarios()]
    tables = [
        table("Plants", ("name", "machine", "structure"), [list(plant.values()) for plant in plants]),
        table("Scenarios", ("name",), [[name] for name in scenarios]),
        table("Effects", ("name", "kind", "port", "keys"), [_effect_row(effect) for effect in effects]),
    ]
    content = {"plants": plants, "scenarios": scenarios, "effects": effects}
    deliver(content, [shown for shown in tables if shown.row_count], as_json, out)


def _plants() -> list[dict[str, str]]:
    plants = [(path.stem, load(path)) for path in shipped_plants()]
    return [
        {
            "name": name,
            "machine": axis.name,
            "structure": axis.plant.chain.structure if axis.has_motion else "heat alone",
        }
        for name, axis in plants
    ]


def _effects() -> list[dict[str, Any]]:
    return [
        {
            "name": effect.name,
            "kind": str(effect.kind),
            "ports": [str(port) for port in effect.ports],
            "place": effect.place_key,
            "keys": {parameter.key: parameter.unit for parameter in effect.parameters},
        }
        for effect in (*EFFECTS.values(), *THERMAL_EFFECTS.values())
    ]


def _effect_row(effect: dict[str, Any]) -> list[str]:
    keys = ", ".join([*filter(None, [effect["place"]]), *(f"{key} [{unit}]" for key, unit in effect["keys"].items())])
    return [effect["name"], effect["kind"], ", ".join(effect["ports"]), keys]
