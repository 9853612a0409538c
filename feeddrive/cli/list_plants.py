"""`feeddrive list`: the machines, scenarios and effects that come with feeddrive."""

from __future__ import annotations

from typing import Any

from feeddrive.cli.output import JsonOption, OutOption, deliver, table
from feeddrive.effects.catalogue import EFFECTS, THERMAL_EFFECTS
from feeddrive.files import shipped_plants, shipped_scenarios
from feeddrive.interface.axis import load
from feeddrive.plant.file.entries import parse_toml
from feeddrive.report.words.words import effect_words


def command(as_json: JsonOption = False, out: OutOption = None) -> None:
    """List the machines, scenarios and effects that come with feeddrive."""
    plants, effects, scenarios = _plants(), _effects(), _scenarios()
    tables = [
        table("Plants", ("name", "machine", "structure"), [list(plant.values()) for plant in plants]),
        table("Scenarios", ("name", "what happens"), list(scenarios.items())),
        table("Effects", ("name", "what it is", "port", "keys"), [_effect_row(effect) for effect in effects]),
    ]
    content = {"plants": plants, "scenarios": list(scenarios), "effects": effects}
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


def _scenarios() -> dict[str, str]:
    """Name to what the file says of itself."""
    files = {path.stem: parse_toml(path.read_text(encoding="utf-8"), str(path)) for path in shipped_scenarios()}
    return {name: str(entries.get("description", "")) for name, entries in files.items()}


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
    return [effect["name"], effect_words(effect["name"]), ", ".join(effect["ports"]), keys]
