"""Rivals on the cases that the fleet holds results of, one line of JSON each; they go on where they were stopped.

Sparse regression and the black box are those of `tests.recovery.suite.rivals`: both correct the declared plant by what
it leaves of the fitted recording, and are judged on the other one. An earlier state of the method is another checkout
of this project, whose command diagnoses the same files.
"""

from __future__ import annotations

import dataclasses
import json
import os
import subprocess
import sys
import tempfile
import time
import tomllib
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from tests.generator.axis import AxisParameters
from tests.recovery.fleet.case import Case, case
from tests.recovery.suite.regression_terms import same
from tests.recovery.suite.rivals import black_box, sparse
from tests.recovery.suite.truth import prepare_pair

Record = dict[str, Any]

RESULTS = "rivals.jsonl"
KINDS = ("single", "pair", "null")
"""Cases whose recordings are sound, and have a floor."""


def run_rivals(
    fleet: Sequence[Record], folder: Path, previous: Path | None, limit: float, minutes: float,
    said: Callable[[str], None],
) -> None:  # fmt: skip
    """Run the rivals on every case of the fleet that has none yet.

    Args:
        fleet: records of `tests.recovery.fleet.run`.
        folder: of the results.
        previous: checkout of an earlier state; None for no more than sparse regression and the black box.
        limit: seconds of processor time that the earlier state has for a case.
        minutes: no case begins later; 0 for no end.
        said: told a line a case.
    """
    begun, done = time.monotonic(), rivals_done(folder)
    for record in fleet:
        if record["outcome"] != "done" or record["truth"]["kind"] not in KINDS:
            continue
        known = done.get(record["seed"], {})
        if known.get("state") == record["state"] and (previous is None or "previous" in known):
            continue
        if minutes > 0 and time.monotonic() - begun > 60 * minutes:
            return
        found = {"seed": record["seed"], "state": record["state"]} | of_case(case(record["seed"]), previous, limit)
        with (folder / RESULTS).open("a", encoding="utf-8") as file:
            file.write(json.dumps(found, ensure_ascii=False) + "\n")
        said(line(record, found))


def rivals_done(folder: Path) -> dict[int, Record]:
    """Return the records by seed, the last of each."""
    path = folder / RESULTS
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    records: list[Record] = []
    for text in lines:
        try:
            records.append(json.loads(text))
        except json.JSONDecodeError:
            continue  # the line that was being written when it was killed
    return {one["seed"]: one for one in records}


def of_case(drawn: Case, previous: Path | None, limit: float) -> Record:
    """Return what the rivals make of a case."""
    with tempfile.TemporaryDirectory(prefix="rivals-") as name:
        paths = drawn.write(Path(name))
        begun = time.process_time()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            pair = prepare_pair(read_plant(paths[0]), *(read_recording(path) for path in paths[1:]))
            axis = at_the_motor(drawn)
            regression, errors = sparse(pair, axis), black_box(pair, axis)
        found: Record = {
            "sparse": dataclasses.asdict(regression),
            "black box": {"after": errors},
            "cpu": round(time.process_time() - begun, 2),
        }
        return found if previous is None else found | {"previous": diagnosed_by(previous, paths, limit)}


def at_the_motor(drawn: Case) -> AxisParameters:
    """Return the declared axis with its lead per revolution of the motor, whose angle the terms are of."""
    axis = drawn.declared.axis
    return dataclasses.replace(axis, lead=axis.lead / axis.ratio)


def named_by_regression(record: Record, regression: Record) -> set[str]:
    """Return the planted effects of which a term is among the strongest of some channel."""
    terms = {term for names in regression["terms"].values() for term in names}
    names = set()
    for one in record["truth"]["planted"]:
        values = one["values"] | {"channel": one["place"]}
        if same(one["name"], values) & terms:
            names.add(one["name"])
    return names


def diagnosed_by(checkout: Path, paths: Sequence[Path], limit: float) -> Record:
    """Return what the command of an earlier state says of a plant file and two recordings."""
    out = paths[0].parent / "out"
    command = [sys.executable, "-m", "feeddrive", "diagnose", paths[0].name, paths[1].name]
    command += ["--validate", paths[2].name, "--out", out.name]
    environment = os.environ | {"PYTHONPATH": str(checkout)}
    begun = os.times()
    try:
        ended = subprocess.run(
            command, cwd=paths[0].parent, env=environment, capture_output=True, text=True, timeout=3 * limit,
            check=False, preexec_fn=lambda: _limit(limit),
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return {"outcome": "time limit", "cpu": limit}
    after = os.times()
    cpu = round(after.children_user - begun.children_user + after.children_system - begun.children_system, 2)
    if ended.returncode or not (out / "diagnosis.json").exists():
        outcome = "time limit" if cpu >= 0.98 * limit else "refused" if "Traceback" not in ended.stderr else "raised"
        return {"outcome": outcome, "cpu": cpu, "said": ended.stderr[-500:]}
    said = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    added = tomllib.loads((out / "plant_after.toml").read_text(encoding="utf-8")).get("effect", [])
    places = [_place(one["name"], added, said["effects"][:at]) for at, one in enumerate(said["effects"])]
    return {
        "outcome": "done",
        "cpu": cpu,
        "found": [
            {"name": one["name"], "place": place, "asserted": True, "parameters": one["parameters"]}
            for one, place in zip(said["effects"], places, strict=True)
        ],
        "ambiguous": said["ambiguous"],
        "before": {channel["name"]: channel["before"]["rms"] for channel in said["channels"]},
        "after": {channel["name"]: channel["after"]["rms"] for channel in said["channels"]},
        "band": {channel["name"]: channel["band_hz"][1] for channel in said["channels"]},
    }


def _limit(seconds: float) -> None:
    import resource

    resource.setrlimit(resource.RLIMIT_CPU, (int(seconds), int(seconds) + 5))


def _place(name: str, added: Sequence[dict[str, Any]], before: Sequence[dict[str, Any]]) -> str:
    """Return the place of an effect in a plant file behind those of that name before it; empty where it says none."""
    placed = [one for one in added if one["name"] == name]
    number = sum(one["name"] == name for one in before)
    effect = placed[number] if number < len(placed) else {}
    return next((str(effect[key]) for key in ("channel", "where", "port") if key in effect), "")


def line(record: Record, found: Record) -> str:
    """Return a case in a line: errors over the floor."""
    floor = record["floor"]

    def over(errors: dict[str, float]) -> str:
        return f"{max((errors[name] / value for name, value in floor.items() if name in errors), default=0.0):.2f}"

    told = (
        f"{record['seed']} {over(record['before'])} -> {over(record['after'])}, sparse {over(found['sparse']['after'])}"
    )
    told += f", black box {over(found['black box']['after'])}"
    earlier = found.get("previous")
    if earlier:
        names = ", ".join(one["name"] for one in earlier.get("found", []))
        told += f", earlier {earlier['outcome']} {over(earlier.get('after', {}))} {names} ({earlier['cpu']:.0f} s)"
    return told
