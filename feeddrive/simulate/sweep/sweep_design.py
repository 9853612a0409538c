"""The runs of a sweep: every combination of the listed values, each with the same random samples.

Random values are a Latin hypercube: every one of N equal slices of each range holds one sample.

Source: McKay, Beckman, Conover, Technometrics 21 (1979) 239, section 2.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import feeddrive
from feeddrive.errors import InputError
from feeddrive.simulate.scenario.scenario_file import read_scenario
from feeddrive.simulate.sweep.sweep_values import MOST_RUNS, Parameter, Value

_ALLOWED = {"controller.allow_unstable": "true"}
"""Checks ask whether values can be read; a loop that is unstable is a result of the sweep."""


@dataclass(frozen=True)
class Design:
    """What is run.

    Attributes:
        path: of the scenario.
        settings: overrides of all runs.
        parameters: that are varied.
        rows: of each run, one value per parameter.
        digest: checksum of the program, all files and all rows.
        base_digest: of the first row's scenario, by which a worker knows that it sees the same files.
    """

    path: Path
    settings: Mapping[str, str]
    parameters: tuple[Parameter, ...]
    rows: tuple[tuple[Value, ...], ...]
    digest: str
    base_digest: str

    def overrides(self, row: tuple[Value, ...]) -> dict[str, str]:
        """Settings of one run, as `read_scenario` takes them."""
        varied = {one.key: one.text(value) for one, value in zip(self.parameters, row, strict=True)}
        return {**self.settings, **varied}


def make_design(
    path: Path,
    settings: Mapping[str, str],
    parameters: tuple[Parameter, ...],
    samples: int | None = None,
    seed: int = 0,
) -> Design:
    """The runs of a sweep, after a look at the ends of every range.

    Args:
        path: of the scenario.
        settings: overrides of all runs.
        parameters: that are varied.
        samples: of the random ones; None where there are none.
        seed: of the random ones.

    Raises:
        InputError: a key or a value at an end of its range that the scenario refuses, too many runs, or samples asked
            for or missing.
    """
    for one in parameters:
        if one.key in settings:
            raise InputError("is set and varied", f"--vary {one.key}", "leave out its --set")
    rows = _rows(parameters, samples, seed)
    bare = Design(path, settings, parameters, rows, "", "")
    seen = [scenario_digest(path, bare.overrides(rows[0]), f"--vary {', '.join(one.key for one in parameters)}")]
    for place, one in enumerate(parameters):
        for value in one.values if not one.unit else (one.values[0], one.values[-1]):
            at = (*rows[0][:place], value, *rows[0][place + 1 :])
            seen.append(scenario_digest(path, bare.overrides(at), f"--vary {one.key}"))
    content = json.dumps([_program_digest(), seen, [(one.key, one.unit) for one in parameters], rows])
    return Design(path, settings, parameters, rows, hashlib.sha256(content.encode()).hexdigest(), seen[0])


@cache
def _program_digest() -> str:
    """Checksum of feeddrive's own files: runs before and behind a change of the program are not put into one table."""
    content = hashlib.sha256()
    for path in sorted(Path(feeddrive.__file__).parent.rglob("*")):
        if path.suffix in (".py", ".c"):
            content.update(path.read_bytes())
    return content.hexdigest()


def scenario_digest(path: Path, overrides: Mapping[str, str], where: str) -> str:
    """Checksum of a scenario with overrides, if it can be read; its loop may be unstable."""
    try:
        return read_scenario(path, {**overrides, **_ALLOWED}).digest
    except InputError as error:
        place = f"{where}, {error.where}" if error.where else where
        raise InputError(error.what, place, error.mend) from None


def _rows(parameters: tuple[Parameter, ...], samples: int | None, seed: int) -> tuple[tuple[Value, ...], ...]:
    drawn = [one for one in parameters if one.random]
    if bool(drawn) != (samples is not None):
        mend = "write --samples 100" if drawn else 'leave it out, or write a random range such as "key=50~90 N"'
        raise InputError("no number of samples" if drawn else "nothing is random", "--samples", mend)
    if samples is not None and samples < 2:
        raise InputError(f"{samples} samples", "--samples", "write 2 or more")
    count = math.prod(len(one.values) for one in parameters if not one.random) * (samples or 1)
    if count > MOST_RUNS:
        raise InputError(f"{count} runs", "--vary", f"at most {MOST_RUNS} are possible; vary fewer values")
    hypercube = iter(_hypercube(drawn, samples or 1, seed)) if drawn else iter(())
    columns = {one.key: next(hypercube) for one in drawn}
    listed = itertools.product(*(one.values for one in parameters if not one.random))
    rows = []
    for combination in listed:
        for sample in range(samples or 1):
            fixed = iter(combination)
            rows.append(tuple(columns[one.key][sample] if one.random else next(fixed) for one in parameters))
    return tuple(rows)


def _hypercube(drawn: list[Parameter], samples: int, seed: int) -> list[list[float]]:
    """Samples of each random parameter, in its unit."""
    from scipy.stats import qmc  # takes half a second to import

    unit = qmc.LatinHypercube(len(drawn), rng=seed).random(samples).T
    ends = [(float(one.values[0]), float(one.values[1])) for one in drawn]
    return [[float(low + (high - low) * share) for share in row] for (low, high), row in zip(ends, unit, strict=True)]
