"""What a trace file says is what is read: every layout, every variant, every trap of it."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest

from feeddrive.errors import InputError
from feeddrive.recording import read_recording
from feeddrive.recording.files.opening import open_file
from feeddrive.recording.frequency_response import FrequencyResponse, write_response
from feeddrive.recording.traces.channel_choice import Wishes
from feeddrive.recording.traces.opened import Understood, columns_of, read_trace, understand
from feeddrive.recording.traces.trace import Signal, Trace
from tests.analytic import trace_files as made

SAMPLES = Path(__file__).parents[1] / "data" / "traces"
MM = 1e-3


def trace(path: Path, wishes: Wishes | None = None) -> Trace:
    """Read a trace file."""
    found = read_trace(open_file(path), wishes or Wishes())
    assert isinstance(found, Trace)
    return found


def written(tmp_path: Path, text: str, name: str = "trace.txt", encoding: str = "utf-8") -> Path:
    """Write a text as it is, with its line ends."""
    path = tmp_path / name
    path.write_bytes(text.encode(encoding))
    return path


def signals(found: Trace) -> dict[str, Signal]:
    """Signals by name."""
    return {signal.name: signal for signal in found.signals}


def understood(path: Path, wishes: Wishes | None = None) -> Understood:
    """Read a trace file and choose its channels."""
    return understand(trace(path, wishes), wishes or Wishes(), str(path))


def same(first: Signal, second: Signal) -> bool:
    """To the last digit."""
    return np.array_equal(first.time, second.time) and np.array_equal(first.values, second.values)


# TwinCAT ------------------------------------------------------------------------------------------------------------


def test_all_variants_of_one_twincat_export_are_the_same(shared_data: Path) -> None:
    files = sorted((shared_data / "traces" / "twincat").glob("*.csv.gz"))
    assert len(files) == 10
    reference = signals(trace(files[0]))
    for path in files[1:]:
        found = signals(trace(path))
        assert set(reference) - set(found) <= {"func_OS", "func_freesample"}, path.name  # noOS was exported without
        for name, signal in found.items():
            assert same(signal, reference[name]), (path.name, name)
            assert signal.unit == reference[name].unit


def test_twincat_values_are_those_of_the_file() -> None:
    found = signals(trace(SAMPLES / "twincat" / "Seperator_4.csv.gz"))
    # The export counts in every channel; the header scales some: offset 1 and factor -1, unit offset 10 and factor -10.
    assert found["var_REAL64"].values[:4].tolist() == [0.0, 1.0, 2.0, 3.0]
    assert found["func_scaled"].values[:3].tolist() == [1.0, 0.0, -1.0]
    assert found["func_units_scaled"].values[:3].tolist() == [10.0, 0.0, -10.0]
    assert found["func_units_scaled"].unit == "dV"
    assert found["func_OS"].time[:3].tolist() == [0.0, 0.2e-3, 0.4e-3]
    assert found["func_freesample"].time[:2].tolist() == [-3e-3, 2e-3]
    assert found["func_freesample"].values.tolist()[:2] == [997.0, 2.0]


def test_scaling_that_an_export_left_out_is_found_by_channels_of_one_symbol() -> None:
    found = trace(SAMPLES / "twincat" / "default.csv.gz")
    assert signals(found)["func_scaled"].values[:3].tolist() == [1.0, 0.0, -1.0]
    assert any("exported without scaling" in note for note in found.notes)


def test_words_of_names_between_blanks_are_put_together() -> None:
    found = trace(SAMPLES / "twincat" / "Seperator_1.csv.gz")
    assert {"test space", "test space (1)"} <= set(signals(found))
    assert any('"test space"' in note for note in found.notes)


def test_names_between_blanks_that_cannot_be_told_are_refused(tmp_path: Path) -> None:
    text = made.twincat(" ").replace("ActPos ActVelo", "Act Pos ActVelo", 1).replace("Axes.Axis 1.", "Axes.1.")
    text = text.replace("SymbolName Axes.1.ActPos Axes.1.ActVelo Axes.1.ActCurrent", "SymbolName A.a A.b A.c")
    with pytest.raises(InputError, match="4 words make 3 names"):
        trace(written(tmp_path, text))


@pytest.mark.parametrize("separator", ["\t", " ", ":", ";"])
@pytest.mark.parametrize("decimal", [".", ","])
def test_separators_and_decimal_signs(tmp_path: Path, separator: str, decimal: str) -> None:
    text = made.twincat(separator, decimal)
    text = text.replace("Axes.Axis 1.", "Axes.Axis1.") if separator == " " else text
    found = signals(trace(written(tmp_path, text)))
    reference = signals(trace(written(tmp_path, made.twincat(), "other.csv")))
    assert all(same(found[name], reference[name]) for name in reference)


def test_comma_as_separator_and_decimal_sign_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"row 18: the row has \d+ cells, the header names 6 columns"):
        trace(written(tmp_path, made.twincat(",", ",")))


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace("\n", "\r\n"),
        lambda text: "\ufeff" + text,
        lambda text: text + "EOF\n",
        lambda text: text.replace(
            "SymbolComment\t\t\t\tSymbolComment\t", "SymbolComment\t\t\t\tSymbolComment\tSymbolComment"
        ),
        lambda text: "\n".join(line + "\t" if line else line for line in text.split("\n")),
    ],
    ids=["CRLF", "BOM", "EOF", "a cell too many in SymbolComment", "separator at the end of each line"],
)
def test_what_real_exports_differ_in(tmp_path: Path, change: object) -> None:
    reference = signals(trace(written(tmp_path, made.twincat(), "other.csv")))
    found = signals(trace(written(tmp_path, change(made.twincat()))))  # type: ignore[operator]
    assert all(same(found[name], reference[name]) for name in reference)


@pytest.mark.parametrize("kept", [("Name", "Unit"), ("Name", "SampleTime[ms]", "Port"), ("Name",)])
def test_header_with_few_rows_and_an_empty_line_more(tmp_path: Path, kept: tuple[str, ...]) -> None:
    lines = made.twincat().split("\n")
    top = lines.index("", 5) + 1
    end = lines.index("", top)
    header = [line for line in lines[top:end] if line.split("\t")[0] in kept]
    text = "\n".join([*lines[:top], *header, "", *lines[end:]])
    found = signals(trace(written(tmp_path, text)))
    reference = signals(trace(written(tmp_path, made.twincat(), "other.csv")))
    assert all(same(found[name], reference[name]) for name in reference)


def test_header_without_any_row_of_channels_is_refused(tmp_path: Path) -> None:
    lines = made.twincat(" ").split("\n")
    kept = [
        line
        for line in lines
        if line.split(" ")[0] in ("Name", "File", "Starttime", "Endtime") or not line[:1].isalpha()
    ]
    with pytest.raises(InputError, match="the rows that tell the channels are missing"):
        trace(written(tmp_path, "\n".join(kept)))


def test_utf_16(tmp_path: Path) -> None:
    found = signals(trace(written(tmp_path, made.twincat(), encoding="utf-16")))
    assert found["ActPos"].values.size == 400


def test_full_time_stamps(tmp_path: Path) -> None:
    start = 132959733843760000  # 100 ns since 1601, as in the header
    lines = made.twincat().split("\n")
    body = lines.index("", 7) + 1
    for i, line in enumerate(lines[body:-1], start=body):
        cells = line.split("\t")
        for column in (0, 4)[: 1 + (len(cells) > 4)]:
            cells[column] = str(start + round(float(cells[column]) * 10_000))
        lines[i] = "\t".join(cells)
    found = signals(trace(written(tmp_path, "\n".join(lines))))
    # A double holds such stamps to 16 units of 100 ns.
    assert found["ActPos"].time == pytest.approx(np.arange(400) * 1e-3, abs=1.6e-6)


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("\t20.5\n4.0", "\t\n4.0", "a cell is empty between filled ones"),
        ("\n8.0\t", "\n8.0x\t", '"8.0x" is not a number'),
        ("\n8.0\t", "\n3.0\t", "the time does not increase"),
        ("Name\tActPos\tActVelo", "Name\tActPos", "the names do not fit"),
    ],
)
def test_damage_of_an_export_is_told_by_its_row(tmp_path: Path, old: str, new: str, what: str) -> None:
    text = made.twincat()
    assert old in text or old == "\t20.5\n4.0"
    text = text.replace(old, new, 1) if old in text else text.replace("\t20.5\n", "\t\n", 1)
    with pytest.raises(InputError, match=what):
        trace(written(tmp_path, text))


def test_group_that_ended_does_not_return(tmp_path: Path) -> None:
    lines = made.twincat().split("\n")
    body = lines.index("", 7) + 1
    lines[body + 5] = "\t".join(lines[body + 5].split("\t")[:4])  # the slow channel is missing once
    with pytest.raises(InputError, match="a cell is empty between filled ones"):
        trace(written(tmp_path, "\n".join(lines)))


def test_last_row_that_was_cut_short_is_left_out(tmp_path: Path) -> None:
    text = made.twincat()
    found = trace(written(tmp_path, text[: text.rindex("\t")]))
    assert signals(found)["ActPos"].values.size == 399
    assert any("cut short and left out" in note for note in found.notes)


# TNCscope -----------------------------------------------------------------------------------------------------------


def test_tncscope(tmp_path: Path) -> None:
    found = trace(written(tmp_path, made.tncscope(), "a.sco"))
    by_name = signals(found)
    assert list(by_name) == ["s ist/Y", "s soll/Y", "v ist/Y", "I ist/Y"]
    assert [signal.unit for signal in found.signals] == ["mm", "mm", "mm/min", "Ampere"]
    assert by_name["s ist/Y"].axis == "Y"
    time = np.arange(600) * 3e-3
    # Ten digits stand in the file.
    assert by_name["s ist/Y"].values == pytest.approx(made.motion(time)[0], rel=1e-9, abs=1e-9)


def test_time_of_tncscope_comes_from_its_column_and_not_from_cycletime(tmp_path: Path) -> None:
    found = trace(written(tmp_path, made.tncscope(), "a.sco"))
    assert signals(found)["I ist/Y"].time == pytest.approx(np.arange(600) * 3e-3, abs=1e-12)
    assert any("every 100 µs and stands in rows every 3000 µs" in note for note in found.notes)


def test_columns_of_tncscope_are_those_that_its_header_names(tmp_path: Path) -> None:
    plain = signals(trace(written(tmp_path, made.tncscope(), "a.sco")))
    swapped = signals(trace(written(tmp_path, made.tncscope(swapped=True), "b.sco")))
    assert all(np.array_equal(plain[name].values, swapped[name].values) for name in plain)


def test_debug_channels_of_tncscope_are_known_by_their_number(tmp_path: Path) -> None:
    text = made.tncscope().replace("%NAME=I ist/Y\r\n%CHANNELTYPE=I ist", "%NAME=DSP-Debug/Y\r\n%CHANNELTYPE=DSP-Debug")
    found = understood(written(tmp_path, text.replace("%DIMENSION=Ampere", "%DIMENSION=id(10)"), "a.sco"))
    assert "motor_current" in found.channels
    assert any("debug channel id(10)" in note for note in found.notes)


def test_english_names_of_tncscope(tmp_path: Path) -> None:
    text = made.tncscope().replace(" ist", " actual").replace(" soll", " nominal")
    found = understood(written(tmp_path, text, "a.sco"))
    assert set(found.channels) == {"table_position", "setpoint", "table_velocity", "motor_current"}


def test_current_without_a_sign_is_no_torque(tmp_path: Path) -> None:
    found = understood(written(tmp_path, made.tncscope(magnitude=True), "a.sco"))
    assert "motor_current" not in found.channels
    assert any("it is a magnitude and is not used as torque" in note for note in found.notes)
    assert "motor_current" in understood(written(tmp_path, made.tncscope(), "b.sco")).channels


# SINUMERIK Operate --------------------------------------------------------------------------------------------------


def test_values_of_a_sinumerik_trace_are_held_on_the_grid_of_each_signal(tmp_path: Path) -> None:
    text, series = made.sinumerik_trace()
    found = trace(written(tmp_path, text, "a.xml"))
    by_key = dict(zip(("f1", "f2", "f3"), found.signals, strict=True))
    for key, signal in by_key.items():
        assert np.array_equal(signal.values, series[key]), key
    assert by_key["f1"].time[:3].tolist() == [0.0, 0.002, 0.004]
    assert by_key["f2"].time[:3].tolist() == [0.002, 0.006, 0.010]  # the IPO cycle lies at odd multiples of 2 ms
    assert any("did not change, and are held" in note for note in found.notes)
    assert {signal.axis for signal in found.signals} == {"7"}


def test_drop_outs_and_missing_points_of_a_sinumerik_trace_are_said(tmp_path: Path) -> None:
    text, _ = made.sinumerik_trace(dropouts=3)
    found = trace(written(tmp_path, text.replace('datapointCount="1000"', 'datapointCount="1200"', 1), "a.xml"))
    assert any("3 drop-outs" in note for note in found.notes)
    assert any("declares 1200 points, the file gives 1000" in note for note in found.notes)


def test_values_that_were_not_there_yet(tmp_path: Path) -> None:
    """The control writes the bits of a double that is no number as a whole number."""
    text, series = made.sinumerik_trace()
    first = text.index('f3="')
    end = text.index('"', first + 4)
    found = trace(written(tmp_path, text[:first] + 'f3="9221120237041090560.000000' + text[end:], "a.xml"))
    velocity = found.signals[2]
    later = np.flatnonzero(series["f3"] != series["f3"][0])[0]
    assert velocity.time[0] == pytest.approx(0.002 * later, abs=1e-12)
    assert np.array_equal(velocity.values, series["f3"][later:])


def test_attributes_of_a_record_that_are_no_signals(tmp_path: Path) -> None:
    text, series = made.sinumerik_trace()
    found = trace(written(tmp_path, text.replace("<rec ", '<rec event="1" '), "a.xml"))
    assert np.array_equal(found.signals[0].values, series["f1"])


def test_signal_that_lies_on_no_grid_is_left_out_and_said(tmp_path: Path) -> None:
    text, series = made.sinumerik_trace()
    extra = (
        '<dataSignal id="f9" interval="0.004" datapointCount="3" name="M1.0" unitsType="none"/>\n<dataSignal id="f1"'
    )
    text = text.replace('<dataSignal id="f1"', extra, 1).replace(
        '<rec time="0.002000"', '<rec time="0.002000" f9="1"', 1
    )
    finer = trace(written(tmp_path, text.replace('<rec time="0.008000"', '<rec time="0.008000" f9="0"', 1), "a.xml"))
    assert signals(finer)["M1.0"].step == pytest.approx(0.002, rel=1e-12)
    assert any("lie on a grid of 2 ms, not of 4 ms" in note for note in finer.notes)
    odd = text.replace('<rec time="0.008000"', '<rec time="0.007300" f9="0"/>\n<rec time="0.008000"', 1)
    found = trace(written(tmp_path, odd, "b.xml"))
    assert "M1.0" not in signals(found)
    assert any("values of M1.0 do not lie on its grid" in note for note in found.notes)
    assert np.array_equal(found.signals[0].values, series["f1"])


def test_booleans_of_the_plc(tmp_path: Path) -> None:
    text, _ = made.sinumerik_trace()
    text = text.replace('<dataSignal id="f1"', '<dataSignal id="f9" interval="0.004" datapointCount="3" name="M1.0" '
                        'unitsType="none" dataType="bool"/>\n<dataSignal id="f1"', 1)  # fmt: skip
    text = text.replace('<rec time="0.002000"', '<rec time="0.002000" f9="true"', 1)
    text = text.replace('<rec time="0.010000"', '<rec time="0.010000" f9="false"', 1)
    assert signals(trace(written(tmp_path, text, "a.xml")))["M1.0"].values[:4].tolist() == [1.0, 1.0, 0.0]


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("<traceSession", '<!DOCTYPE a [<!ENTITY b "c">]><traceSession', "holds a DTD"),
        ("</traceSession>", "", "is not whole XML"),
        ('time="0.010000"', 'time="0.001000"', "the time does not increase"),
        ('<rec time="0.000000"', '<rec time="0.000000" f1="1.0"/>\n<rec time="0.000000"', "two values at one time"),
        ("<rec ", '<rec f77="1" ', 'unknown signal "f77"'),
        ('f1="', 'f1="x', "is not a number"),
        ('interval="0.002000"', 'interval="1e-12"', "points"),
    ],
)
def test_damage_of_a_sinumerik_trace(tmp_path: Path, old: str, new: str, what: str) -> None:
    text, _ = made.sinumerik_trace()
    assert old in text
    with pytest.raises(InputError, match=what):
        trace(written(tmp_path, text.replace(old, new, 1), "a.xml"))


def test_deeply_nested_xml_is_refused(tmp_path: Path) -> None:
    text = "<traceSession>" + "<a>" * 100_000
    with pytest.raises(InputError, match="nested too deeply"):
        trace(written(tmp_path, text, "a.xml"))


# SINUMERIK Edge -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("form", ["json", "csv", "csv ;"])
def test_cycle_is_the_clock_of_an_edge_capture(tmp_path: Path, form: str) -> None:
    text = made.edge_json() if form == "json" else made.edge_csv(separator=";" if ";" in form else ",")
    found = trace(written(tmp_path, text, "a_hfdata.csv"))
    names, rows = made.edge_rows()
    table = np.array(rows)
    for i, name in enumerate(names[1:], start=1):
        signal = signals(found)[name]
        assert np.array_equal(signal.values, table[:, i])
        assert np.array_equal(signal.time, (table[:, 0] - table[0, 0]) * 2e-3)


def test_lost_stretch_of_an_edge_capture_is_said_and_divides_it(tmp_path: Path) -> None:
    path = written(tmp_path, made.edge_json(), "a.json")
    found = understood(path)
    assert any("250 samples are missing behind row 300" in note for note in found.notes)
    assert found.time.size == 600
    assert understood(path, Wishes(part=1)).time.size == 300
    with pytest.raises(InputError, match="there is no part 3"):
        understood(path, Wishes(part=3))


def test_the_edge_capture_of_a_real_machine(shared_data: Path) -> None:
    path = shared_data / "traces" / "edge" / "example_data.json.gz"
    found = understood(path, Wishes(axis="X1"))
    assert len(found.trace.signals) == 60
    assert any("3859 samples are missing behind row 1494" in note for note in found.notes)
    constant = next(one for one in found.choice.findings if one.about == "torque constant")
    # Regressions over either stretch and over both are 1.43754 to 1.43760.
    assert constant.value == pytest.approx(1.4376, abs=1e-4)
    assert "motor_current" not in found.channels  # the torque is computed from it
    with pytest.raises(
        InputError, match="it holds the axes C1, B1, SP1, X1, Y1, Z1; say which by --axis C1 of feeddrive read"
    ):
        read_recording(path)


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ('"CYCLE"', '"CIRCLE"', "there is no signal CYCLE"),
        ("[[5000.0", "[[1, 5000.0", "the row has 7 values, the header names 6 signals"),
        ("[5003.0", "[5001.0", "CYCLE does not increase"),
        ("[5003.0", '["a"', "a value of HFData is not a number"),
        ('"Footer": {}}', "", "is not whole JSON"),
    ],
)
def test_damage_of_an_edge_capture(tmp_path: Path, old: str, new: str, what: str) -> None:
    text = made.edge_json()
    assert old in text
    with pytest.raises(InputError, match=what):
        trace(written(tmp_path, text.replace(old, new), "a.json"))


def test_cycle_that_the_file_does_not_say_is_assumed_or_told(tmp_path: Path) -> None:
    path = written(tmp_path, made.edge_csv(), "a_hfdata.csv")
    assert any("2 ms assumed" in note for note in trace(path).notes)
    assert trace(path, Wishes(sample_time=4e-3)).signals[0].step == pytest.approx(4e-3, rel=1e-12)


# Frequency responses ------------------------------------------------------------------------------------------------


def test_frequency_response_of_a_sinumerik(tmp_path: Path) -> None:
    found = read_trace(open_file(SAMPLES / "sinumerik_frf" / "freq_trace.xml.gz"), Wishes())
    assert isinstance(found, FrequencyResponse)
    assert found.frequency.size == 1023
    assert found.frequency[-1] == 4000.0
    assert (found.given, found.output) == ("motor_speed_setpoint", "motor_speed")
    # A closed speed loop follows a slow set-point, and lags a fast one: up to 80 Hz by less than 90 deg.
    assert abs(found.values[1]) == pytest.approx(1.0, abs=0.01)
    assert np.all(np.abs(np.degrees(np.angle(found.values[1:20])) + 45.0) < 45.0)
    assert np.all(found.coherence[:60] > 0.98)
    write_response(found, tmp_path / "r.csv")
    again = read_trace(open_file(tmp_path / "r.csv"), Wishes())
    assert isinstance(again, FrequencyResponse)
    assert np.array_equal(again.frequency, found.frequency)
    # Magnitude and phase are written with all digits, and put together again.
    assert again.values == pytest.approx(found.values, rel=1e-14)
    assert np.array_equal(again.coherence, found.coherence)


def test_spectra_of_the_sinumerik_file_are_those_of_its_raw_series() -> None:
    """The input is a binary sequence of 2047 samples, averaged over two runs; its spectra stand in the file."""
    from feeddrive.recording.formats.sinumerik_frf import _numbers
    from feeddrive.recording.traces.xml_tree import parse_xml

    text = gzip.decompress((SAMPLES / "sinumerik_frf" / "freq_trace.xml.gz").read_bytes()).decode("latin-1")
    root = parse_xml(text, "a.xml")
    raw = [_numbers(one.find("NumericArray"), "a.xml") for one in root.iter("TimeSeries")]  # type: ignore[arg-type]
    spectra = [np.fft.rfft(one) for one in raw]
    given, output = spectra[2:], spectra[:2]
    response = sum(y * np.conj(u) for u, y in zip(given, output, strict=True)) / sum(np.abs(u) ** 2 for u in given)
    found = read_trace(open_file(SAMPLES / "sinumerik_frf" / "freq_trace.xml.gz"), Wishes())
    assert isinstance(found, FrequencyResponse)
    # Rounding of spectra summed in another order; the values go down to 1e-2.
    assert found.values[1:1023] == pytest.approx(response[1:1023], abs=1e-10)


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("m_iInputSigNodeUniqueInstanceID", "m_iOther", "which signal answers which"),
        ("kH);l{IV^v", "kH);l{IV^", "declared|damaged"),
        ("m_crossSpecInfoList", "m_other", "spectra of the measurement are not in the file"),
        ("<ResponseTestCustom", "<!DOCTYPE a><ResponseTestCustom", "holds a DTD"),
    ],
)
def test_damage_of_a_frequency_response(tmp_path: Path, old: str, new: str, what: str) -> None:
    text = gzip.decompress((SAMPLES / "sinumerik_frf" / "freq_trace.xml.gz").read_bytes()).decode("latin-1")
    assert old in text
    if old.startswith("kH"):  # raw series are not read: damage the spectrum of the input
        at = text.rindex("<raw", 0, text.rindex("m_FrequencyVector")) + 60
        text = text[:at] + text[at + 1 :]
    else:
        text = text.replace(old, new)
    with pytest.raises(InputError, match=what):
        read_trace(open_file(written(tmp_path, text, "a.xml", "latin-1")), Wishes())


def base_85(numbers: object) -> str:
    """Write doubles as the control does."""
    from feeddrive.recording.formats.sinumerik_frf import _LETTERS

    text = ""
    for word in np.asarray(numbers, dtype=">f8").view(">u4").tolist():
        digits = [(word // 85**place) % 85 for place in range(4, -1, -1)]
        text += "." if word == 0 else "".join(_LETTERS[digit] for digit in digits)
    return text


def test_plant_of_automatic_servo_tuning(tmp_path: Path) -> None:
    frequency = np.array([0.0, 1.0, 2.5, 10.0])
    values = np.array([4.0, 2.0 - 1.0j, -1.0j, -0.25])
    coherence = np.array([1.0, 0.99, 0.9, 0.5])

    def array(name: str, kind: str, numbers: object) -> str:
        count = len(np.asarray(numbers)) // (2 if kind == "ComplexNumber" else 1)
        length = f'<unsigned_int name="m_length">{count}</unsigned_int>'
        raw = f'<raw name="m_pNumberArray"><![CDATA[{base_85(numbers)}]]></raw>'
        return f'<NumericArray elementtype="{kind}" format="base85" name="{name}">{length}{raw}</NumericArray>'

    def response(name: str, numbers: object) -> str:
        pairs = np.column_stack((np.real(numbers), np.imag(numbers))).ravel()  # type: ignore[arg-type]
        return (f'<FrequencyResponseFunction name="{name}">{array("m_ValueVector", "ComplexNumber", pairs)}'
                f'{array("m_FrequencyVector", "double", frequency)}</FrequencyResponseFunction>')  # fmt: skip

    gains = '<float name="m_dKpGain">1.5</float><float name="m_dIntegralTime">0.01</float>'
    both = response("m_pPlant", values) + response("m_pMeasCoherence", coherence)
    text = ('<?xml version="1.0" encoding="ISO-8859-1"?><AutoServoTune satclassid="1">'
            f'<DynamicModel>{both}</DynamicModel><Regulator>{gains}</Regulator></AutoServoTune>')  # fmt: skip
    found = read_trace(open_file(written(tmp_path, text, "a.xml")), Wishes())
    assert isinstance(found, FrequencyResponse)
    assert np.array_equal(found.frequency, frequency)
    assert np.array_equal(found.values, values)
    assert np.array_equal(found.coherence, coherence)
    assert (found.given, found.output, found.unit) == ("motor_torque", "motor_speed", "")
    assert any("K_p 1.5 and T_n 0.01" in note for note in found.notes)


def test_frequency_response_is_no_recording() -> None:
    with pytest.raises(InputError, match="is a frequency response, not a recording"):
        read_recording(SAMPLES / "sinumerik_frf" / "freq_trace.xml.gz")


def test_csv_of_a_frequency_response_says_its_channels(tmp_path: Path) -> None:
    rows = "frequency [Hz],magnitude [(rad/s)/(N m)],phase [deg]\n1,2,0\n2,1,-90\n4,0.5,-180\n"
    with pytest.raises(InputError, match="does not say from which channel to which"):
        read_trace(open_file(written(tmp_path, rows, "a.csv")), Wishes())
    text = "# from = motor_torque, to = motor_speed\n" + rows
    found = read_trace(open_file(written(tmp_path, text, "b.csv")), Wishes())
    assert isinstance(found, FrequencyResponse)
    assert (found.given, found.output, found.unit) == ("motor_torque", "motor_speed", "(rad/s)/(N m)")
    assert found.values == pytest.approx([2.0, -1.0j, -0.5], abs=1e-15)


# LinuxCNC -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("form", ["old, comma", "old, point", "new", "new, drawn"])
def test_halscope(tmp_path: Path, form: str) -> None:
    text = {"old, comma": made.halscope_old(), "old, point": made.halscope_old(comma=False),
            "new": made.halscope_new(extras=False), "new, drawn": made.halscope_new()}[form]  # fmt: skip
    by_name = signals(trace(written(tmp_path, text, "a.log")))
    assert list(by_name) == ["joint.0.pos-fb", "joint.0.pos-cmd"]
    time = np.arange(500) * 1e-3
    assert by_name["joint.0.pos-fb"].time == pytest.approx(time, abs=1e-15)
    # Fourteen decimals stand in the file.
    assert by_name["joint.0.pos-fb"].values == pytest.approx(made.motion(time)[0], abs=1e-14)


def test_row_behind_the_memory_of_an_old_halscope_is_left_out(tmp_path: Path) -> None:
    """The writer of 2.9 counts `while (n <= samples)`, one row too many; what stands there is of an earlier capture."""
    text = made.halscope_old(comma=False)
    stale = "joint.0.pos-fb +900.00000000000000 joint.0.pos-cmd +0.00000000000000 \n"
    found = trace(written(tmp_path, text + stale, "a.log"))
    assert found.signals[0].values.size == 500
    assert any("one row behind the end of its memory" in note for note in found.notes)
    assert trace(written(tmp_path, text, "b.log")).signals[0].values.size == 500


def test_name_that_comes_twice_in_a_halscope_log(tmp_path: Path) -> None:
    rows = "".join(f"a.b {i:+d}.0 a.b {-i:+d}.0 \n" for i in range(10))
    by_name = signals(trace(written(tmp_path, "Sampling period is 1000 nSec \n\n" + rows, "a.log")))
    assert by_name["a.b (2)"].values.tolist() == [-float(i) for i in range(10)]


def test_unit_of_a_halscope_log_is_asked_for(tmp_path: Path) -> None:
    path = written(tmp_path, made.halscope_new(), "a.log")
    with pytest.raises(InputError, match=r"no unit; say it by --channel 'table_position=joint.0.pos-fb \[mm\]'"):
        read_recording(path)
    found = understood(path, Wishes(channels={"table_position": ("joint.0.pos-fb", "in")}))
    assert found.channels["table_position"] == pytest.approx(0.0254 * made.motion(found.time)[0], abs=1e-15)


def test_halsampler(tmp_path: Path) -> None:
    wishes = Wishes(sample_time=1e-3, columns=("place", "speed"))
    found = trace(written(tmp_path, made.halsampler(), "a.txt"), wishes)
    assert [signal.name for signal in found.signals] == ["place", "speed"]
    assert found.signals[0].time[199:201] == pytest.approx([0.199, 0.240], abs=1e-12)
    assert any("its length is told by the sample numbers" in note for note in found.notes)


def test_overrun_of_unknown_length_ends_the_stretch(tmp_path: Path) -> None:
    found = trace(written(tmp_path, made.halsampler(numbered=False), "a.txt"), Wishes(sample_time=1e-3))
    assert found.signals[0].values.size == 400
    assert any("its length is not known" in note for note in found.notes)


def test_sample_time_of_halsampler_is_asked_for(tmp_path: Path) -> None:
    path = written(tmp_path, made.halsampler(overrun=False), "a.txt")
    wishes = Wishes(columns=("place", "speed"), channels={"table_position": ("place", "mm")})
    with pytest.raises(InputError, match="holds no time; say the distance of its samples by --sample-time"):
        columns_of(understood(path, wishes), "a.txt")


# Any file -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["a.xml", "a.json", "a.txt"])
def test_gzip_bomb_is_refused(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(gzip.compress(b" " * (80 << 20)))
    with pytest.raises(InputError, match="more than 200 times its own size"):
        open_file(tmp_path / name)


def test_names_with_control_characters_are_cleaned(tmp_path: Path) -> None:
    rows = "".join(f"a\x1b[31m.b {i:+d}.0 \n" for i in range(10))
    text = "Sampling period is 1000 nSec \n\n" + rows
    with pytest.raises(InputError, match="is not a text file"):
        trace(written(tmp_path, text, "a.log"))
    tree = made.edge_json().replace("ENC_POS|1", "ENC\\u001b[31m|1")
    assert all(signal.name.isprintable() for signal in trace(written(tmp_path, tree, "a.json")).signals)


def test_canonical_files_are_not_taken_for_traces(tmp_path: Path) -> None:
    rows = "".join(f"{i * 1e-3},{i * 1e-6}\n" for i in range(200))
    path = written(tmp_path, "time [s],table_position [m]\n" + rows, "a.csv")
    assert read_trace(open_file(path), Wishes()) is None
