"""The page on compensation: its blocks and commands run in their order, and what it says of them is so."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

import feeddrive as fd
from feeddrive.cli.main import main
from feeddrive.compensation.forms.all_forms import FORMS
from tests.analytic import compensation_readers as read

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "compensation.md").read_text(encoding="utf-8")


def test_every_form_is_in_the_table() -> None:
    assert tuple(re.findall(r"^\| `([a-z][a-z-]+)` \|", PAGE, re.MULTILINE)) == FORMS


@pytest.mark.slow
def test_page_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    steps = re.findall(r"```python\n(.*?)```|^    (feeddrive [^\n]*)$", PAGE, re.DOTALL | re.MULTILINE)
    assert len(steps) == 9
    for block, line in steps:
        if block:
            exec(compile(block, "docs/compensation.md", "exec"), names)
        else:
            assert main(shlex.split(line)[1:]) == 0, line
    assert "wind-up, not play" in capsys.readouterr().out
    table = names["table"]
    assert isinstance(table, fd.Compensation)
    # the diagnosed play is within its interval of 5 nm, the file counts tenths of a micrometre
    assert table.record()["play"] == pytest.approx(7.5e-6, abs=0.11e-6)
    predicted = {row["figure"]: row for row in table.record()["predicted"]}
    accuracy = next(row for name, row in predicted.items() if name.endswith("accuracy A"))
    assert accuracy["after"] < 0.1 * accuracy["before"]
    joint = read.LinuxCncJoint(100.0, 1000.0, 1e-3)
    assert joint.load((tmp_path / "x.comp").read_text()) == len((tmp_path / "x.comp").read_text().splitlines())
    slope = (joint.forward[-1] - joint.forward[0]) / (joint.nominal[-1] - joint.nominal[0])
    # the 95 % interval of the slope is 0.3 % to either side, with 15 nm of noise on the scale
    assert slope == pytest.approx(-40e-6, rel=3e-3)
    report = (tmp_path / "diagnosis" / "report.html").read_text(encoding="utf-8")
    for words in ("What to do", "after repair", "after compensation", "1. Look at"):
        assert words in report
    assert 'id="tab-bench"' in report
    (tmp_path / "circle.png").stat()
    # 2.4 um in place of 4.8 um and of 7.1 um before, within 13 ms: what the page prints
    words = (tmp_path / "enc_comp.ini.txt").read_text(encoding="utf-8")
    ((within, after, usual),) = re.findall(r"goes over within ([\d.]+) ms.* ([\d.]+) um in place of ([\d.]+) um", words)
    assert (round(float(within)), round(float(after), 1), round(float(usual), 1)) == (13, 2.4, 4.8)
    assert "<!DOCTYPE html>" in (tmp_path / "bench.html").read_text(encoding="utf-8")
