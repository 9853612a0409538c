"""The README: says what the tool does and for whom, its commands exist, its links and figures lead somewhere."""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from typing import Any

import pytest

from feeddrive.cli.main import COMMANDS, load

ROOT = Path(__file__).resolve().parents[2]
README = ROOT / "README.md"

FIRST_LINES = 10

DOES = re.compile(r"\b(simulat|diagnos|find|found|identif|compar)\w*", re.IGNORECASE)
FOR_WHOM = re.compile(r"\b(engineer|builder|commission|tuning|drive|machine)\w*", re.IGNORECASE)

NO_COMMANDS = ("python", "toml", "json", "csv")

BLOCK = re.compile(r"^```(\w*)[^\n]*\n(.*?)^```", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(<?([^)\s>]+)")
SOURCE = re.compile(r"""(?:src|href)=["']([^"']+)["']""")


@pytest.fixture(scope="module")
def text() -> str:
    if not README.is_file():
        pytest.skip("README.md has not been written yet")
    return README.read_text(encoding="utf-8")


def test_first_lines_say_what_it_does_and_for_whom(text: str) -> None:
    lines = [line for line in text.splitlines()[:FIRST_LINES] if line.strip()]
    prose = " ".join(line for line in lines if not line.startswith(("#", "!", "[", "<", "```")))
    assert len(prose.split()) >= 15, "the first ten lines hold hardly any sentence"
    assert DOES.search(prose), "the first ten lines do not say what the tool does"
    assert FOR_WHOM.search(prose), "the first ten lines do not say for whom it is"


def test_every_command_exists_with_its_options(text: str) -> None:
    commands = typed_commands(text)
    if not commands:
        pytest.skip("README.md shows no `feeddrive ...` command in a code block yet")
    for words in commands:
        options = {word.split("=")[0] for word in words if word.startswith("-")}
        name = next((word for word in words[1:] if not word.startswith("-")), None)
        if name is None:
            assert options <= {"--help", "-h", "--version"}, " ".join(words)
            continue
        assert name in COMMANDS, f"README.md: {' '.join(words)}"
        known = {option for parameter in load(name).params for option in parameter.opts} | {"--help"}
        assert options <= known, f"README.md: {' '.join(words)}"


def typed_commands(text: str) -> list[list[str]]:
    """Words of every line in a code block that starts with `feeddrive`, a prompt before it left out."""
    blocks = [block for language, block in BLOCK.findall(text) if language.lower() not in NO_COMMANDS]
    indented = [line for line in BLOCK.sub("", text).splitlines() if line.startswith("    ")]
    lines = "\n".join([*blocks, *indented]).replace("\\\n", " ").splitlines()
    words = [line.strip().removeprefix("$").strip() for line in lines]
    return [shlex.split(line, comments=True) for line in words if line.startswith("feeddrive ")]


def test_every_relative_link_and_figure_exists(text: str) -> None:
    prose = BLOCK.sub("", text)
    targets = [target for pattern in (LINK, SOURCE) for target in pattern.findall(prose)]
    relative = [target for target in targets if not re.match(r"[a-z]+:|#", target)]
    absent = [target for target in relative if not (ROOT / target.split("#")[0]).exists()]
    assert absent == []


def test_the_python_of_the_readme_runs(text: str) -> None:
    """A reader pastes it first; it ends in a diagnosis that finds nothing, as nothing was planted."""
    (block,) = re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    names: dict[str, Any] = {}
    exec(compile(block, "README.md", "exec"), names)
    assert list(names["found"].effects) == []
