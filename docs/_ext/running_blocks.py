"""The directives `{run}`, `{terminal}`, `{file}`: blocks run while a page is built, the output stands below them."""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from page_runner import WIDTH, Shown, kept_page
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

KEPT, DRAWN = "generated/kept", "generated/drawn"
LANGUAGES = {"run": "python", "file": "toml"}


class BlockDirective(SphinxDirective):
    """One block: what is typed, what it prints, its figures."""

    has_content = True
    optional_arguments = 1
    final_argument_whitespace = True
    option_spec: ClassVar[dict[str, Any]] = {
        "caption": directives.unchanged,
        "lines": directives.nonnegative_int,
        # the lines stand folded below their figure, where the figure is what matters
        "below": directives.flag,
    }

    def run(self) -> list[nodes.Node]:
        """The nodes that stand in the page."""
        number, shown = self._next()
        code = "\n".join(self.content)
        found: list[nodes.Node] = []
        if self.name == "file":
            found.append(nodes.paragraph("", "", nodes.literal("", self.arguments[0]), nodes.Text(":")))
        typed = []
        if self.name in LANGUAGES:
            typed.append(nodes.literal_block(code, code, language=LANGUAGES[self.name], classes=["typed"]))
        found += [] if "below" in self.options else typed
        if shown.text.strip():
            found.append(nodes.literal_block("", self._cut(shown.text), language="none", classes=["shown"]))
        found += [self._figure(png, f"{number}-{i}") for i, png in enumerate(shown.figures, 1)]
        return [*found, *(_folded(typed) if "below" in self.options else [])]

    def _next(self) -> tuple[int, Shown]:
        """The output of this block; the first block of a page runs them all."""
        kept = self.env.temp_data
        if "blocks_shown" not in kept:
            page = Path(self.env.doc2path(self.env.docname))
            folder = Path(self.env.srcdir) / KEPT
            kept["blocks_shown"] = iter(
                enumerate(kept_page(page.read_text(encoding="utf-8"), self.env.docname, folder), 1)
            )
        found: tuple[int, Shown] = next(kept["blocks_shown"])
        return found

    def _cut(self, text: str) -> str:
        lines = [part for line in text.strip("\n").splitlines() for part in _wrapped(line.rstrip())]
        most = self.options.get("lines", len(lines))
        return "\n".join([*lines[:most], *(["…"] if len(lines) > most else [])])

    def _figure(self, png: bytes, number: str) -> nodes.Node:
        name = f"{self.env.docname.replace('/', '-')}-{number}.png"
        folder = Path(self.env.srcdir) / DRAWN
        folder.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(png)
        caption = self.options.get("caption", "")
        figure = nodes.figure("", nodes.image(uri=f"/{DRAWN}/{name}", alt=caption or "figure of the lines above"))
        if caption:
            figure += nodes.caption(caption, caption)
        return figure


def _wrapped(line: str) -> list[str]:
    """A sentence in lines of the width of a terminal; rows of a table stay as they are."""
    if len(line) <= WIDTH or "  " in line.strip() or not line[:1].isalpha():
        return [line]
    return textwrap.wrap(line, WIDTH, break_long_words=False, break_on_hyphens=False)


def _folded(typed: list[nodes.literal_block]) -> list[nodes.Node]:
    opened = nodes.raw("", "<details><summary>The lines that made it</summary>", format="html")
    return [opened, *typed, nodes.raw("", "</details>", format="html")]


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the directives."""
    for name in ("run", "terminal", "file"):
        app.add_directive(name, BlockDirective)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
