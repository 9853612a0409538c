"""Options with anything in them: --set, --vary, and the quantities of every command."""

from __future__ import annotations

import random
import tomllib
from collections.abc import Callable
from pathlib import Path

from feeddrive.files import find_plant, scenarios_folder
from feeddrive.plant.analysis.ode import INPUTS, OUTPUTS
from tests.fuzz.commands import command
from tests.fuzz.harness import Attempt
from tests.fuzz.scenarios import KEYS
from tests.fuzz.toml_text import TEXTS, _value, anything, quantity

LONGEST = 60.0
"""Wall-clock time that a case may take [s]: a warm-up takes some, and a shared computer makes five times of it."""

SCENARIO = tomllib.loads((scenarios_folder() / "step_position.toml").read_text(encoding="utf-8"))
CONTROLLER = tomllib.loads((scenarios_folder() / "controllers/bench_axis.toml").read_text(encoding="utf-8"))
PLANT = tomllib.loads(find_plant("bench_axis").read_text(encoding="utf-8"))
SHORT = ["--set", "run.duration=0.12 s"]


def attempt(generator: random.Random, folder: Path) -> Attempt:
    """Choose a command and its options."""
    arguments = generator.choice(MAKERS)(generator)
    if arguments[0] in ("run", "sweep", "bode", "modes", "show") and generator.random() < 0.05:
        arguments += ["--out", generator.choice([str(folder / "out"), str(folder / "a" / "b"), "/dev/null", "/proc/x"])]
    return Attempt(" ".join(arguments)[:300], lambda: command(arguments))


def _key(generator: random.Random) -> str:
    """A dotted key, mostly one that is there."""
    entries = generator.choice([("", SCENARIO), ("controller.", CONTROLLER), ("plant.", PLANT)])
    prefix, at = entries
    path = []
    while isinstance(at, dict | list) and at:
        step = generator.choice(list(at)) if isinstance(at, dict) else str(generator.randint(0, len(at) + 1))
        path.append(step)
        inside = at.get(step) if isinstance(at, dict) else at[min(max(int(step) - 1, 0), len(at) - 1)]
        if generator.random() < 0.15:
            break
        at = inside
    if generator.random() < 0.2:
        path.insert(generator.randint(0, len(path)), generator.choice([*KEYS, *TEXTS]))
    return prefix + ".".join(path) if generator.random() < 0.95 else ".".join(["a"] * 2000)


def _text(generator: random.Random) -> str:
    """The text of a value."""
    kind = generator.random()
    if kind < 0.4:
        return quantity(generator)
    if kind < 0.7:
        return _value(anything(generator))
    if kind < 0.75:
        return "[" * 3000
    return generator.choice(TEXTS)


def _set(generator: random.Random) -> list[str]:
    settings = [f"{_key(generator)}={_text(generator)}" for _ in range(generator.choice([1, 1, 2, 3]))]
    if generator.random() < 0.1:
        settings.append(_text(generator))
    return [
        "run",
        "step_position",
        *generator.choice([SHORT, []]),
        *(word for one in settings for word in ("--set", one)),
    ]


def _vary(generator: random.Random) -> list[str]:
    shape = generator.choice(
        ["{0}:{1}:2", "{0}:{1}:{2}", "{0},{1}", "{0}~{1}", "{0}", "{0}:{1}", "~", ":::", ",,,", "{0}~"]
    )
    values = [generator.choice([quantity(generator), "3", "40", "80 1/s", "2"]) for _ in range(3)]
    key = generator.choice(["controller.position_gain", "plant.table.mass", _key(generator)])
    given = f"{key}={shape.format(*values)}"
    more = generator.choice([[], ["--samples", generator.choice(["1", "2", "0", "-1", "1e3",
    "x"])], ["--metric", _text(generator)],
                             ["--seed", generator.choice(["0", "-1", "99999999999999999999", "x"])]])  # fmt: skip
    return ["sweep", "step_position", *SHORT, "--workers", "1", "--vary", given, *more]


def _several(generator: random.Random) -> str:
    return ",".join(_some(generator, "100 mm") for _ in range(generator.randint(1, 3)))


def _some(generator: random.Random, usual: str) -> str:
    return generator.choice([usual, usual, quantity(generator), generator.choice(TEXTS)])


def _bode(generator: random.Random) -> list[str]:
    given = {
        "--at": generator.choice([f"x={_some(generator, '200 mm')},v={_some(generator, '3 m/min')}",
        _several(generator)]),
        "--positions": _several(generator), "--payload": _some(generator, "10 kg"),
        "--range": f"{_some(generator, '1 Hz')},{_some(generator, '2 kHz')}",
        "--from": generator.choice([*INPUTS, *TEXTS]), "--to": generator.choice([*OUTPUTS, *TEXTS]),
        "--loop": generator.choice(["open", "closed", *TEXTS]),
        "--scenario": generator.choice(["step_position", *TEXTS]),
    }  # fmt: skip
    chosen = generator.sample(list(given), generator.randint(1, 4))
    return ["bode", _machine(generator), *(word for name in chosen for word in (name, given[name]))]


def _thermal(generator: random.Random) -> list[str]:
    given = {
        "--speed": _some(generator, "750 rev/min"), "--duration": _some(generator, "5 min"),
        "--within": _some(generator, "1 µm"),
        "--stroke": generator.choice([f"{_some(generator, '150 mm')} to {_some(generator, '300 mm')}",
        _some(generator, "100 mm")]),
        "--order": generator.choice(["2", "36", "200", "0", "x", "1e9"]), "--segments": generator.choice(["3",
        "100", "0", "x"]),
    }  # fmt: skip
    chosen = generator.sample(list(given), generator.randint(1, 3))
    return ["thermal", "warm_axis", *(word for name in chosen for word in (name, given[name]))]


def _modes(generator: random.Random) -> list[str]:
    return [
        "modes",
        _machine(generator),
        *(word for _ in range(generator.randint(1, 3)) for word in ("--at", _some(generator, "100 mm"))),
    ]


def _show(generator: random.Random) -> list[str]:
    return [generator.choice(["show", "check"]), _machine(generator), "--at", _some(generator, "100 mm")]


def _tune(generator: random.Random) -> list[str]:
    """A demand that is refused on reading, or the whole search, which is slow and therefore rare."""
    given = {
        "--margin-phase": _some(generator, "45deg"), "--margin-gain": _some(generator, "8dB"),
        "--positions": _several(generator),
        "--payload": _some(generator, "10 kg"), "--velocity": _some(generator, "3 m/min"),
        "--velocity-rate": _some(generator, "8 kHz"),
        "--position-rate": _some(generator, "2 kHz"), "--current-bandwidth": _some(generator, "1 kHz"),
        "--dead-time": _some(generator, "125 us"), "--feedback": generator.choice(["motor", "table", *TEXTS]),
    }  # fmt: skip
    chosen = generator.sample(list(given), generator.randint(1, 2))
    return ["tune", "bench_axis", *(word for name in chosen for word in (name, given[name]))]


def _machine(generator: random.Random) -> str:
    return generator.choice(["bench_axis", "light_axis", "kimm_testbed", "vertical_axis", *generator.sample(TEXTS, 1)])


def _words(generator: random.Random) -> list[str]:
    """Commands, options and texts in any order."""
    words = [
        "show",
        "run",
        "bode",
        "--out",
        "--json",
        "--set",
        "--at",
        "--help",
        "-x",
        "--",
        "--nonsense",
        "bench_axis",
        *TEXTS,
    ]
    commands = ["show", "run", "bode", "sweep", "export", "list", "modes", "check", "diagnose", "tune", *TEXTS]
    return [generator.choice(commands), *generator.sample(words, generator.randint(0, 3))]


MAKERS: list[Callable[[random.Random], list[str]]] = [
    _set, _set, _set, _set, _set, _vary, _vary, _bode, _bode, _bode, _modes, _show, _thermal, _words,
] * 3 + [_tune]  # fmt: skip
