"""A case of the fleet: a machine, a programme, what is planted, what is declared wrongly, and how it is spoilt.

    20 % nothing planted, 15 % a spoilt recording, 15 % two effects, the rest one; half of the laws are relatives where
    the law has one; in half of all cases declared values are off, each within its tolerance, two of them up to twice.

Sizes are from 1.1 to 8 times the floor (`tests.generator.telling.visible`): the error of the true plant without the
effect, its declared values fitted within their tolerances, over that of the true plant, both led by the recorded motor
angle. An effect that a machine and a programme cannot show at its size, or that
declared values within their tolerance imitate, is drawn again on another machine. Nothing of the package takes part.
"""

from __future__ import annotations

import dataclasses
import io
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from tests.generator.drawn_effects import (
    MAKERS,
    NEEDS_SCALE,
    TOLERANCES,
    TOUCHED,
    Drawn,
    are_possible,
    drawn_effect,
    off_factors,
)
from tests.generator.effects import Effect
from tests.generator.effects.relatives import Relative
from tests.generator.machines import Machine, Random, drawn_machine
from tests.generator.programmes import KINDS, programme
from tests.generator.runs import Array, Channels, Run, changes, run, softened, steady, steps_of
from tests.generator.telling import Missed, Visible, calibration, from_declared, missed, visible
from tests.recovery.fleet.spoilt import spoilings, spoilt

SHARES = {"null": 0.20, "corrupted": 0.15, "pair": 0.15, "single": 0.50}
SMALLEST, LARGEST = 1.1, 8.0
OFF = 0.5
RELATIVE = 0.5
MOST_ROWS = 60_000
LEAST_TOLD = 10.0
"""Standard deviations by which an effect is told from declared values within their tolerance: less is no effect but
a calibration (`tests.generator.telling`)."""

SLOWEST_EXCITED = 1e-3
"""Time between rows [s] beyond which nobody injects torque: the recording would not show what it does."""

TRIES = 12

MOST_STEPS = 2e7
"""Steps of a run beyond which another machine is drawn: 0.8 µs each with the plant beside it, so that one size of an
effect would take the 18 s that a whole case may (600 in 90 min on two cores). A bristle that breaks away within a
micrometre at full speed asks for as many."""

ALIKE = (
    ("payload", "inertia_deviation", "structural_mode", "torque_constant_droop"),
    ("coulomb_asymmetry", "constant_force", "viscous_asymmetry", "position_spring"),
    ("stribeck", "presliding", "backlash", "preload_loss", "stiffness_deviation", "stiffness_vs_position"),
    ("lead_error_cumulative", "thermal_growth"),
    ("drive_delay", "channel_delay"),
    ("friction_deviation", "viscous_warmup", "stribeck", "load_dependent_friction", "friction_vs_position"),
)
"""Names of which no two are planted in one recording: what one is over the other's is another question."""

TIMING = ("drive_delay", "channel_delay")


@dataclass(frozen=True)
class Planted:
    """One planted effect: what it is, and how visible in the recording that is fitted."""

    effect: Effect
    relative: bool
    shown: Visible

    @property
    def as_record(self) -> dict[str, Any]:
        """Name, place, values (SI), law and size."""
        base = self.effect.base if isinstance(self.effect, Relative) else self.effect
        values = dataclasses.asdict(base)
        place = next((str(values.pop(key)) for key in ("port", "where", "channel") if key in values), "")
        return {
            "name": self.effect.name,
            "place": place,
            "values": values,
            "relative": self.relative,
            "law": self.effect.law if isinstance(self.effect, Relative) else "",
            "size": self.shown.size,
            "torque_over_noise": self.shown.torque,
            "position_over_noise": self.shown.position,
        }


@dataclass(frozen=True)
class Case:
    """A pair of recordings, the declared plant and the truth.

    seed: of everything. kind: of SHARES. declared, true: the machine as it is declared and as it is.
    programme: of KINDS. excited: whether torque is injected. off: number -> true over declared.
    spoiling: how both recordings are spoilt.
    plant: text of the plant file. fit, judge: channels as recorded (SI). exact: torque, motor angle and table position
    of the judged rows without sensor errors. runs: what made them. redrawn: machines that showed too little before.
    """

    seed: int
    kind: str
    declared: Machine
    true: Machine
    programme: str
    excited: bool
    planted: tuple[Planted, ...]
    off: Mapping[str, float]
    spoiling: str
    plant: str
    fit: Channels
    judge: Channels
    exact: tuple[Array, Array, Array]
    runs: tuple[Run, Run] = field(repr=False)
    redrawn: int = 0

    @property
    def truth(self) -> dict[str, Any]:
        """What is to be found, as JSON holds it.

        `may`: names that are true as well, though nothing is planted under them: values beyond their tolerance. Found
        or not, they count neither way.
        """
        m, sensors = self.declared, self.declared.axis.sensors
        return {
            "seed": self.seed,
            "kind": self.kind,
            "programme": self.programme,
            "excited": self.excited,
            "planted": [one.as_record for one in self.planted],
            "off": dict(self.off),
            "may": sorted(self.may_be_named()),
            "spoiling": self.spoiling,
            "redrawn": self.redrawn,
            "rate_hz": 1.0 / m.row_time,
            "cycle_s": m.axis.sample_time,
            "rows": [len(self.fit["time"]), len(self.judge["time"])],
            "bits": sensors.encoder_bits,
            "scale_step": sensors.scale_step if m.scale else None,
            "mass": m.axis.table_mass,
            "motor_inertia": m.axis.motor_inertia,
            "screw_inertia": m.axis.screw_inertia,
            "guide_coulomb": m.axis.guide_coulomb,
            "torque_limit": m.axis.controller.torque_limit,
            "lead": m.axis.lead,
            "stroke": m.axis.travel[1] - m.axis.travel[0],
            "ratio": m.axis.ratio,
            "vertical": m.axis.fall > 0.0,
        }

    def may_be_named(self) -> set[str]:
        """Return names that a declared value beyond its tolerance gives a right to."""
        names = set()
        for key, factor in self.off.items():
            kind, name = BEYOND_NAMES.get(key, ("damping", ""))
            if name and abs(math.log(factor)) > math.log1p(TOLERANCES[kind]) - 1e-4:
                names.add(name)
        return names

    def write(self, folder: Path) -> tuple[Path, Path, Path]:
        """Write plant.toml, fit.csv, judge.csv and truth.json; return the first three."""
        folder.mkdir(parents=True, exist_ok=True)
        paths = folder / "plant.toml", folder / "fit.csv", folder / "judge.csv"
        paths[0].write_text(self.plant, encoding="utf-8")
        paths[1].write_text(csv_text(self.fit), encoding="utf-8")
        paths[2].write_text(csv_text(self.judge), encoding="utf-8")
        (folder / "truth.json").write_text(json.dumps(self.truth, indent=1) + "\n", encoding="utf-8")
        return paths


BEYOND_NAMES = {
    "table_mass": ("mass", "payload"),
    "motor_inertia": ("inertia", "inertia_deviation"),
    "screw_inertia": ("inertia", "inertia_deviation"),
    "guide_coulomb": ("friction", "friction_deviation"),
    "guide_viscous": ("friction", "friction_deviation"),
    "nut_coulomb": ("friction", "friction_deviation"),
    "bearing_coulomb": ("friction", "friction_deviation"),
    "nut_power": ("friction", "friction_deviation"),
    "axial_stiffness": ("stiffness", "stiffness_deviation"),
    "torsional_stiffness": ("stiffness", "stiffness_deviation"),
    "torque_constant": ("torque_constant", "channel_gain"),
}
"""Number -> kind of its tolerance, and the name that says that it is beyond."""

UNITS = {"time": "s", "setpoint": "m", "motor_torque": "N m", "motor_angle": "rad", "table_position": "m"}


def csv_text(channels: Channels) -> str:
    """Return the recording as a file holds it."""
    text = io.StringIO()
    text.write(",".join(f"{name} [{UNITS[name]}]" for name in channels) + "\n")
    np.savetxt(text, np.column_stack(list(channels.values())), fmt="%.12g", delimiter=",")
    return text.getvalue()


ENCODER_NULLS = 10_000_000
"""Seeds from here are machines as declared with nothing planted: + 1000 * bits of the encoder + number."""

NULL_BITS = (12, 14, 16, 17, 18, 20, 24)


def encoder_null_seeds(first: int, last: int) -> list[int]:
    """Return the seeds of the machines number `first` to `last` of every encoder."""
    return [ENCODER_NULLS + 1000 * bits + number for bits in NULL_BITS for number in range(first, last + 1)]


def case(seed: int) -> Case:
    """Return the case of a seed; the same one every time."""
    if seed >= ENCODER_NULLS:
        return _encoder_null(seed)
    kind = kind_of(seed)
    names = _names(kind, seed)
    for attempt in range(200):
        random = np.random.default_rng([seed, 14, attempt])
        if attempt and attempt % TRIES == 0:
            # No machine shows it: another effect.
            every = list(MAKERS)
            names = tuple(every[(every.index(name) + 1) % len(every)] for name in names)
        made = _attempt(seed, kind, names, random, drawn_machine(random))
        if made is not None:
            return dataclasses.replace(made, redrawn=attempt)
    raise RuntimeError(f"seed {seed}: no machine shows {names}")


def _encoder_null(seed: int) -> Case:
    bits = (seed - ENCODER_NULLS) // 1000
    for attempt in range(50):
        random = np.random.default_rng([seed, 14, attempt])
        made = _attempt(seed, "encoder null", (), random, drawn_machine(random, bits=bits))
        if made is not None:
            return made
    raise RuntimeError(f"seed {seed}: no steady machine")


def kind_of(seed: int) -> str:
    """Return what the case of a seed is about."""
    random = np.random.default_rng([seed, 13])
    return str(random.choice(list(SHARES), p=list(SHARES.values())))


def _names(kind: str, seed: int) -> tuple[str, ...]:
    """Every name comes as often as any other."""
    every = list(MAKERS)
    random = np.random.default_rng([seed, 15])
    if kind in ("null", "corrupted"):
        return ()
    first = every[int(random.integers(len(every)))]
    if kind == "single":
        return (first,)
    others = [name for name in every if name != first and not any({first, name} <= set(group) for group in ALIKE)]
    return first, str(random.choice(others))


def _attempt(seed: int, kind: str, names: tuple[str, ...], random: Random, declared: Machine) -> Case | None:
    if not declared.scale and set(names) & set(NEEDS_SCALE):
        return None
    if set(names) & set(TIMING):
        declared = softened(declared, 0.4)
    which, excited = drawn_programme(random)
    excited = excited and declared.row_time <= SLOWEST_EXCITED
    length = seconds_of(declared, random, names)
    touched = frozenset(key for name in names for key in TOUCHED.get(name, ()))
    off = off_factors(random, touched) if random.random() < OFF and kind != "encoder null" else {}
    seeds = [int(one) for one in random.integers(0, 2**31, 4)]
    drawn: list[Drawn] = []
    for name in names:
        one = drawn_effect(name, declared, random, length[0], bool(random.random() < RELATIVE))
        one = one or drawn_effect(name, declared, random, length[0], False)
        assert one is not None
        drawn.append(one)
    targets = [math.exp(random.uniform(math.log(SMALLEST), math.log(LARGEST))) for _ in drawn]
    for gain in (1.0, 0.5, 0.25, 0.12):
        quiet = softened(declared, gain) if gain < 1.0 else declared
        true = really(quiet, off)
        asked = [
            programme(quiet, which, np.random.default_rng(seeds[i]), length[i], excited) for i in range(2)
        ]  # fmt: skip
        try:
            bare = run(true, (), *asked[0])
        except FloatingPointError:
            continue
        if steady(bare):
            break
    else:
        return None
    floor = missed(bare, seeds[2])
    planted = _sized(true, drawn, targets, asked[0], floor)
    if planted is None:
        return None
    effects = tuple(one.effect for one in planted)
    if not are_possible(effects, true):
        return None
    runs = _runs(true, effects, asked, lambda one: not any(from_declared(one, n, floor) < LEAST_TOLD for n in names))
    if runs is None:
        return None
    factor = off.get("torque_constant", 1.0)
    fit, judge = (one.recorded(noise, factor) for one, noise in zip(runs, seeds[2:], strict=True))
    spoiling = ""
    if kind == "corrupted":
        spoiling = str(random.choice(spoilings(quiet)))
        fit, judge = (spoilt(quiet, spoiling, channels) for channels in (fit, judge))
    torque, angle, position = runs[1].exact()
    text = plant_text_of(quiet, seed)
    return Case(
        seed, kind, quiet, true, which, excited, tuple(planted), off, spoiling, text, fit, judge,
        (torque / factor, angle, position), runs,
    )  # fmt: skip


def _runs(
    true: Machine, effects: tuple[Effect, ...], asked: Sequence[tuple[Array, Array]], is_told: Callable[[Run], bool]
) -> tuple[Run, Run] | None:
    """The runs that are fitted and judged, if they stay steady and the first tells what is planted."""
    try:
        fitted = run(true, effects, *asked[0])
        if not steady(fitted) or not is_told(fitted):
            return None
        judged = run(true, effects, *asked[1])
    except FloatingPointError:
        return None
    return (fitted, judged) if steady(judged) else None


def plant_text_of(machine: Machine, seed: int) -> str:
    """Return the text of the plant file."""
    from tests.recovery.fleet.plant_text import plant_text

    return plant_text(machine, f"machine {seed}")


def drawn_programme(random: Random) -> tuple[str, bool]:
    """Return a kind of programme, and whether torque is injected."""
    which = str(random.choice(KINDS))
    return which, bool(random.random() < {"strokes": 0.25, "milling": 0.0, "reversals": 0.5}[which])


def seconds_of(machine: Machine, random: Random, names: tuple[str, ...] = ()) -> tuple[float, float]:
    """Return the lengths of the recordings for fitting and judging [s]."""
    most = max(MOST_ROWS * machine.row_time, 10.0 if set(names) & {"thermal_growth", "viscous_warmup"} else 6.0)
    fitted = min(float(random.uniform(10.0, 22.0)), most)
    return fitted, max(0.65 * fitted, 5.0)


def really(declared: Machine, off: Mapping[str, float]) -> Machine:
    """Return the machine as it is, its declared values being off."""
    mechanical = {key: factor for key, factor in off.items() if key != "torque_constant"}
    return dataclasses.replace(declared, axis=declared.axis.off_by(mechanical))


NEAR = 0.12
"""By how much of its logarithm a size may miss the drawn one."""


def _sized(
    true: Machine, drawn: list[Drawn], targets: list[float], asked: tuple[Array, Array], floor: Missed
) -> list[Planted] | None:
    """Return the effects at sizes near the targets; None where one cannot be."""
    found: list[Planted] = []
    for one, target in zip(drawn, targets, strict=True):
        shown = _grown(true, one, target, asked, floor)
        if shown is None:
            return None
        found.append(shown)
    return found


def _grown(true: Machine, drawn: Drawn, target: float, asked: tuple[Array, Array], floor: Missed) -> Planted | None:
    wanted, factor = math.sqrt(target**2 - 1.0), max(1.0, drawn.low)
    tried: list[tuple[float, float]] = []
    last: Planted | None = None
    for _ in range(5):
        effect = _possible(drawn, factor, true)
        if effect is None or steps_of(true, (effect,), len(asked[0])) > MOST_STEPS:
            return None
        try:
            one = run(true, (effect,), *asked)
        except FloatingPointError:
            return None
        others = calibration(one, floor, TOUCHED.get(drawn.effect.name, ()))
        shown = visible(floor, others, *changes(one, ()))
        ratio = max(shown.torque, shown.position)
        if not math.isfinite(ratio) or ratio <= 0.0:
            return None
        last = Planted(effect, drawn.relative, shown)
        if abs(math.log(ratio / wanted)) < NEAR:
            return last
        if ratio > wanted and factor <= drawn.low * 1.0001:
            # A value that is off is so by more than its tolerance, be it more visible than drawn.
            return last if shown.size <= 1.5 * LARGEST else None
        if ratio < wanted and factor >= drawn.high * 0.9999:
            return last if shown.size >= SMALLEST else None
        tried.append((math.log(factor), math.log(ratio)))
        factor = min(max(_next(tried, math.log(wanted)), drawn.low), drawn.high)
    return last if last is not None and SMALLEST <= last.shown.size <= LARGEST else None


def _next(tried: list[tuple[float, float]], wanted: float) -> float:
    """Return the next factor: by proportion first, then by the secant."""
    at, value = tried[-1]
    slope = 1.0
    if len(tried) > 1 and abs(tried[-1][0] - tried[-2][0]) > 1e-6:
        slope = (tried[-1][1] - tried[-2][1]) / (tried[-1][0] - tried[-2][0])
        slope = min(max(slope, 0.3), 3.0)
    return math.exp(at + min(max((wanted - value) / slope, -3.5), 3.5))


def _possible(drawn: Drawn, factor: float, machine: Machine) -> Effect | None:
    try:
        effect = drawn.effect.scaled(factor)
    except ValueError:
        return None
    return effect if are_possible([effect], machine) else None
