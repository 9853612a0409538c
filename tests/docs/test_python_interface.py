"""The public interface: its names, its examples, its errors; every block of docs/python.md runs."""

from __future__ import annotations

import doctest
import importlib
import inspect
import pkgutil
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import feeddrive as fd

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")


def test_names_are_those_of_the_page() -> None:
    table = PAGE.split("## Names")[1]
    first = [line.split("|")[1] for line in table.splitlines() if line.startswith("| `")]
    assert sorted(name for cell in first for name in re.findall(r"`([^`]+)`", cell)) == sorted(fd.__all__)
    assert sorted(dir(fd)) == sorted(fd.__all__)


def test_no_name_is_hidden_by_a_module() -> None:
    """A module of the same name would take its place as soon as anything imports it."""
    modules = {one.name for one in pkgutil.iter_modules(fd.__path__)}
    assert not modules & set(fd.__all__)


@pytest.mark.parametrize("name", [name for name in fd.__all__ if name != "__version__"])
def test_every_name_is_documented(name: str) -> None:
    value = getattr(fd, name)
    assert inspect.getdoc(value)
    if inspect.isfunction(value):
        documented = inspect.getdoc(value) or ""
        for parameter in inspect.signature(value).parameters:
            assert re.search(rf"\b{parameter}\b", documented), f"{name} does not say what {parameter} is"


def test_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'lode'"):
        _ = fd.lode


def test_import_loads_nothing_heavy() -> None:
    heavy = "{'numpy', 'scipy', 'casadi', 'matplotlib', 'control', 'pint', 'pandas'}"
    code = f"import sys, feeddrive; print(sorted({heavy} & set(sys.modules)))"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"


_WITH_EXAMPLES = sorted(
    ".".join(path.relative_to(ROOT).with_suffix("").parts)
    for path in (ROOT / "feeddrive").rglob("*.py")
    if ">>> import feeddrive as fd" in path.read_text(encoding="utf-8")
)


@pytest.mark.parametrize("module", _WITH_EXAMPLES)
def test_examples_in_docstrings(module: str) -> None:
    found = doctest.testmod(importlib.import_module(module))
    assert found.attempted > 0
    assert found.failed == 0


def test_page_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The blocks of the page, in order, as a reader would type them; the planted backlash is found."""
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for block in re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL):
        exec(compile(block, "docs/python.md", "exec"), names)
    found = names["found"]
    assert isinstance(found, fd.Diagnosed)
    assert [one.name for one in found.effects] == ["backlash"]
    # the run's own engine made the recording, without noise: the width comes back to its interval's rounding
    assert found.effects[0].parameters["width"].value == pytest.approx(7.5e-6, rel=0.01)
    assert all(path.is_file() for path in names["files"])  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: fd.load("bensh_axis"), "bench_axis"),
        (lambda: fd.load(3), "is no path"),
        (lambda: fd.load("bench_axis").with_values({"table.mas": "160 kg"}), "mass"),
        (lambda: fd.load("bench_axis").with_values({"table.mass": 160.0}), "bare number"),
        (lambda: fd.load("bench_axis").bode("motor_torque", "motor_sped"), "motor_speed"),
        (lambda: fd.load("bench_axis").bode(frequencies=["2 kHz", "1 Hz"]), "is no range"),
        (lambda: fd.load("bench_axis").bode(controller=3), "is no controller"),
        (lambda: fd.load("bench_axis").stiffness(at="20 kg"), "kg"),
        (lambda: fd.load("bench_axis").stiffness(at=float("nan")), "is no quantity"),
        (lambda: fd.load("bench_axis").export("fmi", "out"), "fmu"),
        (lambda: fd.load("thermal_bench").modes(), "heat alone"),
        (lambda: fd.load("bench_axis").with_effects("backlash"), "is no effect"),
        (lambda: fd.load("bench_axis").with_effects(fd.effect("cooling", conductance="2 W/K", start="0 s")), "heat"),
        (lambda: fd.effect("backlsh", width="7.5 um"), "backlash"),
        (lambda: fd.effect("backlash", widht="7.5 um"), "width"),
        (lambda: fd.effect("backlash", width="7.5 N"), "N"),
        (lambda: fd.run("step_positon"), "step_position"),
        (lambda: fd.sweep("step_position", vary={"controller.position_gain": "40:60:2 1/s"}, workers=0), "workers"),
        (lambda: fd.diagnose(fd.load("bench_axis"), []), "no recording"),
        (lambda: fd.diagnose(fd.load("bench_axis"), 3), "is no recording"),
        (lambda: fd.read("nowhere.csv"), "nowhere.csv"),
        (lambda: fd.warm_up(fd.load("bench_axis")), "thermal"),
        (lambda: fd.Recording.from_arrays(time=[0, 1, 2], motor_angel=[0, 1, 2]), "motor_angle"),
        (lambda: fd.Recording.from_arrays(time=[0, 1, 3], motor_angle=[0, 1, 2]), "even"),
        (lambda: fd.Recording.from_arrays(motor_angle=[0, 1, 2]), "no time"),
    ],
)  # fmt: skip
def test_mistakes_are_told_in_one_line(call, words: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(fd.InputError) as caught:
        call()
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_results_show_themselves() -> None:
    axis = fd.load("bench_axis")
    for result in (axis.modes(), axis.stiffness(), axis.check(), axis.bode(), fd.list_effects()):
        assert "\n" in repr(result)
        assert result._repr_html_().startswith("<table>")
    testbed = fd.load("kimm_testbed")
    for result in (axis.bode(), testbed.modes(), testbed.stiffness()):  # those that are drawn
        assert "data:image/png;base64," in result._repr_html_()
    with pytest.raises(fd.InputError, match="nothing to draw"):
        axis.stiffness().plot()  # three inertias: no parts whose compliance it is


def test_every_scale_of_a_sweep_has_its_unit() -> None:
    swept = fd.sweep("step_position", vary={"controller.position_gain": "40:60:2 1/s"})
    labels = [axes.get_ylabel() for axes in swept.plot().axes]
    assert any(label.endswith("[1]") for label in labels)  # the overshoot is a pure number
    assert all(re.search(r"\[[^]]+\]$", label) for label in labels)


def test_numbers_are_those_of_the_state_space() -> None:
    """The curve is |C (jw - A)^-1 B| of the linearisation, computed here by NumPy alone."""
    axis = fd.load("bench_axis")
    curve = axis.bode("motor_torque", "motor_speed", at="x=0 mm, v=3 m/min").curves[0]
    G = axis.linear(at="x=0 mm, v=3 m/min")
    row, column = G.output_labels.index("motor_speed"), G.input_labels.index("motor_torque")
    for place in (0, len(curve.response.frequency) // 2, -1):
        s = 2j * np.pi * curve.response.frequency[place]
        value = G.C[row] @ np.linalg.solve(s * np.eye(G.nstates) - G.A, G.B[:, column]) + G.D[row, column]
        # two ways through the same matrices: rounding times their condition
        assert curve.response.values[place] == pytest.approx(value, rel=1e-8)


def test_changed_axis_is_another_one() -> None:
    axis = fd.load("bench_axis")
    heavier = axis.with_values({"table.mass": "160 kg"})
    assert axis.plant.chain_values()["table_mass"] == 134.0
    assert heavier.modes().held[0, 0] < axis.modes().held[0, 0]
    run, other = (fd.run("step_position", plant=one, set={"trajectory.duration": "0.2 s"}) for one in (axis, heavier))
    assert run.result.scenario.digest != other.result.scenario.digest


def test_saved_axis_is_read_again(tmp_path: Path) -> None:
    worn = fd.load("bench_axis").with_effects(fd.effect("backlash", width="7.5 um"))
    again = fd.load(worn.save(tmp_path / "worn.toml"))
    assert again.plant.effects[-1].values == worn.plant.effects[-1].values
    with pytest.raises(fd.InputError, match="differ from the file"):
        worn.with_values({"table.mass": "160 kg"}).save(tmp_path / "other.toml")


def test_tables_to_pandas() -> None:
    pandas = pytest.importorskip("pandas", reason="pandas is an extra: pip install 'feeddrive[pandas]'")
    frame = fd.load("kimm_testbed").modes(["0 mm", "600 mm"]).to_pandas()
    assert isinstance(frame, pandas.DataFrame)
    assert list(frame["position [m]"]) == [0.0, 0.6]
