"""How the documentation is built: `make docs`. Nothing is fetched; what a page shows is computed while it is built."""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE / "_ext"), str(HERE.parent)]

import feeddrive  # noqa: E402  (found by the line above where it is not installed)

project = "feeddrive"
author = "feeddrive developers"
copyright = "feeddrive developers, MIT licence"
version = release = feeddrive.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "running_blocks",
    "outside_links",
    "written_pages",
]
exclude_patterns = ["_build", "_ext"]
language = "en"
nitpicky = True
nitpick_ignore_regex = [
    # Other projects' types: their documentation is not here, and nothing is fetched.
    (r"py:.*", r"(np|numpy|pandas|matplotlib|control|casadi|pathlib|collections|typing|optional|shape).*"),
    # Words of Python itself, and of the package what is not public.
    (r"py:.*", r"(Path|Any|Self|str|int|float|bool|bytes|None|set|dict|list|tuple|Sequence|Mapping|Iterable).*"),
    (r"py:.*", r"feeddrive\..*|[A-Z]\w+|ca\..*|n,|k,|SI"),
]
highlight_language = "none"
default_role = "code"  # single backticks of docstrings

myst_enable_extensions = ["colon_fence", "deflist", "attrs_inline"]
myst_heading_anchors = 3

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_default_options = {"members": True}
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_rtype = False

html_theme = "furo"
html_title = "feeddrive"
html_static_path = ["_static"]
html_css_files = ["pages.css"]
html_copy_source = False
html_show_sphinx = False
# Only its own fonts and scripts: the pages are read from a disk, too.
html_theme_options = {
    "navigation_with_keys": True,
    "light_css_variables": {"font-stack": "system-ui, 'DejaVu Sans', sans-serif", "color-brand-primary": "#1f5f8b"},
    "dark_css_variables": {"font-stack": "system-ui, 'DejaVu Sans', sans-serif"},
}
linkcheck_ignore = [r"https?://.*"]
