"""What other versions, languages and table programs make of a trace file changes its letters and no number."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from feeddrive.recording.files.opening import first_bytes, open_file
from feeddrive.recording.traces.channel_choice import Wishes
from feeddrive.recording.traces.opened import Understood, could_be_trace, read_trace, understand
from feeddrive.recording.traces.trace import Trace
from tests.analytic import trace_files as made

WISHES = Wishes(sample_time=1e-3)


def understood(path: Path, text: str) -> Understood:
    path.write_bytes(text.encode())
    assert could_be_trace(first_bytes(path))
    found = read_trace(open_file(path), WISHES)
    assert isinstance(found, Trace)
    return understand(found, WISHES, str(path))


def _cells_quoted(text: str, separator: str) -> str:
    lines = text.split("\n")
    return "\n".join(separator.join(f'"{cell}"' for cell in line.split(separator)) if line else line for line in lines)


def _wider(text: str, separator: str) -> str:
    return "\n".join(line + 3 * separator if line else line for line in text.split("\n"))


def _twincat_comma() -> str:
    return made.twincat(",", ".")


VARIANTS: dict[str, tuple[str, Callable[[], str], Callable[[str], str]]] = {
    "TwinCAT, units in brackets": ("a.csv", made.twincat, lambda t: t.replace("mm (Length)", "[mm]")),
    "TwinCAT, quoted by a table program": ("a.csv", lambda: made.twincat(";", ","), lambda t: _cells_quoted(t, ";")),
    "TwinCAT, comma in a quoted name": (
        "a.csv", _twincat_comma, lambda t: t.replace("\nName,ActPos", '\nName,"ActPos, Axis 1"')),
    "TwinCAT, decimal commas between quotes": (
        "a.csv", _twincat_comma,
        lambda t: t[: t.index("\n0.0")] + re.sub(r"(-?\d+)\.(\d+(?:e-\d+)?)", r'"\1,\2"', t[t.index("\n0.0") :])),
    "TwinCAT, empty columns": ("a.csv", made.twincat, lambda t: _wider(t, "\t")),
    "TwinCAT, no line before the numbers": ("a.csv", made.twincat, lambda t: t.replace("\n\n0.0", "\n0.0")),
    "TNCscope, decimal comma": ("a.sco", made.tncscope, lambda t: re.sub(r"(?<=\d)\.(?=\d+e)", ",", t)),
    "TNCscope, units in brackets": (
        "a.sco", made.tncscope, lambda t: re.sub(r"%DIMENSION=(\S+)", r"%DIMENSION=[\1]", t)),
    "Operate, name space": (
        "a.xml", lambda: made.sinumerik_trace()[0],
        lambda t: t.replace("<traceSession ", '<traceSession xmlns="http://siemens.com/trace" ')),
    "Edge, in a list": ("a.json", made.edge_json, lambda t: json.dumps([json.loads(t)], indent=1)),
    "Edge table, row of units": (
        "a_hfdata.csv", made.edge_csv, lambda t: t.replace("\n0,", "\n,,mm,mm,A,Nm,mm/min\n0,", 1)),
    "Edge table, units in names": (
        "a_hfdata.csv", made.edge_csv, lambda t: t.replace("ENC_POS|1", "ENC_POS|1 [mm]").replace("T|1", "T|1 [A]")),
    "halscope, tabs": ("a.log", made.halscope_new, lambda t: t.replace(";", "\t")),
    "halscope, commas": ("a.log", made.halscope_new, lambda t: t.replace(";", ",")),
    "halsampler, capitals": ("a.txt", made.halsampler, lambda t: t.replace("overrun", "OVERRUN")),
}  # fmt: skip


@pytest.mark.parametrize("variant", VARIANTS)
def test_the_numbers_are_the_same(tmp_path: Path, variant: str) -> None:
    name, text, change = VARIANTS[variant]
    changed = change(text())
    assert changed != text()
    reference, found = understood(tmp_path / name, text()), understood(tmp_path / name, changed)
    for one, other in zip(reference.trace.signals, found.trace.signals, strict=True):
        np.testing.assert_array_equal(one.time, other.time)
        np.testing.assert_array_equal(one.values, other.values)
    assert reference.choice.blocking == found.choice.blocking
    assert reference.channels.keys() == found.channels.keys()
    for channel, samples in reference.channels.items():
        np.testing.assert_allclose(found.channels[channel], samples, rtol=1e-12, atol=1e-15)


def test_names_keep_the_separator_that_stands_in_quotes(tmp_path: Path) -> None:
    text = _twincat_comma().replace("\nName,ActPos", '\nName,"ActPos, Axis 1"')
    assert understood(tmp_path / "a.csv", text).trace.signals[0].name == "ActPos, Axis 1"


def test_units_of_a_table_are_those_of_its_file(tmp_path: Path) -> None:
    """A unit in brackets is the file's word: inches here, where a capture without units is in mm."""
    text = made.edge_csv().replace("ENC_POS|1", "ENC_POS|1 [in]").replace("DES_POS|1", "DES_POS|1 [in]")
    found, plain = understood(tmp_path / "b_hfdata.csv", text), understood(tmp_path / "a_hfdata.csv", made.edge_csv())
    np.testing.assert_allclose(found.channels["table_position"], 25.4 * plain.channels["table_position"], rtol=1e-12)
