"""What `feeddrive read` does: open the file, say what was understood, write the canonical file and the mapping."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from feeddrive import __version__
from feeddrive.cli.output import deliver, table
from feeddrive.errors import InputError
from feeddrive.files import write_bytes_atomically, write_text_atomically
from feeddrive.recording.channels import channel_unit
from feeddrive.recording.files.mapping import read_mapping
from feeddrive.recording.files.opening import FileContent, open_file
from feeddrive.recording.files.reading import checked_trace, read_recording
from feeddrive.recording.files.writing import write_recording
from feeddrive.recording.frequency_response import FrequencyResponse, write_response
from feeddrive.recording.recording import Recording
from feeddrive.recording.traces.choosing import Wishes
from feeddrive.recording.traces.mapping_text import mapping_text
from feeddrive.recording.traces.opened import Understood, mapped, read_trace, understand
from feeddrive.recording.traces.resampling import gaps
from feeddrive.recording.traces.trace import Signal, Trace, clean
from feeddrive.units.quantity import format_quantity, parse

FORMAT = "feeddrive-read/1"


@dataclass(frozen=True)
class Request:
    """What was typed; texts are empty, and the part 0, where left out."""

    file: Path
    mapping: Path | None
    axis: str
    lead: str
    channels: tuple[str, ...]
    rate: str
    part: int
    sample_time: str
    columns: str
    decimal: str
    out: Path | None
    figure: Path | None


def run(request: Request, as_json: bool) -> None:
    """Read, write and show.

    Raises:
        InputError: a file or a wish that cannot be used; nothing is written then.
    """
    if request.out is not None and not request.out.name.endswith((".csv", ".csv.gz")):
        raise InputError("recordings are written as .csv or .csv.gz", str(request.out), "correct the ending of --out")
    wishes = _wishes(request)
    content = open_file(request.file)
    known = read_mapping(request.mapping) if request.mapping is not None else None
    if known is not None and known.sample_time is not None and wishes.sample_time is None:
        wishes = Wishes(sample_time=known.sample_time, columns=wishes.columns)
    found = read_trace(content, wishes)
    if isinstance(found, FrequencyResponse):
        _response(found, request, as_json)
        return
    if request.figure is not None:
        raise InputError("a picture is drawn of frequency responses alone", "--figure", "leave it out")
    if found is None:
        _recording(read_recording(request.file, request.mapping, decimal=request.decimal or None), request, as_json)
        return
    where = str(request.file)
    understood = mapped(found, known, where) if known is not None else understand(found, wishes, where)
    recording, fault = _recording_of(content, understood, request.out is not None)
    written = []
    if request.out is not None and recording is not None:
        write_recording(recording, request.out)
        written = [request.out]
        if known is None:
            text = mapping_text(
                understood.choice, wishes, recording.sample_time, f"{found.format}: {request.file.name}"
            )
            written.append(mapping_path(request.out))
            write_text_atomically(written[1], text)
    content_json = _content(content, found, understood, recording, fault, written)
    deliver(content_json, _tables(found, understood, recording, fault, written), as_json, None)


def mapping_path(out: Path) -> Path:
    """Return where the mapping of a canonical file is written: rec.csv.gz -> rec_map.toml."""
    return out.with_name(out.name.removesuffix(".gz").removesuffix(".csv") + "_map.toml")


def _wishes(request: Request) -> Wishes:
    channels = {}
    for text in request.channels:
        channel, separator, rest = text.partition("=")
        if not separator or not rest.strip():
            raise InputError(f'"{text}" says no channel', "--channel", "write --channel 'motor_torque=NAME [N m]'")
        channel_unit(channel.strip(), "--channel")
        name, unit = _name_and_unit(rest.strip())
        channels[channel.strip()] = name, unit
    positive = {}
    for option, text, unit, example in (("--lead", request.lead, "m", "10 mm"), ("--rate", request.rate, "Hz", "1 kHz"),
                                        ("--sample-time", request.sample_time, "s", "1 ms")):  # fmt: skip
        positive[option] = parse(text, unit, option) if text else None
        if positive[option] is not None and not positive[option] > 0.0:  # type: ignore[operator]
            raise InputError(f"{text} is not above zero", option, f'write e.g. "{example}"')
    if request.part < 0:
        raise InputError(f"there is no part {request.part}", "--part", "1 is the first")
    columns = tuple(name.strip() for name in request.columns.split(",")) if request.columns else ()
    return Wishes(request.axis or None, positive["--lead"], channels, positive["--rate"], request.part or None,
                  positive["--sample-time"], columns)  # fmt: skip


def _name_and_unit(text: str) -> tuple[str, str]:
    """Split `NAME [unit]`; what stands in the last brackets is a unit, unless the name itself ends so."""
    if text.endswith("]") and "[" in text:
        name, _, unit = text[:-1].rpartition("[")
        if "," not in unit:
            return name.strip(), unit.strip()
    return text, ""


def _recording_of(content: FileContent, understood: Understood, needed: bool) -> tuple[Recording | None, str]:
    """Return the recording, or why there is none; raises that where one is needed."""
    try:
        return checked_trace(content, understood), ""
    except InputError as error:
        if needed:
            raise
        return None, str(error)


def _response(found: FrequencyResponse, request: Request, as_json: bool) -> None:
    """Show and write a frequency response."""
    written = []
    if request.out is not None:
        write_response(found, request.out)
        written.append(request.out)
    if request.figure is not None:
        from feeddrive.report.figures.drawing import render
        from feeddrive.report.figures.figure_response import response_figure

        if request.figure.suffix != ".png":
            raise InputError("pictures are written as .png", str(request.figure), "correct the ending of --figure")
        write_bytes_atomically(request.figure, render(response_figure(found)).png)
        written.append(request.figure)
    shown = found.positive
    coherent = shown.coherence[np.isfinite(shown.coherence)]
    content: dict[str, Any] = {
        "format": FORMAT, "version": __version__, "file": str(request.file), "sha256": found.sha256,
        "kind": "frequency response", "from": found.given, "to": found.output, "unit": found.unit,
        "lines": int(found.frequency.size), "low": float(shown.frequency[0]), "high": float(shown.frequency[-1]),
        "notes": list(found.notes), "written": [str(path) for path in written],
    }  # fmt: skip
    rows = [
        ["from", found.given],
        ["to", found.output],
        ["magnitude in", found.unit or "not said by the file"],
        ["frequencies", f"{found.frequency.size}, {shown.frequency[0]:.4g} Hz to {shown.frequency[-1]:.4g} Hz"],
    ]
    if coherent.size:
        content["coherent_share"] = float(np.mean(coherent > 0.8))
        rows.append(["coherence above 0.8", f"{100 * content['coherent_share']:.0f} % of the frequencies"])
    rows += [["note", note] for note in found.notes] + [["written", str(path)] for path in written]
    deliver(content, [_plain(rows, f"{clean(request.file.name)}: frequency response")], as_json, None)


def _recording(recording: Recording, request: Request, as_json: bool) -> None:
    """Show a recording with canonical or mapped channels."""
    written = []
    if request.out is not None:
        write_recording(recording, request.out)
        written.append(request.out)
    content = {
        "format": FORMAT, "version": __version__, "file": str(request.file), "sha256": recording.sha256,
        "kind": "recording", **_recording_content(recording), "notes": list(recording.notes),
        "written": [str(path) for path in written],
    }  # fmt: skip
    rows = [[name, channel_unit(name, "")] for name in recording.channels]
    said = [["note", note] for note in recording.notes] + [["written", str(path)] for path in written]
    tables = [table(f"{clean(request.file.name)}: recording, {_extent(recording)}", ("channel", "unit inside"), rows)]
    deliver(content, [*tables, *([_plain(said)] if said else [])], as_json, None)


def _recording_content(recording: Recording) -> dict[str, Any]:
    return {
        "samples": len(recording),
        "sample_time": recording.sample_time,
        "start": float(recording.time[0]),
        "channels": [{"name": name, "unit": channel_unit(name, "")} for name in recording.channels],
    }


def _content(
    content: FileContent,
    trace: Trace,
    understood: Understood,
    recording: Recording | None,
    fault: str,
    written: list[Path],
) -> dict[str, Any]:
    picks = {pick.signal.name: pick for pick in understood.choice.picks}
    signals = []
    for signal in trace.signals:
        pick = picks.get(signal.name)
        lost = gaps(signal.time)
        signals.append(
            {
                "name": signal.name, "unit": signal.unit or None, "axis": signal.axis or None,
                "samples": int(signal.values.size), "start": float(signal.time[0]) if signal.time.size else None,
                "step": float(f"{signal.step:.12g}"), "gaps": [{"behind_row": i + 1, "missing": n} for i, n in lost],
                "channel": pick.channel if pick else None, "reason": pick.reason if pick else None,
                "unit_taken": pick.unit if pick else None, "to_si": pick.factor if pick else None,
            }
        )  # fmt: skip
    found = [{"about": one.about, "text": one.text, "value": _number(one.value), "unit": one.unit,
              "scatter": _number(one.scatter)} for one in understood.choice.findings]  # fmt: skip
    return {
        "format": FORMAT, "version": __version__, "file": str(content.path), "sha256": content.sha256,
        "kind": trace.format, "axes": list(trace.axes), "axis": understood.choice.axis or None, "signals": signals,
        "recording": _recording_content(recording) if recording is not None else None, "fault": fault or None,
        "questions": list(understood.choice.questions), "findings": found,
        "notes": list(recording.notes if recording is not None else understood.notes),
        "written": [str(path) for path in written],
    }  # fmt: skip


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _tables(
    trace: Trace, understood: Understood, recording: Recording | None, fault: str, written: list[Path]
) -> list[Table]:
    axis = understood.choice.axis
    picks = {pick.signal.name: pick for pick in understood.choice.picks}
    shown = [signal for signal in trace.signals if not axis or signal.axis in ("", axis) or signal.name in picks]
    rows = []
    for signal in shown:
        pick = picks.get(signal.name)
        taken = (f"{pick.channel} [{pick.unit}]" if pick.unit else pick.channel) if pick else ""
        rows.append([signal.name, signal.axis, signal.unit or "-", _rate(signal), str(signal.values.size), taken])
    extent = f", axis {axis}" if axis else ""
    others = f" of {len(trace.signals)} signals" if len(shown) < len(trace.signals) else " signals"
    headings = ("signal", "axis", "unit", "every", "samples", "taken for")
    tables = [table(f"{trace.format}{extent}: {len(shown)}{others}", headings, rows)]
    said = [["note", note] for note in (recording.notes if recording is not None else understood.notes)]
    said += [["to settle", question] for question in understood.choice.questions]
    if recording is not None:
        said.append(["recording", f"{', '.join(recording.channels)}: {_extent(recording)}"])
    elif fault:
        said.append(["no recording", fault])
    said += [["written", str(path)] for path in written]
    return [*tables, _plain(said)]


def _plain(rows: Sequence[Sequence[str]], title: str | None = None) -> Table:
    """A table of names and texts, without headings."""
    made = Table(title=title, title_justify="left", title_style="bold", show_header=False)
    made.add_column(min_width=12)
    made.add_column(overflow="fold")
    for row in rows:
        made.add_row(*row)
    return made


def _extent(recording: Recording) -> str:
    return (f"{len(recording)} samples every {format_quantity(recording.sample_time, 's')}, "
            f"{recording.duration:.6g} s")  # fmt: skip


def _rate(signal: Signal) -> str:
    if not signal.timed:
        return "not said"
    return format_quantity(signal.step, "s") if signal.step > 0.0 else "-"
