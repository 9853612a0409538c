"""The demo finds what was planted in its recording, with the digits that the README prints."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from feeddrive.cli.main import main
from tests.claims.book import CLAIMS

ROOT = Path(__file__).resolve().parents[2]


def test_demo_finds_what_was_planted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["demo", "--out", str(tmp_path)]) == 0
    said = capsys.readouterr().out.replace("\N{NO-BREAK SPACE}", " ")
    result = json.loads((tmp_path / "diagnosis.json").read_text(encoding="utf-8"))
    assert {effect["name"] for effect in result["effects"]} == {"lead_error_periodic", "friction_vs_position"}
    found = {effect["name"]: effect["parameters"] for effect in result["effects"]}
    # planted: 2.1 um at order 1, 38 N at 160 mm; noise leaves 0.02 % of the first, half a percent of the other
    CLAIMS["demo.amplitude"].check(1e6 * found["lead_error_periodic"]["amplitude"]["value"])
    CLAIMS["demo.peak"].check(found["friction_vs_position"]["peak"]["value"])
    CLAIMS["demo.centre"].check(1e3 * found["friction_vs_position"]["centre"]["value"])
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    printed = re.search(r"```text\n(The declared plant lacks: .*?)```", readme, re.DOTALL)
    assert printed is not None
    for claim in ("2.100 µm", "37.99 N", "160.1 mm"):
        assert claim in printed[1] and claim in said
    assert (tmp_path / "report.html").is_file()
