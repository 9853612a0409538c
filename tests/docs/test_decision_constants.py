"""Every constant that decides a name stands in the method's table; every number compared against has its reason."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DIAGNOSIS = ROOT / "feeddrive" / "diagnosis"
METHOD = ROOT / "docs" / "method.md"

DECIDING = ("finding/", "judging/effect", "judging/judge", "judging/veto",
            "judging/physical_reading", "calibration/", "certainty/ambiguity", "certainty/inclusion",
            "certainty/uncertainty", "likelihood/set_evidence", "likelihood/standing", "likelihood/cross_validation",
            "likelihood/predictor")  # fmt: skip
"""Rooms and files that decide which names are found; the others prepare recordings, read starts, or word the rest."""

Place = tuple[str, str]


def constants() -> dict[Place, bool]:
    """File and name of every constant of the package's diagnosis, and whether a reason stands below or behind it."""
    found: dict[Place, bool] = {}
    for path, tree in trees():
        for number, node in enumerate(tree.body):
            if not isinstance(node, ast.Assign) or not _holds_number(node.value):
                continue
            rest = tree.body[number + 1 : number + 2]
            below = bool(rest) and isinstance(rest[0], ast.Expr) and isinstance(rest[0].value, ast.Constant)
            line = (DIAGNOSIS / path).read_text(encoding="utf-8").splitlines()[node.end_lineno - 1]  # type: ignore[operator]
            told = below or "#" in line
            for target in node.targets:
                for one in target.elts if isinstance(target, ast.Tuple) else [target]:
                    if isinstance(one, ast.Name) and re.fullmatch("_?[A-Z][A-Z0-9_]+", one.id):
                        found[path, one.id] = told
    return found


def compared() -> set[Place]:
    """Those of the constants that something is compared with."""
    known = constants()
    found = set()
    for path, tree in trees():
        taken = {
            alias.asname or alias.name: (_path(node.module), alias.name)
            for node in ast.walk(tree)
            if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("feeddrive.diagnosis.")
            for alias in node.names
        }
        for node in ast.walk(tree):
            if isinstance(node, ast.Compare):
                names = [one.id for one in ast.walk(node) if isinstance(one, ast.Name)]
                places = [(path, name) if (path, name) in known else taken.get(name) for name in names]
                found |= {place for place in places if place in known}
    return found


def trees() -> Iterator[tuple[str, ast.Module]]:
    """Every file of the package's diagnosis, its path in it and its syntax."""
    for path in sorted(DIAGNOSIS.rglob("*.py")):
        yield path.relative_to(DIAGNOSIS).as_posix(), ast.parse(path.read_text(encoding="utf-8"))


def _path(module: str) -> str:
    return module.removeprefix("feeddrive.diagnosis.").replace(".", "/") + ".py"


def _holds_number(value: ast.expr) -> bool:
    if isinstance(value, ast.Dict | ast.Set | ast.List):
        return False
    numbers = (one.value for one in ast.walk(value) if isinstance(one, ast.Constant))
    return any(isinstance(number, int | float) and not isinstance(number, bool) for number in numbers)


def test_every_constant_that_decides_stands_in_the_table() -> None:
    table = METHOD.read_text(encoding="utf-8").split("## 9. Constants that decide")[1]
    listed = set(re.findall(r"`([A-Z_]+)`", table))
    deciding = {name for path, name in compared() if path.startswith(DECIDING)}
    assert deciding, "no constant was found: the rooms have other names"
    assert deciding - listed == set()
    assert listed <= {name for _, name in constants()}, "the table holds a constant that no longer exists"


def test_every_number_compared_against_has_its_reason_beside_it() -> None:
    known = constants()
    assert sorted(place for place in compared() if not known[place]) == []
