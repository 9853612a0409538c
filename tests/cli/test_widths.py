"""Tables about machines on a narrow and on a wide terminal: no line is cut off."""

from __future__ import annotations

import pytest

from feeddrive.cli import output
from feeddrive.cli.main import main


@pytest.mark.parametrize("width", [80, 120])
@pytest.mark.parametrize("name", ["hsr_axis", "vertical_axis", "kimm_testbed", "emps"])
@pytest.mark.parametrize("command", ["show", "check", "modes"])
def test_tables_fit(
    command: str, name: str, width: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(output, "_WIDTH", width)
    assert main([command, name]) == 0
    lines = [line.rstrip() for line in capsys.readouterr().out.splitlines()]
    assert max(map(len, lines)) <= width
    framed = [line for line in lines if line[:1] in "┏┃┡│└" and line]
    assert framed and all(line[-1] in "┓┃┩│┘" for line in framed)


def test_gain_that_is_none_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "hsr_axis", "--position-gain", "-3 1/s"]) == 2
    assert "--position-gain: -3 1/s is no gain" in capsys.readouterr().err
