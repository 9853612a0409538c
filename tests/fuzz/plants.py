"""Plant files with anything in them, given to every command that is quick, with options of any kind."""

from __future__ import annotations

import random
import tomllib
from pathlib import Path

from feeddrive.files import scenarios_folder, shipped_plants
from tests.fuzz.commands import command
from tests.fuzz.harness import Attempt
from tests.fuzz.toml_text import all_keys, changed, grown, quantity, spoiled, written

LONGEST = 60.0
"""Wall-clock time that a case may take [s]: a warm-up takes some, and a shared computer makes five times of it."""

TEXTS = [path.read_text(encoding="utf-8") for path in shipped_plants()]
FILES = [tomllib.loads(text) for text in TEXTS]
KEYS = all_keys(FILES)


def attempt(generator: random.Random, folder: Path) -> Attempt:
    """Write a plant file and choose a command."""
    what, text = plant_text(generator)
    path = folder / "machine.toml"
    path.write_bytes(text.encode("utf-8", "replace"))
    arguments = [*generator.choice(COMMANDS), *options(generator)]
    arguments.insert(1, _scenario(folder) if arguments[0] == "run" else str(path))
    if generator.random() < 0.1:
        arguments += ["--out", str(folder / "out")]
    if arguments[0] == "export":
        arguments += ["--out", str(folder / "out")] if "--out" not in arguments else []
    return Attempt(f"{' '.join(arguments[:1] + arguments[2:])[:200]}: {what}", lambda: command(arguments))


def _scenario(folder: Path) -> str:
    """A short run of the machine in the folder."""
    entries = tomllib.loads((scenarios_folder() / "step_position.toml").read_text(encoding="utf-8"))
    controller = tomllib.loads((scenarios_folder() / entries["controller"]).read_text(encoding="utf-8"))
    del controller["format"], controller["name"]
    entries |= {
        "plant": "machine.toml",
        "controller": controller,
        "run": {"duration": "0.03 s"},
    }
    entries |= {"travel": ["-1 m", "2 m"]}
    path = folder / "scenario.toml"
    path.write_text(written(entries), encoding="utf-8")
    return str(path)


def plant_text(generator: random.Random) -> tuple[str, str]:
    """How a plant file is broken, and its text."""
    kind = generator.random()
    if kind < 0.08:
        entries = {"format": "feeddrive-plant/1", "structure": "three_inertias", **grown(generator, KEYS)}
        return "grown", written(entries)
    if kind < 0.18:
        return "spoiled", spoiled(generator, generator.choice(TEXTS))
    at = generator.randrange(len(FILES))
    what, entries = changed(generator, FILES[at], FILES)
    return f"{shipped_plants()[at].stem}: {what}", written(entries)


COMMANDS = [
    ["check"], ["check"], ["show"], ["show"], ["show"], ["modes"], ["modes"], ["bode"], ["bode"],
    ["run"], ["run"], ["run"], ["lump"],
    ["export", "--to", "json"], ["export", "--to", "ss"], ["export", "--to", "mat"], ["thermal", "--duration", "2 min"],
]  # fmt: skip


def options(generator: random.Random) -> list[str]:
    """Mostly none; JSON now and then."""
    return ["--json"] if generator.random() < 0.3 else []


def some_quantity(generator: random.Random, usual: str) -> str:
    """A usual value, or anything."""
    return usual if generator.random() < 0.5 else quantity(generator)
