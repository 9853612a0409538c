"""Names that are meant to be obeyed: by a terminal, a C compiler, Python, an XML reader, a browser, Matplotlib."""

from __future__ import annotations

import io
import re
import subprocess
import zipfile
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest

from feeddrive.cli.main import main
from feeddrive.compiler import find_compiler
from feeddrive.export.c_source import header_text, source_text
from feeddrive.export.fmu_description import description_text
from feeddrive.export.linear_model import linear_model_of, python_text
from feeddrive.export.nonlinear_model import model_of
from feeddrive.export.point import Point
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.report.pages.html import report_page
from feeddrive.schema.toml_text import read_toml
from feeddrive.servo.mechanics_response import Case
from feeddrive.simulate.scenario.scenario_controller import read_controller
from feeddrive.tuning.demand import Demand
from feeddrive.tuning.reasons import controller_text
from feeddrive.tuning.recommendation import Recommendation, recommend
from tests.analytic import report_examples

BENCH = (plants_folder() / "bench_axis.toml").read_text(encoding="utf-8")
SCENARIO = (plants_folder().parent / "scenarios" / "step_position.toml").read_text(encoding="utf-8")

OBEYED = [
    "\x1b[31mred",
    "\x1b]0;title\x07",
    "\u202egnp.exe",
    "\u2066x",
    "a\x00b",
    "\x9b31m",
    "x\u2028y",
    "a\rb",
    "\x7f",
]

ALLOWED = [
    '*/ #include "x"', '"; system("x"); "', "<&>]]>", "??/", "a\\", "jac", "null", "x" * 300, "$\\frac{$", "%s%n{0}",
    "[red]x[/red]", "'''", "</title><script>alert(1)</script>", "日本", ":smile:", "-", "con", "1", "#", "//",
]  # fmt: skip


def _toml(text: str) -> str:
    return '"' + "".join(f"\\u{ord(one):04x}" if ord(one) < 0x10000 else one for one in text) + '"'


def _plant(folder: Path, name: str) -> str:
    path = folder / "machine.toml"
    path.write_text(BENCH.replace('name = "bench axis"', f"name = {_toml(name)}", 1), encoding="utf-8")
    return str(path)


@pytest.mark.parametrize("name", OBEYED, ids=ascii)
def test_name_that_a_terminal_obeys_is_refused(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", _plant(tmp_path, name)]) == 2
    shown = capsys.readouterr().err
    assert "machine.toml.name: holds" in shown
    assert shown.rstrip("\n").isprintable()


@pytest.mark.parametrize("key", ["source", "description"])
def test_other_texts_likewise(key: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "machine.toml"
    kept = re.sub(rf"^{key} = .*\n", "", BENCH, flags=re.MULTILINE)
    path.write_text(f'{key} = "\\u202ex"\n{kept}', encoding="utf-8")
    assert main(["show", str(path)]) == 2
    shown = capsys.readouterr().err
    assert f"{key}: holds" in shown
    assert shown.rstrip("\n").isprintable()


@pytest.mark.parametrize("name", OBEYED, ids=ascii)
def test_path_that_a_terminal_obeys(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / f"{name.replace(chr(0), '')}.toml"
    assert main(["show", str(path)]) == 2
    shown = capsys.readouterr().err
    assert shown.count("\n") == 1
    assert shown.rstrip("\n").isprintable()
    path.write_text(BENCH, encoding="utf-8")
    assert main(["modes", str(path), "--out", str(path.with_suffix(""))]) == 0
    shown = capsys.readouterr().out
    assert "written:" in shown
    assert shown.replace("\n", "").isprintable()


@pytest.mark.parametrize("name", ALLOWED, ids=ascii)
def test_every_form_of_a_machine_with_a_strange_name(name: str, tmp_path: Path) -> None:
    out = tmp_path / "out"
    forms = [word for form in ("ss", "mat", "json", "casadi", "c", "fmu") for word in ("--to", form)]
    assert main(["export", _plant(tmp_path, name), *forms, "--out", str(out)]) == 0
    module = next(out.glob("*_ss.py"))
    compile(module.read_text(encoding="utf-8"), str(module), "exec")
    with zipfile.ZipFile(next(out.glob("*.fmu"))) as archive:
        ElementTree.parse(io.BytesIO(archive.read("modelDescription.xml")))
    source = next(path for path in out.glob("*.c") if not path.stem.endswith("_selftest"))
    if find_compiler() is not None:
        command = [str(find_compiler()), "-std=c99", "-Wall", "-Wno-unused", "-fsyntax-only", source.name]
        done = subprocess.run(command, cwd=out, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("name", [*OBEYED, "x\nimport os; os._exit(3)", "*/\nint y;"], ids=ascii)
def test_machine_made_in_code_with_a_name_that_is_obeyed(name: str) -> None:
    """No file was read, so nothing has been refused: the generated texts show the letters as escapes."""
    plant = replace(read_plant(plants_folder() / "bench_axis.toml"), name=name)
    model, linear = model_of(plant, Point(0.1)), linear_model_of(plant, Point(0.1))
    texts = [
        header_text(model),
        source_text(model),
        description_text(model, "0" * 32, ("x.c",), 0),
        python_text(linear),
    ]
    for text in texts:
        assert text.replace("\n", "").replace("\t", "").isprintable()
    ElementTree.fromstring(texts[2])
    assert "import os; os._exit(3)\n" not in [line.lstrip() for line in texts[3].splitlines(keepends=True)]
    assert header_text(model).index("*/") > header_text(model).index("equations of motion")


@pytest.fixture(scope="module")
def recommended() -> Recommendation:
    plant = read_plant(plants_folder() / "bench_axis.toml")
    drive = read_controller(plants_folder().parent / "scenarios" / "step_position.toml", plant)
    return recommend(plant, drive, [Case(0.25)], Demand())


@pytest.mark.parametrize("name", ALLOWED, ids=ascii)
def test_controller_of_a_machine_with_a_strange_name_is_read_again(
    name: str, recommended: Recommendation, tmp_path: Path
) -> None:
    path = tmp_path / "controller.toml"
    path.write_text(controller_text(recommended, name), encoding="utf-8")
    assert read_toml(path, "controller file")["name"] == name


@pytest.mark.parametrize("name", ["$\\frac{$", "[red]x[/red]", "</title><script>", "%s%n{0}"], ids=ascii)
def test_run_of_a_scenario_with_a_strange_name(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "scenario.toml"
    text = SCENARIO.replace('name = "step of the position"', f"name = {_toml(name)}")
    path.write_text(text.replace("controllers/", f"{plants_folder().parent}/scenarios/controllers/"), encoding="utf-8")
    assert main(["run", str(path), "--out", str(tmp_path / "out")]) == 0
    assert name in capsys.readouterr().out


@pytest.mark.parametrize("name", [*ALLOWED, *OBEYED], ids=ascii)
def test_report_of_a_machine_with_a_strange_name(name: str) -> None:
    page = report_page(replace(report_examples.nothing_missing(2000), plant=name), ())
    assert "<script" not in page
    assert page.replace("\n", "").isprintable() or "\N{NO-BREAK SPACE}" in page
    assert not set(page) & set("\x1b\x07\u202e\u2066\x00\x9b\u2028\r\x7f")
