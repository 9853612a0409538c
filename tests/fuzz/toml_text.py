"""TOML files with anything in them: shipped ones changed in one or several places, and random ones made by grammar."""

from __future__ import annotations

import copy
import datetime
import json
import math
import random
import re
import string
from collections.abc import Callable, Iterator
from typing import Any

NUMBERS = [
    "0", "-0", "1", "-1", "-5", "0.5", "1e3", "1e6", "1e9", "1e12", "1e20", "1e38", "1e150", "1e155", "1e300", "1e308",
    "1.8e308", "1e999", "-1e150", "-1e308", "1e-3", "1e-9", "1e-12", "1e-20", "1e-150", "1e-300", "5e-324", "1e-400",
    "nan", "inf", "-inf", "NaN", "9" * 400, "0." + "0" * 400 + "1", "1_000", "1,5", "0x10", "١٢", "½", "1 2",
    "1..2", "",
    "--1", "+1", "2.5", "360", "3000", "1e5", "100",
]  # fmt: skip

UNITS = [
    "", "m", "mm", "µm", "nm", "km", "inch", "kg", "g", "t", "kg m^2", "kg cm^2", "N", "kN", "N m", "N/m", "N/µm",
    "N m/rad",
    "N s/m", "N m s/rad", "N m/A", "A", "s", "ms", "us", "min", "h", "Hz", "kHz", "rad/s", "rev/min", "rpm", "rad",
    "deg",
    "1/s", "(m/min)/mm", "m/s", "m/min", "m/s^2", "m/s^3", "%", "1", "dB", "degC", "K", "1/K", "W", "W/K", "W/(m K)",
    "W/(m^2 K)", "J/(m^3 K)", "N/mm²", "Pa", "GPa", "parsec", "__class__", "m^999999999", "m**9**9**9", "1/0 m",
    "(((((m",
    "m" * 5000, "\x1b[31mm", "\u202em", "mm mm", "mm/mm", "kg*kg", "°", "degF", "bit", "N·m", "e", "pi",
]  # fmt: skip

TEXTS = [
    "", " ", "x", "three_inertias", "rigid", "two_inertias", "distributed_screw", "motor", "table", "screw", "nut",
    "\x00", "\x1b[31mred\x1b[0m", "\x1b]0;title\x07", "\u202egnp.exe", "\u2066x\u2069", "a\u200bb", "\ud7ff\ue000",
    "ß" * 200,
    "x" * 300_000, "../../../etc/passwd", "/", ".", "..", "~", "con", "a/b", "'", '"', '"; system("x"); "', "*/",
    "//", "<x>&",
    "</title><script>", "]]>", "%s%n", "{0}", "{x!r}", "\n", "\r\n", "a\nb", "\t", "nan", "None", "true", "\u2028",
    "\ufeff",
    "bench_axis", "bench_axis.toml", "none", "no such file.csv", "é", "e\u0301", "日本", "🙂",
]  # fmt: skip

WORDS = re.compile(r"^[a-z_0-9]+$")


def quantity(generator: random.Random) -> str:
    """A number and a unit that have nothing to do with each other."""
    return f"{generator.choice(NUMBERS)} {generator.choice(UNITS)}".strip()


def anything(generator: random.Random, depth: int = 0) -> Any:
    """A value of any type that TOML has."""
    makers: list[Callable[[], Any]] = [
        lambda: quantity(generator), lambda: quantity(generator), lambda: generator.choice(TEXTS),
        lambda: generator.choice([True, False]), lambda: generator.choice([0, 1, -1, 3, 10**6, 10**9, 10**18, 2**63]),
        lambda: generator.choice([0.0, 1.5, -2.0, 1e150, 1e308, 5e-324, math.nan, math.inf, -math.inf]),
        lambda: datetime.datetime(1979, 5, 27, 7, 32), lambda: datetime.time(7, 32), lambda: [], lambda: {},
    ]  # fmt: skip
    if depth < 4:
        inner = depth + 1
        makers += [
            lambda: [anything(generator, inner) for _ in range(generator.randint(1, 4))],
            lambda: {key(generator): anything(generator, inner) for _ in range(generator.randint(1, 4))},
            lambda: {
                "value": quantity(generator),
                generator.choice(["source", "tolerance", "x"]): anything(generator, 4),
            },
            lambda: [quantity(generator)] * generator.choice([1, 2, 500]),
        ]
    return generator.choice(makers)()


def key(generator: random.Random) -> str:
    """A key, mostly a plain one."""
    if generator.random() < 0.2:
        return generator.choice(TEXTS)
    return "".join(generator.choices(string.ascii_lowercase + "_-0123456789", k=generator.randint(1, 12)))


def changed(
    generator: random.Random, entries: dict[str, Any], others: list[dict[str, Any]]
) -> tuple[str, dict[str, Any]]:
    """A deep copy of the entries with one to four changes, and what they were.

    Args:
        generator: of random numbers.
        entries: of a file.
        others: further files of the kind, from which sections and words are taken.
    """
    made = copy.deepcopy(entries)
    said = []
    for _ in range(generator.choice([1, 1, 1, 2, 2, 3, 4])):
        name, change = generator.choice(CHANGES)
        places = list(_places(made))
        if not places:
            break
        holder, at = generator.choice(places)
        said.append(f"{name} {at}")
        change(generator, holder, at, others)
    return "; ".join(said)[:200], made


def _places(inside: Any) -> Iterator[tuple[Any, Any]]:
    """Every table or list with every key or index in it."""
    pairs = inside.items() if isinstance(inside, dict) else enumerate(inside) if isinstance(inside, list) else ()
    for at, value in list(pairs):
        yield inside, at
        yield from _places(value)


def _drop(_: random.Random, holder: Any, at: Any, __: Any) -> None:
    del holder[at]


def _rename(generator: random.Random, holder: Any, at: Any, _: Any) -> None:
    value = holder[at]
    if isinstance(holder, list):
        holder.insert(at, copy.deepcopy(value))
        return
    del holder[at]
    near = at[:-1] if len(at) > 1 else at + "x"
    holder[generator.choice([near, at.upper(), at + "_", key(generator)])] = value


def _retype(generator: random.Random, holder: Any, at: Any, _: Any) -> None:
    holder[at] = anything(generator)


def _number(generator: random.Random, holder: Any, at: Any, _: Any) -> None:
    """Another number with the unit as it was."""
    value = holder[at]
    if isinstance(value, str) and (match := re.match(r"[-+0-9.eE]+(.*)", value)):
        holder[at] = f"{generator.choice(NUMBERS)}{match[1]}"
    elif isinstance(value, dict) and isinstance(value.get("value"), str):
        _number(generator, value, "value", None)
    elif isinstance(value, int | float) and not isinstance(value, bool):
        holder[at] = generator.choice([0, -1, 2, 10**9, 10**18, 1e150, 1e-300, math.nan, math.inf, -value, 0.5])
    else:
        holder[at] = anything(generator)


def _scaled(generator: random.Random, holder: Any, at: Any, _: Any) -> None:
    """A number some powers of ten away, as a slip of the unit makes it."""
    value = holder[at]
    if isinstance(value, str) and (match := re.match(r"([-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?)(.*)", value)):
        power = generator.choice([generator.uniform(-1, 1), generator.randint(-3, 3), generator.randint(-12, 12)])
        holder[at] = f"{float(match[1]) * 10.0**power:g}{match[2]}"
    elif isinstance(value, int | float) and not isinstance(value, bool):
        holder[at] = value * generator.choice([0.001, 0.1, 2, 10, 1000])


def _unit(generator: random.Random, holder: Any, at: Any, _: Any) -> None:
    value = holder[at]
    if isinstance(value, str) and (match := re.match(r"[-+0-9.eE]+", value)):
        holder[at] = f"{match[0]} {generator.choice(UNITS)}"


def _word(generator: random.Random, holder: Any, at: Any, others: list[dict[str, Any]]) -> None:
    """A word of another place or file in the place of one."""
    words = [h[a] for other in others for h, a in _places(other) if isinstance(h[a], str) and WORDS.match(h[a])]
    holder[at] = generator.choice(words)


def _section(generator: random.Random, holder: Any, at: Any, others: list[dict[str, Any]]) -> None:
    """What another file has under some key, here."""
    other = generator.choice(others)
    places = list(_places(other))
    from_there, where = generator.choice(places)
    value = copy.deepcopy(from_there[where])
    if isinstance(holder, dict):
        holder[where if isinstance(where, str) else at] = value
    else:
        holder.append(value)


def _deep(generator: random.Random, holder: Any, at: Any, _: Any) -> None:
    value: Any = holder[at]
    for _ in range(generator.choice([1, 2, 30, 90])):
        value = generator.choice([{"value": value}, [value], {"a": value}])
    holder[at] = value


def _many(generator: random.Random, holder: Any, at: Any, _: Any) -> None:
    holder[at] = [holder[at]] * generator.choice([0, 1, 2, 3, 50, 2000])


CHANGES: list[tuple[str, Callable[[random.Random, Any, Any, Any], None]]] = [
    ("drop", _drop), ("rename", _rename), ("retype", _retype), ("number", _number), ("number", _number),
    ("number", _number), ("word", _word), ("section", _section), ("many", _many), ("deep", _deep), ("unit", _unit),
    *[("scale", _scaled)] * 8,
]  # fmt: skip


def grown(generator: random.Random, keys: list[str]) -> dict[str, Any]:
    """Entries made by grammar, from known and unknown keys."""

    def name() -> str:
        return generator.choice(keys) if generator.random() < 0.7 else key(generator)

    return {name(): anything(generator) for _ in range(generator.randint(0, 12))}


def all_keys(files: list[dict[str, Any]]) -> list[str]:
    """Every key that some file has, at any level."""
    return sorted({at for one in files for _, at in _places(one) if isinstance(at, str)})


def spoiled(generator: random.Random, text: str) -> str:
    """A text with some letters or lines lost, doubled or put in."""
    lines = text.splitlines(keepends=True)
    for _ in range(generator.randint(1, 3)):
        if not lines:
            break
        at = generator.randrange(len(lines))
        doing = generator.choice(["drop", "double", "cut", "put", "end", "swap"])
        if doing == "drop":
            del lines[at]
        elif doing == "double":
            lines.insert(at, lines[at])
        elif doing == "cut":
            lines[at] = lines[at][: generator.randrange(len(lines[at]) + 1)]
        elif doing == "put":
            place = generator.randrange(len(lines[at]) + 1)
            put = generator.choice(
                ["=", '"', "[", "]", "{", "}", "#", ".", "\x00", "\x1b", "\u202e", "\\", "'", ",", "é", "\r"]
            )
            lines[at] = lines[at][:place] + put + lines[at][place:]
        elif doing == "end":
            del lines[at:]
        else:
            other = generator.randrange(len(lines))
            lines[at], lines[other] = lines[other], lines[at]
    return "".join(lines)


def written(entries: dict[str, Any]) -> str:
    """Entries as TOML; tables are written inline, which says the same."""
    return "".join(f"{_key(name)} = {_value(value)}\n" for name, value in entries.items())


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _quoted(name)


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(name)} = {_value(inner)}" for name, inner in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_value, value)) + "]"
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else str(value)
    return value.isoformat() if isinstance(value, datetime.date | datetime.time) else str(value)
