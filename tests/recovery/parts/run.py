"""Cases diagnosed one after the other, one line of JSON each; what was found beside what was planted."""

from __future__ import annotations

import json
import math
import time
import traceback
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.errors import InputError
from tests.generator.screw_elements import Recorder
from tests.recovery.fleet.run import Record, TimeLimitError, found_of, time_limit
from tests.recovery.parts.cases import Case
from tests.recovery.parts.responses import ResponseCase, response_record
from tests.state import ROOT, digest_of

Asked = Case | ResponseCase

RESULTS = "results.jsonl"
LARGEST_SET = 3
ENOUGH = 0.05
"""Share by which a value may differ from what was planted, unless its interval holds it."""

FLOOR = 1.2
"""Error after over that of the true plant."""


def parts_state() -> str:
    """Twelve letters of all that can change a result; records of another state are not taken."""
    folders = ("feeddrive", "plants", "tests/generator", "tests/recovery/parts")
    files = [p for folder in folders for p in (ROOT / folder).rglob("*") if p.suffix in (".py", ".c", ".h", ".toml")]
    files.append(ROOT / "tests" / "recovery" / "parts_runs.py")
    return digest_of(sorted(files), ("numpy", "scipy", "casadi", "numba"), ROOT)


def records_of(folder: Path, state: str | None = None) -> dict[str, Record]:
    """The records of a folder by case, those of one state where it is given; the last of a case counts."""
    path, found = folder / RESULTS, {}
    for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else ():
        try:
            record = json.loads(line)
        except json.JSONDecodeError:
            continue  # the line that was being written when it was killed
        if state is None or record["state"] == state:
            found[record["key"]] = record
    return found


def run_missing(
    cases: Sequence[Asked], folder: Path, limit: float, minutes: float, resume: bool, said: Callable[[Record], None]
) -> None:
    """Run the cases without a record of this state, the cheap first; none begins after so many minutes (0: no end)."""
    folder.mkdir(parents=True, exist_ok=True)
    state, begun = parts_state(), time.monotonic()
    done = records_of(folder, state) if resume else {}
    for case in sorted((one for one in cases if one.key not in done), key=lambda one: one.cost):
        if minutes and time.monotonic() - begun > 60 * minutes:
            break
        found = diagnosed(case, limit) if isinstance(case, Case) else response_record(case, limit)
        record = {"key": case.key, "state": state, "kind": case.kind, **found}
        with (folder / RESULTS).open("a", encoding="utf-8") as file:
            file.write(json.dumps(record, ensure_ascii=False) + "\n")
        said(record)


def diagnosed(case: Case, limit: float) -> Record:
    """Record and diagnose a case; what is raised is kept as its result."""
    _, name, values = case.planted
    record: dict[str, Any] = {"machine": case.machine, "what": case.what, "draw": case.draw, "name": name}
    record["values"] = values
    fitted, judged = case.recordings()
    plant, begun = case.plant, time.process_time()
    try:
        with warnings.catch_warnings(), time_limit(limit):
            warnings.simplefilter("ignore")
            result, _ = diagnose(plant, [fitted], validation=[judged])
    except InputError as refusal:
        return record | {"outcome": "refused", "said": str(refusal), "cpu": time.process_time() - begun}
    except TimeLimitError:
        return record | {"outcome": "time limit", "cpu": time.process_time() - begun}
    except Exception:
        return record | {"outcome": "raised", "said": traceback.format_exc(), "cpu": time.process_time() - begun}
    record |= found_of(result, [_place(effect) for effect in result.effects]) | _calibrated(result)
    gain = prepare(judged, plant, 1.0).band.noise_gain
    how = Recorder()
    noise = {"motor_torque": how.torque_noise, "table_position": math.hypot(how.scale_noise, how.scale_step / 12**0.5)}
    return record | {
        "outcome": "done",
        "cpu": time.process_time() - begun,
        "floor": {channel: noise[channel] * gain for channel in record["after"]},
    }


def _place(effect: Any) -> str:
    part = effect.parameters.get("part")
    return str(part.value) if part is not None else ""


def _calibrated(result: Diagnosis) -> dict[str, Any]:
    return {
        "calibrated": {
            one.key: {"value": one.value / one.declared, "ci95": [end / one.declared for end in one.ci95]}
            for one in result.calibrated
        }
    }


@dataclass(frozen=True)
class Row:
    """A record with its questions answered."""

    record: dict[str, Any]

    @property
    def named(self) -> list[str]:
        """Names that are asserted, a part's place behind it."""
        return [one["name"] + (f" {one['place']}" if one["place"] else "") for one in self.record.get("found", ())]

    @property
    def within_tolerance(self) -> bool:
        """Whether what was planted may be a calibrated value: a part's stiffness, other by no more than a factor."""
        return bool(self.record["name"] == "stiffness_deviation" and not self.record.get("found"))

    @property
    def right(self) -> bool:
        """Whether what was planted is named, alone or in a set of three, or a calibrated value's interval holds it."""
        if self.record["outcome"] != "done":
            return False
        planted, names = self.record["name"], [one["name"] for one in self.record["found"]]
        if not planted or not names:
            return not names and (not planted or (self.within_tolerance and self.interval_holds is not False))
        if len(names) > 1:
            return False
        part = self.record["values"].get("part", "")
        if planted == names[0]:
            return not part or part == self.record["found"][0]["place"] or self._told_as_well(part)
        return any(planted in one and names[0] in one and len(one) <= LARGEST_SET for one in self.record["ambiguous"])

    def _told_as_well(self, part: str) -> bool:
        return any("does as well as" in note and part in note for note in self.record["notes"])

    @property
    def interval_holds(self) -> bool | None:
        """Whether the calibrated stiffnesses hold what is true of each; None where none is listed."""
        true = {}
        if self.record["name"] == "stiffness_deviation":
            true = {f"{self.record['values']['part']}_stiffness": self.record["values"]["factor"]}
        stiffness = {k: v["ci95"] for k, v in self.record["calibrated"].items() if k.endswith("stiffness")}
        if not stiffness:
            return None
        return all(low <= true.get(key, 1.0) <= high for key, (low, high) in stiffness.items())

    @property
    def missed(self) -> list[str]:
        """Calibrated values whose interval holds not what is true."""
        true = {"part": "", **self.record["values"]}
        truth = {f"{true['part']}_stiffness": true["factor"]} if true["part"] else {}
        if "mass" in true and not self.record["found"]:
            return []
        return [
            key for key, one in self.record["calibrated"].items()
            if not one["ci95"][0] <= truth.get(key, 1.0) <= one["ci95"][1]
        ]  # fmt: skip

    def values(self) -> Iterator[tuple[str, float, float, bool]]:
        """Parameter of the named effect: found, planted, and whether within 5 % or in its interval."""
        found = [one for one in self.record.get("found", ()) if one["name"] == self.record["name"]]
        for key, true in self.record["values"].items() if len(found) == 1 else ():
            told = found[0]["parameters"].get(key)
            if told is None or isinstance(true, str) or not isinstance(told["value"], int | float):
                continue
            off = told["value"] - true
            if key == "phase":
                off = math.remainder(off, 2 * math.pi)
            inside = told["ci95"] is not None and told["ci95"][0] <= told["value"] - off <= told["ci95"][1]
            scale = 1.0 if key in ("phase", "centre") else abs(true)
            yield key, told["value"], true, abs(off) <= ENOUGH * scale or inside

    @property
    def over_floor(self) -> dict[str, float]:
        """Channel to error after over the noise that the generator added."""
        return {name: self.record["after"][name] / floor for name, floor in self.record.get("floor", {}).items()}

    @property
    def at_floor(self) -> bool:
        """Whether every channel is."""
        return bool(self.over_floor) and max(self.over_floor.values()) <= FLOOR

    @property
    def line(self) -> str:
        """The case in a line."""
        head = f"{self.record['key']:28s} {self.record['cpu']:5.0f} s "
        if self.record["outcome"] != "done":
            return head + self.record["outcome"] + " " + str(self.record.get("said", "")).strip()[-300:]
        told = "; ".join(
            f"{key} {found:.4g} ({true:.4g}{'' if ok else ', OFF'})" for key, found, true, ok in self.values()
        )
        floors = ", ".join(f"{name.split('_')[0]} {ratio:.2f}" for name, ratio in self.over_floor.items())
        sets = f" sets {self.record['ambiguous']}" if self.record["ambiguous"] else ""
        tables = f" +{self.record['tables']} tables" if self.record["tables"] else ""
        return (
            f"{head}{'right' if self.right else 'WRONG'} {self.named}{sets}{tables} {told} | {floors}"
            + (f" | missed {self.missed}" if self.missed else "")
        )  # fmt: skip
