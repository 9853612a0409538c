"""Command line: python -m tests.generator --effect backlash --set width=7.5e-6 --seconds 20 --out FILE.csv.gz."""

from __future__ import annotations

import argparse
import dataclasses
import sys
from collections.abc import Sequence
from pathlib import Path

from tests.generator.axis import AXES
from tests.generator.effects import EFFECT_CLASSES, Effect, PlantedEffects
from tests.generator.pair import profiles, true_axis
from tests.generator.recording import simulate, write_csv

WORDS = ("port", "where", "channel")
"""Keys whose values are words."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Write one recording and return 0; a bad argument ends with status 2 and one line."""
    parser = _parser()
    options = parser.parse_args(arguments)
    try:
        effects = planted_effects(options.effect, options.set)
        off = {name: float(factor) for name, _, factor in (text.partition("=") for text in options.off)}
        axis = true_axis(AXES[options.axis], effects, off, options.noise_factor)
    except (TypeError, ValueError) as error:
        parser.error(str(error))
    profile = profiles(axis, PlantedEffects(), (options.seconds, options.seconds))[1 if options.validate else 0]
    if options.no_chirp:
        profile = profile.without_chirp()
    write_csv(options.out, simulate(axis, effects, profile, options.seed))
    return 0


def _parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    parser = argparse.ArgumentParser(prog="python -m tests.generator", description=__doc__)
    parser.add_argument("--axis", choices=sorted(AXES), default="bench")
    parser.add_argument("--effect", action="append", default=[], help="name of a planted effect, repeatable; or none")
    parser.add_argument("--set", action="append", default=[], help="key=value; effect.key=value with several effects")
    parser.add_argument("--off", action="append", default=[], help="name=factor on a declared number, repeatable")
    parser.add_argument("--noise-factor", type=float, default=1.0, help="noise over that of the sensors")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--validate", action="store_true", help="the profile for judging instead of that for fitting")
    parser.add_argument("--no-chirp", action="store_true", help="slow motion without the torque chirp")
    parser.add_argument("--out", type=Path, required=True, help="CSV file, .csv or .csv.gz")
    return parser


def planted_effects(names: Sequence[str], settings: Sequence[str]) -> PlantedEffects:
    """Return the effects of these names with these settings; ValueError or TypeError says what does not fit."""
    wanted = [name for name in names if name != "none"]
    values: dict[str, dict[str, float | str]] = {name: {} for name in wanted}
    for setting in settings:
        key, _, text = setting.partition("=")
        owner, _, short = key.rpartition(".")
        owner = owner or (wanted[0] if len(wanted) == 1 else "")
        if owner not in values:
            raise ValueError(f"--set {setting}: write effect.key=value with the name of a chosen effect")
        values[owner][short] = text if short in WORDS else float(text)
    return PlantedEffects(tuple(_effect(name, values[name]) for name in wanted))


def _effect(name: str, values: dict[str, float | str]) -> Effect:
    """Return the effect of this name; ValueError where name or keys are unknown, TypeError where keys are missing."""
    classes = {kind.name: kind for kind in EFFECT_CLASSES}
    if name not in classes:
        raise ValueError(f"--effect {name}: known are none, {', '.join(classes)}")
    known = [item.name for item in dataclasses.fields(classes[name])]
    if unknown := sorted(set(values) - set(known)):
        raise ValueError(f"{name}: no key {unknown[0]}, known are {', '.join(known)}")
    return classes[name](**values)


if __name__ == "__main__":
    sys.exit(main())
