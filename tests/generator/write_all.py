"""Write every committed recording again: python -m tests.generator.write_all [AXIS/CASE ...]."""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Sequence
from pathlib import Path

from tests.generator.axis import BENCH
from tests.generator.cases import CASES, DEMO_EFFECTS, Case
from tests.generator.profile import train_profile
from tests.generator.recording import simulate, write_csv

ROOT = Path(__file__).resolve().parents[2]
DATA = ROOT / "tests" / "data"
DEMO = ROOT / "scenarios" / "recordings" / "demo.csv.gz"
DEMO_SECONDS = 16.0


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the named cases (all, with truth.toml and the demo, where none is named) and return 0."""
    wanted = list(sys.argv[1:] if arguments is None else arguments)
    chosen = [case for case in CASES if not wanted or f"{case.axis}/{case.name}" in wanted]
    for case in chosen:
        write_case(case)
    if not wanted:
        write_csv(DEMO, simulate(BENCH, DEMO_EFFECTS, train_profile(BENCH, DEMO_SECONDS), seed=7))
    DATA.joinpath("truth.toml").write_text(truth(), encoding="utf-8")
    return 0


def write_case(case: Case) -> None:
    """Write the training and validation recording of one case."""
    for part, data in zip(("train", "validate"), case.recordings(), strict=True):
        write_csv(DATA / case.axis / f"{case.name}_{part}.csv.gz", data)


def truth() -> str:
    """Return the text of truth.toml: per axis, case and effect the planted parameters in SI units."""
    lines = ["# What is planted in each pair of recordings (SI units); written by tests.generator.write_all."]
    for case in CASES:
        lines += ["", f"[{case.axis}.{case.name}]"]
        lines += [f"off.{name} = {factor!r}" for name, factor in case.off]
        for effect in case.effects.effects:
            lines += [f"[{case.axis}.{case.name}.{effect.name}]"]
            values = dataclasses.asdict(effect)
            lines += [f"{key} = {_toml(value)}" for key, value in values.items()]
    return "\n".join(lines) + "\n"


def _toml(value: float | str) -> str:
    """Return a number or a word as TOML."""
    return f'"{value}"' if isinstance(value, str) else repr(float(value))


if __name__ == "__main__":
    sys.exit(main())
