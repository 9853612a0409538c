"""Records on disk, one file a case, and the runs that fill them: killed at any moment, they go on where they were."""

from __future__ import annotations

import json
import multiprocessing
import re
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

from feeddrive.files import write_text_atomically
from tests.recovery.suite.cases import Case
from tests.recovery.suite.one import Record, run
from tests.state import ROOT, digest_of

NOT_USED = ("cli", "export", "report", "reproduce")
"""Folders of the package that no diagnosis imports (a test sees to it); all the rest counts, C included."""

LIBRARIES = ("numpy", "scipy", "casadi", "pysindy", "scikit-learn")
"""Libraries whose version counts."""

Said = Callable[[str], None]


def code_state() -> str:
    """Digest of all that can change a record; records of another state are not taken.

    The package but `NOT_USED`, the simulator that plants, the suite itself, the plant files, and the versions of Python
    and of `LIBRARIES`.
    """
    return digest_of(state_files(), LIBRARIES, ROOT)


def state_files() -> list[Path]:
    """Files that the state is the digest of, in order."""
    package = [
        path
        for path in (ROOT / "feeddrive").rglob("*")
        if path.suffix in SOURCES and path.relative_to(ROOT).parts[1] not in NOT_USED
    ]
    beside = [path for folder in ("tests/generator", "tests/recovery/suite") for path in (ROOT / folder).rglob("*")]
    plants = (ROOT / "plants").glob("*.toml")
    return sorted(path for path in (*package, *beside, *plants) if path.suffix in SOURCES)


SOURCES = (".py", ".c", ".h", ".toml", ".json")


def file_of(folder: Path, case: Case) -> Path:
    """Where the record of a case is kept."""
    return folder / f"{re.sub(r'[^a-z0-9]+', '_', case.label.lower()).strip('_')}-{case.digest}.json"


def kept(folder: Path, case: Case, code: str) -> Record | None:
    """The record of a case, or None where there is none of this state of the code."""
    path = file_of(folder, case)
    if not path.exists():
        return None
    record: Record = json.loads(path.read_text(encoding="utf-8"))
    return record if record["code"] == code else None


def do(case: Case, folder: Path, code: str) -> Record:
    """Run a case and keep its record."""
    record = run(case) | {"code": code}
    text = json.dumps(record, indent=1, ensure_ascii=False) + "\n"
    write_text_atomically(file_of(folder, case), text)
    return record


def run_missing(cases: Sequence[Case], folder: Path, workers: int, said: Said) -> int:
    """Run the cases without a record, in an order that mixes them, so that a part is a fair sample.

    Args:
        cases: of the table.
        folder: of the records, made if missing.
        workers: processes; with one everything happens in this one.
        said: told of every case that ends.

    Returns:
        Number of cases run.
    """
    folder.mkdir(parents=True, exist_ok=True)
    code = code_state()
    missing = [case for case in cases if kept(folder, case, code) is None]
    missing.sort(key=lambda case: case.digest)
    said(f"{len(cases) - len(missing)} of {len(cases)} cases are there, {len(missing)} to be run")
    if workers == 1:
        for number, case in enumerate(missing, start=1):
            said(_line(number, len(missing), do(case, folder, code)))
        return len(missing)
    with ProcessPoolExecutor(workers, multiprocessing.get_context("spawn")) as pool:
        try:
            futures = [pool.submit(do, case, folder, code) for case in missing]
            for number, future in enumerate(as_completed(futures), start=1):
                said(_line(number, len(missing), future.result()))
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return len(missing)


def _line(number: int, count: int, record: Record) -> str:
    names = ", ".join(one["name"] for one in record["found"]) or ("an error" if "raised" in record else "nothing")
    return f"{number:4d}/{count}  {sum(record['cpu'].values()):5.1f} s CPU  {record['label']}: {names}"
