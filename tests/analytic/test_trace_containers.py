"""HDF5, MATLAB 7.3, TDMS, MDF and Parquet: written by the libraries of these formats, read, and damaged.

Each needs an optional library; the test is skipped where it is not installed. That the readers say so is tested always.
"""

from __future__ import annotations

import importlib
import importlib.util
import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from feeddrive.errors import InputError
from feeddrive.recording import read_recording
from feeddrive.recording.files.opening import open_file
from feeddrive.recording.traces.channel_choice import Wishes
from feeddrive.recording.traces.opened import Understood, read_trace, understand
from feeddrive.recording.traces.trace import Signal, Trace
from tests.analytic.trace_files import current, motion

TIME = np.arange(400) * 1e-3


def library(name: str) -> Any:
    """Import a library of a format, or skip."""
    return pytest.importorskip(name, reason=f"{name} is not installed; it is an optional extra")


def trace(path: Path, wishes: Wishes | None = None) -> Trace:
    """Read a trace file."""
    found = read_trace(open_file(path), wishes or Wishes())
    assert isinstance(found, Trace)
    return found


def by_name(found: Trace) -> dict[str, Signal]:
    """Signals by name."""
    return {signal.name: signal for signal in found.signals}


def understood(path: Path, wishes: Wishes | None = None) -> Understood:
    """Read a trace file and choose its channels."""
    return understand(trace(path, wishes), wishes or Wishes(), str(path))


def hdf5(path: Path) -> None:
    """Write an HDF5 file with a group, units as attributes, a text and a small matrix."""
    h5py = library("h5py")
    with h5py.File(path, "w") as file:
        axis = file.create_group("X")
        axis["time [s]"] = TIME
        axis["ActPos"] = motion(TIME)[0]
        axis["ActPos"].attrs["unit"] = "mm"
        axis.create_dataset("ActCurrent [A]", data=current(TIME), compression="gzip")
        axis["comment"] = "a text"
        axis["gain"] = 3.0


def matlab(path: Path) -> None:
    """Write a MATLAB 7.3 file as MATLAB does: a header of 512 bytes, then HDF5 with rows and columns turned."""
    h5py = library("h5py")
    with h5py.File(path, "w", userblock_size=512) as file:
        record = file.create_group("rec")
        record["t"] = TIME[None, :]
        record["position"] = motion(TIME)[0][None, :]
        record["both"] = np.vstack((current(TIME), TIME))
        file.create_group("#refs#")["a"] = TIME
    with path.open("r+b") as stream:
        stream.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64, HDF5 schema 1.00 .".ljust(124) + b"\x00\x02IM")


def tdms(path: Path) -> None:
    """Write a TDMS file with a clock in the properties of the waveforms."""
    nptdms = library("nptdms")
    clock = {"wf_increment": 1e-3, "wf_start_offset": 0.0, "wf_start_time": np.datetime64("2024-01-01T00:00:00")}
    channels = [nptdms.ChannelObject("Axis", "ActPos", motion(TIME)[0], properties={**clock, "unit_string": "mm"}),
                nptdms.ChannelObject("Axis", "ActCurrent", current(TIME), properties={**clock, "unit_string": "A"}),
                nptdms.ChannelObject("Axis", "Text", ["a", "b"])]  # fmt: skip
    with nptdms.TdmsWriter(path) as writer:
        writer.write_segment(channels)


def mdf(path: Path) -> None:
    """Write an MDF 4 file with two groups of different rates."""
    asammdf = library("asammdf")
    file = asammdf.MDF()
    file.append(
        [asammdf.Signal(motion(TIME)[0], TIME, "mm", "ActPos"), asammdf.Signal(current(TIME), TIME, "A", "ActCurrent")]
    )
    file.append([asammdf.Signal(20.0 + TIME[::10], TIME[::10], "degC", "nut_temperature")])
    file.save(path, overwrite=True)
    file.close()


def parquet(path: Path) -> None:
    """Write a Parquet table with units in brackets and a column of text."""
    pyarrow = library("pyarrow")
    library("pyarrow.parquet")
    table = pyarrow.table({"time [s]": TIME, "ActPos [mm]": motion(TIME)[0], "ActCurrent [A]": current(TIME),
                           "note": ["a"] * TIME.size})  # fmt: skip
    importlib.import_module("pyarrow.parquet").write_table(table, path)


FORMATS: dict[str, Callable[[Path], None]] = {
    "a.h5": hdf5,
    "b.mat": matlab,
    "c.tdms": tdms,
    "d.mf4": mdf,
    "e.parquet": parquet,
}


@pytest.mark.parametrize("name", [name for name in FORMATS if name != "b.mat"])
def test_channels_units_and_times(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    FORMATS[name](path)
    found = understood(path)
    assert {"table_position", "motor_current"} <= set(found.channels)
    assert np.array_equal(found.channels["table_position"], motion(TIME)[0] / 1e3)
    assert np.array_equal(found.channels["motor_current"], current(TIME))
    assert found.time == pytest.approx(TIME, abs=1e-12)
    recording = read_recording(path)
    assert np.array_equal(recording["motor_current"], current(TIME))


def test_matlab_7_3(tmp_path: Path) -> None:
    matlab(tmp_path / "b.mat")
    found = by_name(trace(tmp_path / "b.mat"))
    assert set(found) == {"rec.t", "rec.position", "rec.both column 1", "rec.both column 2"}
    assert set(
        understood(tmp_path / "b.mat", Wishes(channels={"table_position": ("rec.position", "mm")})).channels
    ) == {"table_position"}
    assert np.array_equal(found["rec.position"].time, TIME)
    assert np.array_equal(found["rec.both column 1"].values, current(TIME))
    mapping = tmp_path / "map.toml"
    for clock in ('variable = "rec.t"', 'variable = "rec.both"\ncolumn = 2'):
        mapping.write_text(f'format = "feeddrive-map/1"\n[time]\n{clock}\nunit = "s"\n'
                           '[channels.table_position]\nvariable = "rec.position"\nunit = "mm"\n')  # fmt: skip
        recording = read_recording(tmp_path / "b.mat", mapping)
        assert np.array_equal(recording["table_position"], motion(TIME)[0] / 1e3)
        assert np.array_equal(recording.time, TIME)


def test_rates_of_mdf_groups_are_their_own(tmp_path: Path) -> None:
    mdf(tmp_path / "d.mf4")
    found = by_name(trace(tmp_path / "d.mf4"))
    assert found["nut_temperature"].step == pytest.approx(0.01, rel=1e-12)
    assert understood(tmp_path / "d.mf4").channels["nut_temperature"].size < TIME.size + 1


def test_file_without_a_time_asks_for_it(tmp_path: Path) -> None:
    h5py = library("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["ActPos [mm]"] = motion(TIME)[0]
    with pytest.raises(InputError, match="holds no time; say the distance of its samples by --sample-time"):
        read_recording(tmp_path / "a.h5")
    assert understood(tmp_path / "a.h5", Wishes(sample_time=1e-3)).time == pytest.approx(TIME, abs=1e-12)


def test_links_out_of_an_hdf5_file_are_not_followed(tmp_path: Path) -> None:
    h5py = library("h5py")
    hdf5(tmp_path / "other.h5")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["t"] = TIME
        file["ActPos [mm]"] = motion(TIME)[0]
        file["outside"] = h5py.ExternalLink(str(tmp_path / "other.h5"), "X/ActPos")
        file["round"] = h5py.SoftLink("/")
    assert set(by_name(trace(tmp_path / "a.h5"))) == {"t", "ActPos [mm]"}


def test_hdf5_that_declares_more_than_it_holds_is_refused(tmp_path: Path) -> None:
    h5py = library("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_dataset("bomb", shape=(10**9,), dtype="f8", chunks=(10**6,), compression="gzip")
    with pytest.raises(InputError, match="declares 1000000000 values"):
        trace(tmp_path / "a.h5")


@pytest.mark.parametrize("name", FORMATS)
def test_damaged_files_are_told_in_one_line(tmp_path: Path, name: str, generator: np.random.Generator) -> None:
    path = tmp_path / name
    FORMATS[name](path)
    whole = path.read_bytes()
    for _ in range(4 if name == "d.mf4" else 20):  # its library loads anew each time
        data = bytearray(whole[: int(generator.integers(600, len(whole)))])
        for place in generator.integers(0, len(data), 5):
            data[place] = int(generator.integers(0, 256))
        path.write_bytes(data)
        try:
            read_recording(path)
        except InputError as error:
            assert "\n" not in str(error)


@pytest.mark.parametrize(
    ("data", "package"),
    [
        (b"\x89HDF\r\n\x1a\n" + bytes(600), "h5py"),
        (b"TDSm" + bytes(600), "npTDMS"),
        (b"MDF     4.10    " + bytes(600), "asammdf"),
        (b"PAR1" + bytes(600), "pyarrow"),
    ],
)
def test_library_that_is_not_installed_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, data: bytes, package: str
) -> None:
    def absent(name: str) -> Any:
        raise ImportError(name)

    monkeypatch.setattr(importlib, "import_module", absent)
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    (tmp_path / "a.bin").write_bytes(data)
    with pytest.raises(InputError, match=rf"read with {package}, which is not installed; pip install 'feeddrive\["):
        read_trace(open_file(tmp_path / "a.bin"), Wishes())


def test_bytes_that_only_begin_like_a_format(tmp_path: Path) -> None:
    buffer = io.BytesIO()
    buffer.write(b"TDSm")
    (tmp_path / "a.tdms").write_bytes(buffer.getvalue() + b"\xff" * 300)
    library("nptdms")
    with pytest.raises(InputError, match=r"is a damaged TDMS file|holds no numeric vector"):
        read_trace(open_file(tmp_path / "a.tdms"), Wishes())
