"""The page on trace files: its commands run, and what it says of them is so."""

from __future__ import annotations

import gzip
import json
import re
import shlex
from pathlib import Path

import pytest

from feeddrive.cli.main import main
from tests.analytic import trace_files as made

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "trace_files.md"


def test_commands_of_the_page_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("capture.json").write_text(made.edge_json())
    Path("scope.log").write_text(made.halscope_new())
    sample = ROOT / "tests" / "data" / "traces" / "sinumerik_frf" / "freq_trace.xml.gz"
    Path("freq_trace.xml").write_bytes(gzip.decompress(sample.read_bytes()))
    typed = [shlex.split(line) for line in re.findall(r"^    feeddrive (.*)$", PAGE.read_text(encoding="utf-8"), re.M)]
    assert len(typed) == 5
    for words in typed:
        assert main(words) == 0, words
        out = capsys.readouterr().out
        if "--json" in words:
            assert json.loads(out)["recording"]["samples"] == 600
        if "scope.log" in words:
            assert "K_v 49.99 1/s" in out  # set-points lead by speed / 50 in the made file
    assert {path.name for path in tmp_path.iterdir()} >= {"rec.csv.gz", "rec_map.toml", "response.csv", "response.png"}


def test_every_format_of_the_page_has_its_reader() -> None:
    rows = re.findall(r"^\| (.+?) \|", PAGE.read_text(encoding="utf-8").split("## Formats")[1].split("\n\n")[1], re.M)
    named = {"TwinCAT": "twincat", "TNCscope": "tncscope", "Operate": "sinumerik_trace", "Edge": "sinumerik_edge",
             "frequency": "sinumerik_frf", "halscope": "halscope", "halsampler": "halscope", "HDF5": "hdf5_file",
             "TDMS": "tdms", "MDF": "mdf4", "Parquet": "parquet"}  # fmt: skip
    folder = ROOT / "feeddrive" / "recording" / "formats"
    for key, module in named.items():
        assert any(key in row for row in rows), key
        assert (folder / f"{module}.py").exists()
    assert len(rows) == len(named) + 1  # and the heading
