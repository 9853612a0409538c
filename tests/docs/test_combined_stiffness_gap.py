"""The scenario of the measured stiffness gap runs as a person starts it, and says what it should."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_scenario_prints_what_explains_the_gap_and_writes_its_report(tmp_path: Path) -> None:
    script = ROOT / "scenarios" / "combined_stiffness_gap.py"
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "error", "PYTHONIOENCODING": "utf-8"}
    done = subprocess.run(
        [sys.executable, str(script), str(tmp_path)],
        capture_output=True,
        encoding="utf-8",
        env=environment,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    values = re.findall(r"^(\S.*?)  .*(?:yes|no)$", done.stdout, re.MULTILINE)
    assert {"nut stiffness", "coupling stiffness", "screw length"} <= set(values)
    assert "No single value meets all numbers" in done.stdout and "Most would be learnt" in done.stdout
    assert (tmp_path / "report.html").is_file() and list(tmp_path.glob("*.png"))
