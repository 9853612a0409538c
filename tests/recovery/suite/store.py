"""Records on disk, one file a case, and the runs that fill them: killed at any moment, they go on where they were."""

from __future__ import annotations

import hashlib
import json
import multiprocessing
import re
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

import feeddrive
from feeddrive.files import write_text_atomically
from tests.recovery.suite.cases import Case
from tests.recovery.suite.one import Record, run

PARTS = ("quantity.py", "recording", "parts", "effects", "plant", "thermal", "simulate", "diagnose")
"""Of the package, what a diagnosis uses."""

Said = Callable[[str], None]


def code_state() -> str:
    """Digest of the package's code that a diagnosis uses; records of other code are not taken."""
    root, digest = Path(feeddrive.__file__).parent, hashlib.sha256()
    for part in PARTS:
        for path in sorted([root / part] if part.endswith(".py") else (root / part).rglob("*.py")):
            digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:12]


def file_of(folder: Path, case: Case) -> Path:
    """Where the record of a case is kept."""
    return folder / f"{re.sub(r'[^a-z0-9]+', '_', case.label.lower()).strip('_')}-{case.digest}.json"


def kept(folder: Path, case: Case, code: str) -> Record | None:
    """The record of a case, or None where there is none of this code; any code where `code` is empty."""
    path = file_of(folder, case)
    if not path.exists():
        return None
    record: Record = json.loads(path.read_text(encoding="utf-8"))
    return record if code in ("", record["code"]) else None


def do(case: Case, folder: Path, code: str) -> Record:
    """Run a case and keep its record."""
    record = run(case) | {"code": code}
    text = json.dumps(record, indent=1, ensure_ascii=False) + "\n"
    write_text_atomically(file_of(folder, case), text)
    return record


def run_missing(cases: Sequence[Case], folder: Path, workers: int, any_code: bool, said: Said) -> int:
    """Run the cases without a record, in an order that mixes them, so that a part is a fair sample.

    Args:
        cases: of the table.
        folder: of the records, made if missing.
        workers: processes; with one everything happens in this one.
        any_code: take records of other code too.
        said: told of every case that ends.

    Returns:
        Number of cases run.
    """
    folder.mkdir(parents=True, exist_ok=True)
    code = code_state()
    missing = [case for case in cases if kept(folder, case, "" if any_code else code) is None]
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
