"""What a file of a drive, control or logger holds, as it is shown, recorded and saved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from feeddrive import __version__
from feeddrive.errors import InputError
from feeddrive.files import write_text_atomically
from feeddrive.interface.shown import Listing, Shown, finite
from feeddrive.recording.channels import channel_unit
from feeddrive.recording.files.writing import write_recording
from feeddrive.recording.frequency_response import FrequencyResponse, write_response
from feeddrive.recording.recording import Recording
from feeddrive.recording.traces.opened import Understood
from feeddrive.recording.traces.resampling import gaps
from feeddrive.recording.traces.trace import Signal, Trace, clean
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    from feeddrive.report.figures.drawing import ReportFigure


@dataclass(frozen=True, repr=False, eq=False)
class Inspected(Shown):
    """What a file holds: signals of a trace, a recording with canonical or mapped channels, or a frequency response.

    Attributes:
        path: of the file.
        sha256: of its content.
        recording: made of it; None of a frequency response, and where something is to be settled first.
        response: frequency response.
        trace: signals as the file names them; None where its channels are canonical or mapped.
        understood: which channel each signal is taken for, and why.
        fault: why there is no recording.
        mapping: that makes the same choice again, as a mapping file; empty where there is nothing to choose.
    """

    path: Path
    sha256: str
    recording: Recording | None = None
    response: FrequencyResponse | None = None
    trace: Trace | None = None
    understood: Understood | None = None
    fault: str = ""
    mapping: str = ""

    @property
    def kind(self) -> str:
        """Format of a trace, "recording" or "frequency response"."""
        if self.response is not None:
            return "frequency response"
        return "recording" if self.trace is None else self.trace.format

    def listing(self) -> Listing:
        """One row per signal or channel; of a frequency response its extent."""
        return self.tables()[0]

    def tables(self) -> tuple[Listing, ...]:
        """Signals or channels, then notes and what is to be settled."""
        if self.response is not None:
            return (self._response_listing(self.response),)
        if self.trace is not None and self.understood is not None:
            return self._trace_listings(self.trace, self.understood)
        assert self.recording is not None
        rows = [[name, channel_unit(name, "")] for name in self.recording.channels]
        title = f"{clean(self.path.name)}: recording, {_extent(self.recording)}"
        notes = [["note", note] for note in self.recording.notes]
        return (Listing(title, ("channel", "unit inside"), rows), *([Listing("", (), notes)] if notes else []))

    def record(self) -> dict[str, Any]:
        """Everything as plain values, SI."""
        content: dict[str, Any] = {
            "format": "feeddrive-read/1",
            "version": __version__,
            "file": str(self.path),
            "sha256": self.sha256,
            "kind": self.kind,
        }
        if self.response is not None:
            return content | _response_record(self.response)
        if self.trace is not None and self.understood is not None:
            return content | self._trace_record(self.trace, self.understood)
        assert self.recording is not None
        return content | _recording_record(self.recording) | {"notes": list(self.recording.notes)}

    def save(self, path: str | Path) -> tuple[Path, ...]:
        """Write the canonical file, .csv or .csv.gz, and beside it as NAME_map.toml the mapping where there is one.

        Raises:
            InputError: another ending, something is to be settled first, or a file cannot be written.
        """
        target = Path(path)
        refuse_ending(target)
        if self.response is not None:
            write_response(self.response, target)
            return (target,)
        if self.recording is None:
            raise InputError(self.fault)
        write_recording(self.recording, target)
        if not self.mapping:
            return (target,)
        beside = target.with_name(target.name.removesuffix(".gz").removesuffix(".csv") + "_map.toml")
        write_text_atomically(beside, self.mapping)
        return (target, beside)

    def save_figure(self, path: str | Path) -> Path:
        """Write the picture of a frequency response.

        Raises:
            InputError: no frequency response, another ending than .png, or the file cannot be written.
        """
        target = Path(path)
        if self.response is None:
            raise InputError("a picture is drawn of frequency responses alone", "figure", "leave it out")
        if target.suffix != ".png":
            raise InputError("pictures are written as .png", str(target), "correct the ending of --figure")
        return super().save_figure(target)

    def _figures(self) -> Sequence[ReportFigure]:
        if self.response is None:
            return ()
        from feeddrive.report.figures.figure_response import response_figure

        return (response_figure(self.response),)

    def _response_listing(self, found: FrequencyResponse) -> Listing:
        shown = found.positive
        coherent = shown.coherence[np.isfinite(shown.coherence)]
        rows = [
            ["from", found.given],
            ["to", found.output],
            ["magnitude in", found.unit or "not said by the file"],
            ["frequencies", f"{found.frequency.size}, {shown.frequency[0]:.4g} Hz to {shown.frequency[-1]:.4g} Hz"],
        ]
        if coherent.size:
            share = 100 * float(np.mean(coherent > 0.8))
            rows.append(["coherence above 0.8", f"{share:.0f} % of the frequencies"])
        rows += [["note", note] for note in found.notes]
        return Listing(f"{clean(self.path.name)}: frequency response", (), rows)

    def _trace_listings(self, trace: Trace, understood: Understood) -> tuple[Listing, ...]:
        axis = understood.choice.axis
        picks = {pick.signal.name: pick for pick in understood.choice.picks}
        shown = [one for one in trace.signals if not axis or one.axis in ("", axis) or one.name in picks]
        rows = []
        for signal in shown:
            pick = picks.get(signal.name)
            taken = (f"{pick.channel} [{pick.unit}]" if pick.unit else pick.channel) if pick else ""
            rows.append([signal.name, signal.axis, signal.unit or "-", _rate(signal), str(signal.values.size), taken])
        extent = f", axis {axis}" if axis else ""
        others = f" of {len(trace.signals)} signals" if len(shown) < len(trace.signals) else " signals"
        title = f"{trace.format}{extent}: {len(shown)}{others}"
        remarks = [["note", note] for note in self._notes(understood)]
        remarks += [["to settle", question] for question in understood.choice.questions]
        if self.recording is not None:
            remarks.append(["recording", f"{', '.join(self.recording.channels)}: {_extent(self.recording)}"])
        elif self.fault:
            remarks.append(["no recording", self.fault])
        headings = ("signal", "axis", "unit", "every", "samples", "taken for")
        return Listing(title, headings, rows), Listing("", (), remarks)

    def _notes(self, understood: Understood) -> list[str]:
        return list(self.recording.notes if self.recording is not None else understood.notes)

    def _trace_record(self, trace: Trace, understood: Understood) -> dict[str, Any]:
        picks = {pick.signal.name: pick for pick in understood.choice.picks}
        signals = []
        for signal in trace.signals:
            pick = picks.get(signal.name)
            signals.append(
                {
                    "name": signal.name,
                    "unit": signal.unit or None,
                    "axis": signal.axis or None,
                    "samples": int(signal.values.size),
                    "start": float(signal.time[0]) if signal.time.size else None,
                    "step": float(f"{signal.step:.12g}"),
                    "gaps": [{"behind_row": i + 1, "missing": count} for i, count in gaps(signal.time)],
                    "channel": pick.channel if pick else None,
                    "reason": pick.reason if pick else None,
                    "unit_taken": pick.unit if pick else None,
                    "to_si": pick.factor if pick else None,
                }
            )
        findings = [
            {
                "about": one.about,
                "text": one.text,
                "value": finite(one.value),
                "unit": one.unit,
                "scatter": finite(one.scatter),
            }
            for one in understood.choice.findings
        ]
        return {
            "axes": list(trace.axes),
            "axis": understood.choice.axis or None,
            "signals": signals,
            "recording": _recording_record(self.recording) if self.recording is not None else None,
            "fault": self.fault or None,
            "questions": list(understood.choice.questions),
            "findings": findings,
            "notes": self._notes(understood),
        }


def refuse_ending(path: Path) -> None:
    """Refuse a file name that is not of a recording.

    Raises:
        InputError: it ends otherwise.
    """
    if not path.name.endswith((".csv", ".csv.gz")):
        raise InputError("recordings are written as .csv or .csv.gz", str(path), "correct the ending of --out")


def _response_record(found: FrequencyResponse) -> dict[str, Any]:
    shown = found.positive
    coherent = shown.coherence[np.isfinite(shown.coherence)]
    return {
        "from": found.given,
        "to": found.output,
        "unit": found.unit,
        "lines": int(found.frequency.size),
        "low": float(shown.frequency[0]),
        "high": float(shown.frequency[-1]),
        "notes": list(found.notes),
        **({"coherent_share": float(np.mean(coherent > 0.8))} if coherent.size else {}),
    }


def _recording_record(recording: Recording) -> dict[str, Any]:
    return {
        "samples": len(recording),
        "sample_time": recording.sample_time,
        "start": float(recording.time[0]),
        "channels": [{"name": name, "unit": channel_unit(name, "")} for name in recording.channels],
    }


def _extent(recording: Recording) -> str:
    every = format_quantity(recording.sample_time, "s")
    return f"{len(recording)} samples every {every}, {recording.duration:.6g} s"


def _rate(signal: Signal) -> str:
    if not signal.timed:
        return "not said"
    return format_quantity(signal.step, "s") if signal.step > 0.0 else "-"
