"""Runs what measures the claims, each test or script once, and keeps the outcome: stopped, it goes on where it was."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict, dataclass, field
from pathlib import Path
from xml.etree import ElementTree

from tests.claims.book import MEASURED, Claim
from tests.state import ROOT, digest_of

FOLDERS = ("feeddrive", "plants", "scenarios", "tests", "benchmarks", "docs")
LIBRARIES = ("numpy", "scipy", "casadi")

ONE_THREAD = {name: "1" for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")}

LONGEST = 900.0
"""After this time [s] a test or script is stopped and counts as failed."""

Said = Callable[[str], None]


@dataclass(frozen=True)
class Outcome:
    """What became of one test or script.

    Attributes:
        target: pytest's node id, or a script.
        state: digest of the tree that it ran in.
        ended: "passed", "failed" or "skipped".
        why: of a skip, or the last lines of a failure.
        seconds: of the wall clock.
        measured: claim to its values.
    """

    target: str
    state: str
    ended: str
    why: str = ""
    seconds: float = 0.0
    measured: dict[str, list[float]] = field(default_factory=dict)


def state_of_the_tree() -> str:
    """Digest of everything that a claim may depend on."""
    paths = (path for folder in FOLDERS for path in (ROOT / folder).rglob("*") if path.is_file())
    return digest_of((path for path in paths if "__pycache__" not in path.parts and path.suffix != ".md"), LIBRARIES)


def targets_of(claims: Sequence[Claim]) -> list[str]:
    """Each test and script of the claims once, in their order."""
    return list(dict.fromkeys(target for claim in claims for target in claim.by))


def run_all(targets: Sequence[str], folder: Path, workers: int, said: Said) -> dict[str, Outcome]:
    """Outcome of every target: the kept one where it was made in this state, else run now.

    Scripts are timings: they run one after another and alone, after the tests.
    """
    folder.mkdir(parents=True, exist_ok=True)
    state, before = state_of_the_tree(), sum(os.times()[2:4])
    found = {target: old for target in targets if (old := _kept(folder, target, state)) is not None}
    missing = [target for target in targets if target not in found]
    said(f"state {state}: {len(found)} of {len(targets)} are there, {len(missing)} to be run")
    scripts = [target for target in missing if _is_script(target)]
    for these, together in (([t for t in missing if t not in scripts], workers), (scripts, 1)):
        with ThreadPoolExecutor(together) as pool:
            futures = [pool.submit(_run, target, state) for target in these]
            for future in as_completed(futures):
                outcome = future.result()
                found[outcome.target] = outcome
                _file(folder, outcome.target).write_text(json.dumps(asdict(outcome), indent=1), encoding="utf-8")
                said(f"{len(found):3d}/{len(targets)}  {outcome.seconds:6.1f} s  {outcome.ended:7s} {outcome.target}")
    if missing:
        said(
            f"{(sum(os.times()[2:4]) - before) / 60:.1f} minutes of processor time"
        )  # of all that was run and has ended
    return found


def _is_script(target: str) -> bool:
    return target.startswith("benchmarks/")


def _file(folder: Path, target: str) -> Path:
    return folder / (re.sub(r"[^A-Za-z0-9]+", "_", target).strip("_") + ".json")


def _kept(folder: Path, target: str, state: str) -> Outcome | None:
    """The outcome of a target in this state; a failed one is run again."""
    try:
        kept = Outcome(**json.loads(_file(folder, target).read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError):
        return None
    return kept if kept.state == state and kept.target == target and kept.ended != "failed" else None


def _run(target: str, state: str) -> Outcome:
    with tempfile.TemporaryDirectory() as folder:
        values, report = Path(folder) / "measured", Path(folder) / "report.xml"
        pytest = ["-m", "pytest", "-q", "-p", "no:cacheprovider", f"--junitxml={report}", target]
        command = [sys.executable, *([target] if _is_script(target) else pytest)]
        path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
        environment = {**os.environ, **ONE_THREAD, "PYTHONPATH": path, MEASURED: str(values)}
        began = time.monotonic()
        try:
            done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=LONGEST)
            status, told = done.returncode, done.stdout + done.stderr
        except subprocess.TimeoutExpired:
            status, told = -1, f"stopped after {LONGEST:g} s"
        ended, why = "passed" if status == 0 else "failed", ""
        if status != 0:
            why = " / ".join(line for line in told.strip().splitlines()[-3:] if line.strip())
        elif report.exists() and (skipped := _skipped(report)):
            ended, why = "skipped", skipped
        return Outcome(target, state, ended, why, time.monotonic() - began, _measured(values))


def _skipped(report: Path) -> str:
    """Why all of the tests in a report were skipped; "" where one was run."""
    cases = list(ElementTree.parse(report).iter("testcase"))
    skips = [case.find("skipped") for case in cases]
    if not cases or any(skip is None for skip in skips):
        return ""
    return next((skip.get("message", "") for skip in skips if skip is not None), "")


def _measured(path: Path) -> dict[str, list[float]]:
    found: dict[str, list[float]] = {}
    if path.exists():
        for line in path.read_text(encoding="utf-8").splitlines():
            entry = json.loads(line)
            found.setdefault(entry["key"], []).append(entry["measured"])
    return found
