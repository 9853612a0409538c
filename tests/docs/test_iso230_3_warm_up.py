"""The ISO 230-3 scenario runs as a person starts it, and says what it should."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_scenario_prints_its_numbers_and_writes_its_files(tmp_path: Path) -> None:
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "error", "PYTHONIOENCODING": "utf-8"}
    done = subprocess.run(
        [sys.executable, str(ROOT / "scenarios" / "iso230_3_warm_up.py"), str(tmp_path)],
        capture_output=True, encoding="utf-8", env=environment, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    targets = re.findall(r"^(\d+) mm +([\d. ]+?) *$", done.stdout, re.MULTILINE)
    assert [place for place, _ in targets] == ["200", "250", "300"]
    for _, numbers in targets:
        first_hour, heating, whole, largest, steady = map(float, numbers.split())
        assert first_hour < heating <= whole and largest <= whole and 60 < steady < 240
    left = {
        name: [float(value) for value in numbers.split()]
        for name, numbers in re.findall(r"^(\D.+?) {2,}(\d+\.\d\d +[\d. ]+?) *$", done.stdout, re.MULTILINE)
    }
    # More knowledge leaves less; two sensors leave a tenth and less, also where a motor heats the bearing undeclared.
    names = ("no compensation", "model alone, air recorded", "observer, 1 sensor", "observer, 2 sensors")
    remaining = [left[name][0] for name in names]
    assert remaining == sorted(remaining, reverse=True)
    assert min(left["observer, 2 sensors"][2:]) > 10 and min(left["line through observer, 2 sensors"][2:]) > 10
    for name in ("iso230_3_heating", "thermal_compensation", "thermal_error_stroke"):
        assert (tmp_path / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    assert "# K is the measured error" in (tmp_path / "thermal_line.csv").read_text(encoding="utf-8")
