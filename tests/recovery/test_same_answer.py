"""The answer is the same, to the last digit, for any order of hashes and any number of workers.

That it is the same compiled and interpreted is tested in `tests/cli/test_without_compiler.py`.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

DIAGNOSED = """
import sys
from pathlib import Path
from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.finding import round
from feeddrive.diagnosis.likelihood.outputs import diagnosis_json
from feeddrive.plant.file.plant_file import read_plant
from tests.recovery.rigid_runs import PLANT, Truth, rigid_run

round.WORKERS = int(sys.argv[1])
plant = Path(sys.argv[2])
plant.write_text(PLANT, encoding="utf-8")
result, _ = diagnose(read_plant(plant), [rigid_run("a", Truth(mass=9.0, ripple=0.01), seconds=8.0)])
print(diagnosis_json(result))
"""


def answer(hashes: str, workers: int, folder: Path) -> str:
    """The text of diagnosis.json from a process of its own."""
    done = subprocess.run(
        [sys.executable, "-c", DIAGNOSED, str(workers), str(folder / "plant.toml")],
        env={**os.environ, "PYTHONHASHSEED": hashes}, cwd=Path(__file__).resolve().parents[2],
        capture_output=True, text=True, timeout=600, check=True,
    )  # fmt: skip
    return done.stdout


@pytest.mark.slow
def test_hashes_and_workers_change_no_digit(tmp_path: Path) -> None:
    first = answer("0", 1, tmp_path)
    assert '"torque_ripple"' in first
    assert answer("1", 2, tmp_path) == first
    assert answer("2", 3, tmp_path) == first
