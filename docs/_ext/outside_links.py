"""Links of a page to files that are no pages (plants, code) become their path in the source tree, as plain text.

The same pages are read in the source tree, where such a link leads somewhere, and on the site, where it does not.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

LINK = re.compile(r"(?<!!)\[([^\]\n]+)\]\((\.\./[^)#\s]+)(#[^)\s]*)?\)")


def _inside(app: Sphinx, docname: str, content: list[str]) -> None:
    source = Path(app.srcdir).resolve()
    folder = (source / docname).parent

    def plain(match: re.Match[str]) -> str:
        target = (folder / match[2]).resolve()
        if target.is_relative_to(source):
            return match[0]
        if not target.exists():
            raise FileNotFoundError(f"{docname}: {match[2]} does not exist")
        words = match[1].strip("`")
        path = target.relative_to(source.parent).as_posix()
        return f"`{path}`" if path.endswith(words.rstrip("/")) else f"{match[1]} (`{path}`)"

    content[0] = LINK.sub(plain, content[0])


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the change."""
    app.connect("source-read", _inside)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
