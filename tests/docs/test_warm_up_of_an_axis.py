"""The scenario of the axis that warms up runs as a person starts it, and says what it should."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_scenario_prints_course_and_energy_and_writes_its_figure(tmp_path: Path) -> None:
    script = ROOT / "scenarios" / "warm_up_of_an_axis.py"
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "error", "PYTHONIOENCODING": "utf-8"}
    done = subprocess.run(
        [sys.executable, str(script), str(tmp_path), "0.5"],
        capture_output=True, encoding="utf-8", env=environment, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    open_share = re.search(r"not accounted for +([+-][\d.]+) %", done.stdout)
    assert open_share is not None
    assert abs(float(open_share[1])) < 0.02
    errors = [float(text) for text in re.findall(r"([\d.]+) µm", done.stdout)]
    # Half an hour stretches the screw by tens of micrometres at the far stop.
    assert max(errors) > 20
    assert (tmp_path / "warm_axis.png").read_bytes().startswith(b"\x89PNG")
