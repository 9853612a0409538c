"""What the blocks of a page do: Python runs in one namespace, commands in one folder, as their reader would type them.

A page is MyST. Three kinds of fenced blocks do something: `{run}` (Python) and `{terminal}` (lines that begin with
`feeddrive`) show their output below them, `{file} NAME` is written into the page's folder. The tests run them too.
"""

from __future__ import annotations

import ast
import contextlib
import hashlib
import io
import os
import pickle
import re
import shlex
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from matplotlib.figure import Figure

BLOCK = re.compile(
    r"^(```+)\{(run|terminal|file)\} *([^\n]*)\n(?::[\w-]+:[^\n]*\n)*(.*?)^\1\s*$", re.MULTILINE | re.DOTALL
)
DOTS_PER_INCH = 130
WIDTH = 80
"""Columns of the terminal whose output is shown: what a page of the site holds without scrolling."""


ROOT = Path(__file__).resolve().parents[2]


@cache
def digest() -> str:
    """Of the package, its machines and scenarios: what was kept from another state is made again."""
    found = hashlib.sha256()
    for folder in (ROOT / "feeddrive", ROOT / "plants", ROOT / "scenarios"):
        for path in sorted((*folder.rglob("*.py"), *folder.rglob("*.toml"))):
            found.update(path.read_bytes())
    return found.hexdigest()[:12]


@dataclass
class Shown:
    """What a block gave: text, and figures as PNG."""

    text: str = ""
    figures: list[bytes] = field(default_factory=list)


@dataclass
class PageRunner:
    """The namespace and the folder of one page, and how its output is shortened."""

    folder: Path
    names: dict[str, object] = field(default_factory=dict)

    def python(self, code: str, title: str) -> Shown:
        """Run a block; the value of its last line is shown as a prompt would show it."""
        tree = ast.parse(code, title)
        last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
        shown = Shown()
        with self._inside() as printed:
            exec(compile(tree, title, "exec"), self.names)
            if isinstance(last, ast.Expr):
                value = eval(compile(ast.Expression(last.value), title, "eval"), self.names)
                if isinstance(value, Figure):
                    shown.figures.append(_png(value))
                elif value is not None:
                    print(repr(value))
        shown.text = printed.getvalue()
        return shown

    def commands(self, text: str, title: str) -> Shown:
        """Run every line that begins with `feeddrive`; a status other than 0 is an error of the page."""
        from feeddrive.cli.main import main

        parts = []
        for line in text.replace("\\\n", " ").splitlines():
            words = shlex.split(line, comments=True)
            if not words:
                continue
            if words[0] != "feeddrive":
                raise ValueError(f"{title}: a terminal block holds feeddrive commands alone, not {line!r}")
            with self._inside() as printed, contextlib.redirect_stderr(io.StringIO()) as printed_errors:
                status = main(words[1:])
            if status != 0:
                raise RuntimeError(f"{title}: {line} ends with {status}: {printed_errors.getvalue()}")
            parts.append(f"$ {line}\n{printed.getvalue()}".replace(f"{self.folder}/", ""))
        return Shown("\n".join(parts))

    def block(self, kind: str, name: str, text: str, title: str) -> Shown:
        """Run one block of any kind; `name` is that of a file."""
        if kind == "file":
            (self.folder / name).write_text(text, encoding="utf-8")
            return Shown()
        return self.python(text, title) if kind == "run" else self.commands(text, title)

    @contextlib.contextmanager
    def _inside(self) -> Iterator[io.StringIO]:
        before, columns = Path.cwd(), os.environ.get("COLUMNS")
        os.environ["COLUMNS"] = str(WIDTH)
        os.chdir(self.folder)
        try:
            with contextlib.redirect_stdout(io.StringIO()) as printed:
                yield printed
        finally:
            os.chdir(before)
            os.environ.pop("COLUMNS") if columns is None else os.environ.update(COLUMNS=columns)


def _png(figure: Figure) -> bytes:
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=DOTS_PER_INCH)
    return stream.getvalue()


def run_page(text: str, title: str) -> list[Shown]:
    """Run every block of a page, in order, in a folder of its own, which goes when the page has ended."""
    with tempfile.TemporaryDirectory(prefix="feeddrive-page-") as folder:
        runner = PageRunner(Path(folder))
        return [
            runner.block(kind, name, body, f"{title}, block {number}")
            for number, (kind, name, body) in enumerate(blocks_of(text), 1)
        ]


def kept_page(text: str, title: str, folder: Path) -> list[Shown]:
    """The page's output; taken from a folder where the same blocks ran with the same package before."""
    key = hashlib.sha256(repr((digest(), blocks_of(text))).encode()).hexdigest()[:16]
    path = folder / f"{title.replace('/', '-')}.pickle"
    if path.is_file():
        known, shown = pickle.loads(path.read_bytes())
        if known == key:
            return list(shown)
    shown = run_page(text, title)
    folder.mkdir(parents=True, exist_ok=True)
    path.write_bytes(pickle.dumps((key, shown)))
    return shown


def blocks_of(text: str) -> list[tuple[str, str, str]]:
    """Kind, name of the file and text of every block of a page that does something, in order."""
    return [(kind, name.strip(), body.lstrip("\n")) for _, kind, name, body in BLOCK.findall(text)]
