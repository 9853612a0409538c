"""The directives `{run}`, `{terminal}` and `{file}`: a page's blocks run while it is built, the output stands below them."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from page_runner import Shown, kept_page
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
    }

    def run(self) -> list[nodes.Node]:
        """The nodes that stand in the page."""
        number, shown = self._next()
        code = "\n".join(self.content)
        found: list[nodes.Node] = []
        if self.name == "file":
            found.append(nodes.paragraph("", "", nodes.literal("", self.arguments[0]), nodes.Text(":")))
        if self.name in LANGUAGES:
            found.append(nodes.literal_block(code, code, language=LANGUAGES[self.name], classes=["typed"]))
        if shown.text.strip():
            found.append(nodes.literal_block("", self._cut(shown.text), language="none", classes=["shown"]))
        return [*found, *(self._figure(png, f"{number}-{i}") for i, png in enumerate(shown.figures, 1))]

    def _next(self) -> tuple[int, Shown]:
        """The output of this block; the first block of a page runs them all."""
        kept = self.env.temp_data
        if "blocks_shown" not in kept:
            page = Path(self.env.doc2path(self.env.docname))
            folder = Path(self.env.app.srcdir) / KEPT
            kept["blocks_shown"] = iter(enumerate(kept_page(page.read_text(encoding="utf-8"), self.env.docname, folder), 1))
        found: tuple[int, Shown] = next(kept["blocks_shown"])
        return found

    def _cut(self, text: str) -> str:
        lines = [line.rstrip() for line in text.strip("\n").splitlines()]
        most = self.options.get("lines", len(lines))
        return "\n".join([*lines[:most], *(["…"] if len(lines) > most else [])])

    def _figure(self, png: bytes, number: str) -> nodes.Node:
        name = f"{self.env.docname.replace('/', '-')}-{number}.png"
        folder = Path(self.env.app.srcdir) / DRAWN
        folder.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(png)
        caption = self.options.get("caption", "")
        figure = nodes.figure("", nodes.image(uri=f"/{DRAWN}/{name}", alt=caption or "figure of the lines above"))
        if caption:
            figure += nodes.caption(caption, caption)
        return figure


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the directives."""
    for name in ("run", "terminal", "file"):
        app.add_directive(name, BlockDirective)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
