"""A page in a headless browser: a script is put at its end, and what it finds is read back from the document."""

from __future__ import annotations

import html
import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

_NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
_LONGEST = 240.0
"""Seconds for a page; a browser starts in one, and in twenty on a machine that is busy with other tests."""


def found_in_page(page: str, script: str, folder: Path, width: int = 1400) -> Any:
    """What `script`, the body of a function, returns at the end of a page, as JSON.

    Skips the test where there is no browser.
    """
    browser = next((path for path in map(shutil.which, _NAMES) if path), None)
    if browser is None:
        pytest.skip(f"no headless browser: none of {', '.join(_NAMES)} is installed")
    asked = (
        '<pre id="found"></pre><script>{let r;try{r=(function(){SCRIPT})()}catch(e){r={error:String(e.stack||e)}}'
        'document.getElementById("found").textContent=JSON.stringify(r,(k,v)=>'
        "v instanceof Float64Array?Array.from(v):v)}</script></body>"
    ).replace("SCRIPT", script)
    path = folder / "page.html"
    path.write_text(page.replace("</body>", asked), encoding="utf-8")
    flags = ["--headless=new", "--no-sandbox", "--disable-gpu", f"--window-size={width},1200", "--no-first-run",
             f"--user-data-dir={folder / 'profile'}"]  # fmt: skip
    ran = subprocess.run([browser, *flags, "--dump-dom", path.as_uri()], capture_output=True, text=True, check=False,
                         timeout=_LONGEST)  # fmt: skip
    told = re.search(r'<pre id="found">(.*?)</pre>', ran.stdout, re.DOTALL)
    assert told is not None, f"the browser showed no page: {ran.stderr[-500:]}"
    found = json.loads(html.unescape(told[1]))
    assert not (isinstance(found, dict) and "error" in found), found
    return found
