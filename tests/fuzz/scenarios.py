"""Scenario and controller files with anything in them: read and checked whole, and run for a moment."""

from __future__ import annotations

import copy
import random
import tomllib
from pathlib import Path
from typing import Any

from feeddrive.files import scenarios_folder, shipped_scenarios
from tests.fuzz.commands import command
from tests.fuzz.harness import Attempt
from tests.fuzz.plants import FILES as PLANTS
from tests.fuzz.toml_text import all_keys, changed, grown, spoiled, written

LONGEST = 60.0
"""Wall-clock time that a case may take [s]: a warm-up takes some, and a shared computer makes five times of it."""

CONTROLLER = "controllers/bench_axis.toml"
CONTROLLERS = [tomllib.loads((scenarios_folder() / CONTROLLER).read_text(encoding="utf-8"))]
FILES = [
    entries
    for path in shipped_scenarios()
    if (entries := tomllib.loads(path.read_text(encoding="utf-8")))["format"] == "feeddrive-scenario/1"
]
KEYS = all_keys([*FILES, *CONTROLLERS])


def attempt(generator: random.Random, folder: Path) -> Attempt:
    """Write a scenario, its controller and perhaps its plant, one of them broken."""
    entries = copy.deepcopy(generator.choice(FILES))
    entries["run"] = {"duration": "0.1 s"} if generator.random() < 0.4 else {}
    controller = copy.deepcopy(CONTROLLERS[0])
    kind = generator.random()
    what = ""
    if kind < 0.1:
        entries, what = {"format": "feeddrive-scenario/1", **grown(generator, KEYS)}, "grown"
    elif kind < 0.65:
        what, entries = changed(generator, entries, [*FILES, *CONTROLLERS])
    elif kind < 0.9:
        what, controller = changed(generator, controller, [*FILES, *CONTROLLERS])
        what = f"controller: {what}"
    text = written(entries)
    if not what:
        text, what = spoiled(generator, text), "spoiled"
    (folder / "controllers").mkdir()
    _write(folder / "controllers" / "bench_axis.toml", written(controller))
    _write(folder / "scenario.toml", text)
    arguments = ["run", str(folder / "scenario.toml"), *(["--json"] if generator.random() < 0.3 else [])]
    if generator.random() < 0.1:
        arguments += ["--out", str(folder / "out")]
    if kind >= 0.65 and generator.random() < 0.3:
        arguments = ["bode", _plant(entries), "--scenario", str(folder / "scenario.toml")]
    return Attempt(f"{arguments[0]}: {entries.get('name', '')!s:.40}: {what}", lambda: command(arguments))


def _plant(entries: dict[str, Any]) -> str:
    named = entries.get("plant")
    return named if isinstance(named, str) else "bench_axis"


def _write(path: Path, text: str) -> None:
    path.write_bytes(text.encode("utf-8", "replace"))


assert PLANTS  # the scenarios name them
