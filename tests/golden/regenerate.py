"""Writes the golden files: python -m tests.golden.regenerate."""

from __future__ import annotations

import contextlib
import io
import json
from pathlib import Path
from typing import Any

from feeddrive.cli.main import main
from feeddrive.files import write_text_atomically

OUTPUTS = {
    "show_bench_axis": ("show", "bench_axis", "--json"),
    "show_kimm_testbed": ("show", "kimm_testbed", "--json"),
    "modes_bench_axis": ("modes", "bench_axis", "--json"),
    "check_hsr_axis": ("check", "hsr_axis", "--json"),
    "reproduce": ("reproduce", "--json"),
}
"""Name of the file to what is typed."""

DIGITS = 7


def shown(name: str) -> Any:
    """What the program prints, without the version, numbers to seven digits; of the papers the counts alone.

    Every row of the papers has tests of its own in tests/literature.
    """
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        if main(list(OUTPUTS[name])) != 0:
            raise RuntimeError(f"feeddrive {' '.join(OUTPUTS[name])} failed")
    content = json.loads(said.getvalue())
    content.pop("version", None)
    if name == "reproduce":
        content = {"papers": content["papers"], "summary": content["summary"]}
    return _rounded(content)


def _rounded(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _rounded(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_rounded(one) for one in value]
    return float(f"{value:.{DIGITS}g}") if isinstance(value, float) else value


def write_all() -> None:
    """Write every file."""
    for name in OUTPUTS:
        text = json.dumps(shown(name), indent=1, ensure_ascii=False) + "\n"
        write_text_atomically(Path(__file__).resolve().parent / f"{name}.json", text)


if __name__ == "__main__":
    write_all()
