"""The scenario of the measured stiffness gap runs as a person starts it, and says what it should."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_scenario_prints_the_pairs_and_writes_its_figure(tmp_path: Path) -> None:
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
    pairs = re.findall(r"^  [A-F] \+ [a-d]  .*$", done.stdout, re.MULTILINE)
    assert len(pairs) >= 20
    assert all(pair.endswith("191.0 N/µm  185.0 Hz") for pair in pairs)
    assert "3293 N/µm" in done.stdout and "cannot separate" in done.stdout
    assert (tmp_path / "combined_stiffness_gap.png").read_bytes().startswith(b"\x89PNG")
