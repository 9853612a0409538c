"""The scripts of controller design run, say what they should, and hold on the nonlinear machine."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SCRIPTS = ("bode_and_natural_frequency", "pi_design_from_margins", "pole_placement", "lqr_disturbance_observer",
           "gain_scheduling_over_position")  # fmt: skip


def said(name: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """What a script prints; it writes its figure. In this process: a new one would take 2 s to import."""
    runpy.run_path(str(ROOT / "scenarios" / f"{name}.py"))["main"](folder)
    assert (folder / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    return capsys.readouterr().out


ALL = sorted(path.stem for path in (ROOT / "scenarios").glob("*.py"))


@pytest.mark.parametrize("name", ALL)
def test_script_imports_the_public_interface_alone(name: str) -> None:
    text = (ROOT / "scenarios" / f"{name}.py").read_text(encoding="utf-8")
    imports = re.findall(r"^ *((?:from|import) feeddrive.*)$", text, re.MULTILINE)
    assert imports == ["import feeddrive as fd"]


def test_scripts_are_listed() -> None:
    listed = (ROOT / "scenarios" / "README.md").read_text(encoding="utf-8")
    for name in SCRIPTS:
        assert f"`{name}.py`" in listed


def test_bode_and_natural_frequency(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shifts = re.findall(r"\(([+-][\d.]+) %\)", said("bode_and_natural_frequency", tmp_path, capsys))
    # half the resolution of the spectra, 8.5 Hz of 180 to 250
    assert len(shifts) == 3 and all(abs(float(shift)) < 2.5 for shift in shifts)


def test_pi_design_from_margins(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rigid, loop = re.findall(r"^  (?:formula|loop).*$", said("pi_design_from_margins", tmp_path, capsys), re.MULTILINE)
    assert "unstable: the machine rings" in rigid
    phase, gain = (float(found) for found in re.findall(r"([\d.]+)(?:°| dB)", loop))
    assert phase > 44.9 and gain > 7.9 and "overshoot" in loop


def test_pole_placement(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = said("pole_placement", tmp_path, capsys)
    poles = re.findall(r"([\d.]+) Hz, damping ([\d.]+)", text)
    assert poles == [("60.0", "0.800"), ("240.0", "0.080"), ("512.5", "0.015"), ("1000.0", "1.000")]
    given = [float(found) for found in re.findall(r"gives way by ([\d.]+)", text)]
    # 500 N on 194 N/µm of the chain alone are 2.6 µm; the controller must not add many times that
    assert len(given) == 2 and max(given) < 10


def test_lqr_disturbance_observer(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = said("lqr_disturbance_observer", tmp_path, capsys)
    estimated = re.search(r"estimated force (-[\d.]+) N", text)
    assert estimated is not None and abs(float(estimated[1]) + 500) < 5  # 1 % of the force
    gives = {name: float(way) for name, way in re.findall(r"(cascade|optimal)  moving +gives way by +([\d.]+)", text)}
    assert gives["optimal"] < gives["cascade"]


@pytest.mark.slow  # four designs for a chain of twelve states
def test_gain_scheduling_over_position(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = said("gain_scheduling_over_position", tmp_path, capsys)
    rises = [float(rise) for rise in re.findall(r"rise +([\d.]+) ms", text)]
    assert rises[1] < 0.6 * rises[0]  # at the near end, twice the gain
    assert rises[3] == pytest.approx(rises[2], rel=0.1)  # at the far end, the same
