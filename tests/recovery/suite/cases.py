"""The cases: every effect at three sizes on every machine with two noises, pairs, nulls, and declared numbers off."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass, field
from enum import StrEnum
from typing import cast

import numpy as np

from tests.generator.axis import MECHANICAL
from tests.generator.effects import Effect
from tests.generator.sizing import SHARES
from tests.recovery.suite.motion import SECONDS, seconds_for
from tests.recovery.suite.pairs import HEAT_PAIRS, PAIRS
from tests.recovery.suite.planting import MACHINES, Planting, Values, is_warm_up, values_of, variants
from tests.recovery.suite.sizes import NOISES, planted_size

EDITION = 1
"""Raised when what a case's result holds changes, so that older results are not taken."""

NULLS = {"bench": 15, "light": 15, "warm-up": 5, "short warm-up": 5}
"""Cases with nothing planted and the declared numbers right."""

OFFS = {"bench": 10, "light": 10}
"""Cases with nothing planted and declared numbers off."""

NULL_SECONDS = {"bench": ((12.0, 7.6), (9.0, 7.0), (14.0, 8.0)), "light": ((6.8, 6.0), (8.0, 6.5), (10.0, 7.0))}
"""Lengths in turn [s]: other lengths are other strokes."""

OFF_LEAST, OFF_MOST = 0.05, 0.20


class Kind(StrEnum):
    """What a case is about."""

    SINGLE = "single"
    PAIR = "pair"
    NULL = "null"
    OFF = "off"


@dataclass(frozen=True)
class Case:
    """One pair of recordings to be diagnosed.

    Attributes:
        label: what it is called, unique.
        kind: what it is about.
        machine: of MACHINES.
        noise: over that of the declared sensors.
        effects: planted.
        size: share of the error that the true plant takes away, or a word.
        seconds: lengths of the recordings [s]; 0 for a warm-up, which has its programme.
        off: declared number -> true one over it.
    """

    label: str
    kind: Kind
    machine: str
    noise: float
    effects: tuple[Planting, ...] = ()
    size: str = ""
    seconds: tuple[float, float] = (0.0, 0.0)
    off: dict[str, float] = field(default_factory=dict)

    @property
    def planted(self) -> dict[str, Values]:
        """Effect to its parameters (SI)."""
        return {effect.name: values_of(effect) for effect in self.effects}

    @property
    def in_half(self) -> bool:
        """Whether it is in the balanced half: of every effect and size one case on each machine and with each noise."""
        if self.kind is not Kind.SINGLE:
            return True
        size = [f"{share:.0%}" for share in SHARES].index(self.size)
        turn = list(variants(self.machine)).index(self.effects[0].name)
        return (MACHINES.index(self.machine) + NOISES.index(self.noise) + size + turn) % 2 == 0

    @property
    def seeds(self) -> tuple[int, int]:
        """Of the noise in both recordings; another label has others."""
        number = int(hashlib.sha256(self.label.encode()).hexdigest()[:7], 16)
        return 2 * number, 2 * number + 1

    @property
    def digest(self) -> str:
        """Of everything that makes the recordings."""
        whole = [
            EDITION, self.kind, self.machine, self.noise, self.planted, self.seeds, self.seconds, self.off,
        ]  # fmt: skip
        return hashlib.sha256(json.dumps(whole, sort_keys=True).encode()).hexdigest()[:12]


def all_cases() -> tuple[Case, ...]:
    """Every case, in the order of the table."""
    return (*singles(), *pair_cases(), *nulls(), *offs())


def smoke_cases() -> tuple[Case, ...]:
    """One case an effect: the 50 % size, of which a miss is no chance; machines and noises in turn."""
    wanted: dict[str, Case] = {}
    for machines in (("bench", "light"), ("short warm-up",)):
        names = list(variants(machines[0]))
        for number, name in enumerate(names):
            machine, noise = machines[number % len(machines)], NOISES[number // 2 % 2]
            made = [_single(machine, name, n, SHARES[2]) for n in (noise, *NOISES)]
            wanted[name] = next(case for case in made if case is not None)
    return tuple(wanted.values())


def singles() -> list[Case]:
    """One effect each; sizes that no effect can have are left out."""
    made = [
        _single(machine, name, noise, share)
        for machine in MACHINES
        for name in variants(machine)
        for share in SHARES
        for noise in NOISES
    ]
    return [case for case in made if case is not None]


def unreachable() -> list[str]:
    """Labels of the singles whose effect cannot be made so large, or so small."""
    return [
        _label(machine, name, noise, share)
        for machine in MACHINES
        for name in variants(machine)
        for share in SHARES
        for noise in NOISES
        if _single(machine, name, noise, share) is None
    ]


def _single(machine: str, name: str, noise: float, share: float) -> Case | None:
    # Which example, when there are several, turns with machine and noise.
    examples = variants(machine)[name]
    turn = 2 * (MACHINES.index(machine) % 2) + NOISES.index(noise)
    example = examples[turn % len(examples) if len(examples) != 2 else (turn // 2 + turn) % 2]
    effect = planted_size(machine, example, noise, share)
    if effect is None:
        return None
    label, seconds = _label(machine, name, noise, share), _seconds(machine, (effect,))
    return Case(label, Kind.SINGLE, machine, noise, (effect,), f"{share:.0%}", seconds)


def _seconds(machine: str, effects: tuple[Planting, ...]) -> tuple[float, float]:
    return (0.0, 0.0) if is_warm_up(machine) else seconds_for(machine, cast(tuple[Effect, ...], effects))


def _label(machine: str, name: str, noise: float, share: float) -> str:
    return f"{name} {share:.0%} {machine} noise x{noise:g}"


def pair_cases() -> list[Case]:
    """Two effects each: at the 50 % size on one axis, at the size that a service engineer meets on the other."""
    made = []
    for number, (first, second) in enumerate(PAIRS):
        for machine in ("bench", "light"):
            large = (number + (machine == "light")) % 2 == 1
            made.append(_pair(machine, first, second, large))
    made += [_pair("warm-up", first, second, large=False) for first, second in HEAT_PAIRS]
    return made


def _pair(machine: str, first: tuple[str, int], second: tuple[str, int], large: bool) -> Case:
    examples = [variants(machine)[name][which] for name, which in (first, second)]
    sized = [None if large else planted_size(machine, example, 1.0, SHARES[2]) for example in examples]
    effects = tuple(effect or example for effect, example in zip(sized, examples, strict=True))
    size = "service" if large else f"{SHARES[2]:.0%}"
    label = f"{first[0]} + {second[0]} {size} {machine}"
    return Case(label, Kind.PAIR, machine, 1.0, effects, size, _seconds(machine, effects))


def nulls() -> list[Case]:
    """Nothing planted, everything as declared; noises and lengths in turn."""
    made = []
    for machine, count in NULLS.items():
        for number in range(count):
            noise = NOISES[number % 2]
            seconds = (0.0, 0.0) if is_warm_up(machine) else NULL_SECONDS[machine][number % 3]
            made.append(
                Case(f"null {number + 1} {machine} noise x{noise:g}", Kind.NULL, machine, noise, seconds=seconds)
            )
    return made


def offs() -> list[Case]:
    """Nothing planted, one or three of the declared numbers off by 5 to 20 %."""
    made = []
    for machine, count in OFFS.items():
        random = np.random.default_rng(MACHINES.index(machine) + 1)
        # Every number comes first once before one comes first again.
        order = [*random.permutation(len(MECHANICAL)), *random.permutation(len(MECHANICAL))]
        for number in range(count):
            others = random.choice(len(MECHANICAL), 2, replace=False) if number % 2 else []
            names = [MECHANICAL[int(i)] for i in dict.fromkeys([order[number], *others])]
            sizes = random.uniform(OFF_LEAST, OFF_MOST, len(names)) * random.choice([-1.0, 1.0], len(names))
            off = {name: round(float(1 + size), 3) for name, size in zip(names, sizes, strict=True)}
            label = f"off {number + 1} {machine}"
            made.append(Case(label, Kind.OFF, machine, 1.0, seconds=SECONDS[machine], off=off))
    return made
