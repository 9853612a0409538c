"""Nothing that the tests plant can be reached from the package: no import, no path, no number of theirs."""

from __future__ import annotations

import ast
import tomllib
from collections.abc import Iterator
from pathlib import Path

import feeddrive
from tests.recovery.suite.planting import MACHINES, values_of, variants

PACKAGE = Path(feeddrive.__file__).resolve().parent
ROOT = Path(__file__).resolve().parents[2]

SOURCES = sorted(PACKAGE.rglob("*.py"))


def trees(folder: Path = PACKAGE) -> Iterator[tuple[Path, ast.Module]]:
    """Every file of the package, parsed."""
    for path in SOURCES:
        if path.is_relative_to(folder):
            yield path, ast.parse(path.read_text(encoding="utf-8"))


def imported(tree: ast.Module) -> Iterator[str]:
    """Modules that a file imports."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module or ""


def test_package_imports_nothing_of_the_tests() -> None:
    assert len(SOURCES) > 100
    found = {(path.name, name) for path, tree in trees() for name in imported(tree) if name.split(".")[0] == "tests"}
    assert found == set()


def test_package_names_no_path_of_the_tests() -> None:
    words = ("tests/", "tests.", "truth.toml", "sizes.json")
    found = {
        (path.name, node.value)
        for path, tree in trees()
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value.startswith(words)
    }
    assert found == set()


def test_package_holds_no_planted_number() -> None:
    """Numbers of three digits and more, which do not meet by chance as 0.1 or 6 do."""
    planted = {
        abs(float(value))
        for machine in MACHINES
        for examples in variants(machine).values()
        for effect in examples
        for value in values_of(effect).values()
        if not isinstance(value, str) and digits(float(value)) >= 3
    }
    assert planted
    found = {
        (path.name, node.value)
        for path, tree in trees(PACKAGE / "diagnosis")
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, float) and node.value in planted
    }
    assert found == set()


def digits(value: float) -> int:
    """Significant digits of a number as it is written."""
    return len(f"{abs(value):.12g}".split("e")[0].replace(".", "").strip("0"))


def test_tests_are_not_shipped() -> None:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    shipped = settings["tool"]["hatch"]["build"]["targets"]["wheel"]["include"]
    assert not [path for path in shipped if "tests" in path]
