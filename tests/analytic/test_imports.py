"""The imports of the package run one way: no module is imported, over others, by what it imports itself."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import feeddrive

PACKAGE = Path(feeddrive.__file__).parent
MODULES = {
    ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__"): path
    for path in PACKAGE.rglob("*.py")
}


def run(node: ast.AST) -> Iterator[ast.AST]:
    """Every node below that can be run: all but what stands under `if TYPE_CHECKING`, which is read for types alone."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.If) and isinstance(child.test, ast.Name) and child.test.id == "TYPE_CHECKING":
            continue
        yield child
        yield from run(child)


def imported(source: str) -> set[str]:
    """Modules of the package that a source imports, inside functions too."""
    found = set()
    for node in run(ast.parse(source)):
        if isinstance(node, ast.ImportFrom) and node.module:
            found |= {f"{node.module}.{name.name}" for name in node.names} | {node.module}
        elif isinstance(node, ast.Import):
            found |= {name.name for name in node.names}
    return found & set(MODULES)


def graph() -> dict[str, set[str]]:
    """Module to what it imports; a package's own `__init__` brings nothing of its modules."""
    return {name: imported(path.read_text(encoding="utf-8")) - {name} for name, path in MODULES.items()}


def test_no_circle() -> None:
    assert len(MODULES) > 500
    try:
        TopologicalSorter(graph()).prepare()
    except CycleError as circle:
        pytest.fail(" imports ".join(reversed(circle.args[1])))


def test_a_circle_is_seen() -> None:
    source = "def f():\n    from feeddrive.plant import plant\nif TYPE_CHECKING:\n    import feeddrive.errors\n"
    assert imported(source) == {"feeddrive.plant", "feeddrive.plant.plant"}
    with pytest.raises(CycleError):
        TopologicalSorter({"a": {"b"}, "b": {"c"}, "c": {"a"}}).prepare()
