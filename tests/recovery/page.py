"""A page that several suites write, each its own section between marks: `<!-- name -->` to `<!-- end of name -->`."""

from __future__ import annotations

import re

_SECTION = re.compile(r"<!-- (\w+) -->\n.*?<!-- end of \1 -->", re.DOTALL)


def with_section(text: str, section: str) -> str:
    """The page with a section in place of the one of that name, or at its end."""
    own = _SECTION.match(section)
    assert own is not None, "a section begins and ends with its marks"
    for there in _SECTION.finditer(text):
        if there.group(1) == own.group(1):
            return text[: there.start()] + section.rstrip() + text[there.end() :]
    return text.rstrip() + "\n\n" + section


def with_sections_of(text: str, before: str) -> str:
    """A page written anew, with the sections that others had put into it before."""
    for section in _SECTION.finditer(before):
        text = with_section(text, section.group() + "\n")
    return text
