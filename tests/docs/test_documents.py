"""The documents name tests, scripts, plants and commands that exist; the tutorial of the real drive runs."""

from __future__ import annotations

import os
import re
import shlex
from pathlib import Path

import pytest

from feeddrive.cli.main import COMMANDS, load, main

ROOT = Path(__file__).resolve().parents[2]
DOCUMENTS = [path for path in sorted((ROOT / "docs").rglob("*.md")) if not {"_build", "generated"} & set(path.parts)]


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_links_and_files_exist(document: Path) -> None:
    text = document.read_text(encoding="utf-8")
    for link in re.findall(r"\]\((?!https?:)([^)#\s]+)", text):
        # those that the site is built with are checked by its build
        assert "generated/" in link or (document.parent / link).exists(), link
    for path in re.findall(r"`((?:tests|benchmarks|plants|scenarios)/[\w./-]+)`", text):
        assert (ROOT / path).exists(), path


def test_contributing_names_what_exists() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    named = re.findall(r"`((?:feeddrive|tests|benchmarks|plants|scenarios|docs|\.ci)/[\w./-]*)`", text)
    assert len(named) >= 10
    assert [path for path in named if not (ROOT / path).exists() and path != "feeddrive/library/"] == []
    makefile = "\n" + (ROOT / "Makefile").read_text(encoding="utf-8")
    for typed in re.findall(r"(?:^    |`)make ([^#`&\n]+)", text, re.MULTILINE):
        for word in typed.split():
            name, _, value = word.partition("=")
            assert (f"\n{name}:" in makefile) if not value else (f"\n{name} " in makefile), typed
            assert not value.startswith("tests/") or (ROOT / value).exists(), typed
    for folder in re.findall(r"^\| `([a-z]+/)` \|", text, re.MULTILINE):
        assert (ROOT / folder).exists() or (ROOT / "tests" / folder).exists(), folder


def test_imports_run_the_one_way_that_is_said() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    chain = re.search(r"^    (\w+ →[^\n]*(?:\n    [^\n]*)*)", text, re.MULTILINE)
    assert chain is not None
    order = re.findall(r"\w+", chain[1])
    assert len(order) >= 14
    wrong = []
    for number, folder in enumerate(order):
        path = ROOT / "feeddrive" / folder
        files = sorted(path.rglob("*.py")) if path.is_dir() else [path.with_suffix(".py")]
        for file in files:
            imported = re.findall(
                r"^\s*(?:from|import) feeddrive\.(\w+)", file.read_text(encoding="utf-8"), re.MULTILINE
            )
            wrong += [f"{file.name}: {name}" for name in imported if name in order[number + 1 :]]
    assert wrong == []


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_commands_exist_with_their_options(document: Path) -> None:
    text = document.read_text(encoding="utf-8")
    lines = re.findall(r"^    (feeddrive .*)$|`(feeddrive [a-z][^`]*)`", text, re.MULTILINE)
    for line in (first or second for first, second in lines):
        words = shlex.split(line)
        assert words[1] in COMMANDS, line
        known = {option for parameter in load(words[1]).params for option in parameter.opts}
        assert {word.split("=")[0] for word in words if word.startswith("--")} <= known | {"--help"}, line


@pytest.mark.slow
def test_tutorial_of_the_real_drive_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data = Path(os.environ.get("FEEDDRIVE_EMPS", ROOT.parent / "shared" / "data" / "emps" / "DATA_EMPS.mat"))
    if not data.is_file():
        pytest.skip("DATA_EMPS.mat is not here; name it in FEEDDRIVE_EMPS")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "DATA_EMPS.mat").write_bytes(data.read_bytes())
    (tmp_path / "plants").symlink_to(ROOT / "plants")
    text = (ROOT / "docs" / "tutorial_real_drive.md").read_text(encoding="utf-8")
    typed = [shlex.split(line) for line in re.findall(r"^    feeddrive (.*)$", text, re.MULTILINE)]
    assert len(typed) >= 4
    for words in typed:
        if "--continue" not in words:  # needs a recording of another day
            assert main(words) == 0, words
    assert (tmp_path / "emps_report" / "report.html").is_file()
