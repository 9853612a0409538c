"""Frequency responses of the machines of parts, from the matrices of finite elements, explained with the parts file.

Relative scatter of 2 % where a line is as large as the median, more below it, as a drive's sensor leaves it, and the
coherence that belongs to it: it falls at anti-resonances.
"""

from __future__ import annotations

import math
import time
import traceback
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from feeddrive.diagnosis.responses.response_result import ResponseResult, diagnose_response, response_plant_text
from feeddrive.files import find_plant
from feeddrive.interface.axis import Axis, axis_of_text, load
from feeddrive.plant.analysis.stiffness_budget import stiffness_budget
from feeddrive.plant.chain.resolution import resolved_modes
from feeddrive.recording.frequency_response import FrequencyResponse
from feeddrive.servo.mechanics_response import Case as Point
from tests.generator.screw_elements import Array, Drive, Friction, drive_of, frequencies, matrices
from tests.recovery.fleet.run import Record, TimeLimitError, time_limit
from tests.recovery.parts.cases import ALONE, MACHINES, TIMES
from tests.recovery.parts_runs import MARGIN, friction_of, softer

LINES = np.arange(8.0, 700.0, 4.0)
"""Frequencies [Hz]; a resonance damped by 2 % at 190 Hz is 8 Hz wide."""

AVERAGES, SCATTER = 16, 0.02
WHAT = ("nothing", "nut", "bearing", "coupling", "payload", "mode")
PARTS = {"nut": "nut", "bearing": "near", "coupling": "coupling"}

NAMES = {
    "nothing": ([],), "nut": ([], ["nut.axial_stiffness"]), "bearing": ([], ["bearing.near.axial_stiffness"]),
    "coupling": ([], ["coupling.torsional_stiffness"]), "payload": (["table.mass"],), "mode": (["structural_mode"],),
}  # fmt: skip
"""What may be named; a part that is softer by what its tolerance allows is shared with those it is in series with."""

TYPICAL, EDGE = 1.3, 1.05
"""Factor that a mass of a typical part is known to by its tolerance; over it by less than intervals of a mass are wide
(2 % either way, and as much by chance), either may be said."""

FREQUENCY, STIFFNESS, NOTHING_LEFT = 0.005, 0.03, 1.1
"""Asked for: relative error of frequencies and of the static stiffness; what is left over the scatter of the lines."""


@dataclass(frozen=True)
class ResponseCase:
    """A machine with one thing planted, or none; the draw decides its size, the place, the speed and the scatter."""

    machine: str
    what: str
    draw: int
    kind = "response"

    @property
    def key(self) -> str:
        """What a record of it is found by."""
        return f"{self.machine} {self.what} {self.draw} response"

    @property
    def cost(self) -> float:
        """Processor seconds, about."""
        return ALONE[self.machine] * TIMES[self.what]

    @cached_property
    def axis(self) -> Axis:
        """The declared machine."""
        return load(self.machine)

    @cached_property
    def drawn(self) -> tuple[Point, Drive, tuple[float, ...], np.random.Generator]:
        """Operating point, drive as it is, what is planted (share, or mass [kg], frequency [Hz], damping), chance."""
        random = np.random.default_rng([20261122, 77, self.draw, MACHINES.index(self.machine), WHAT.index(self.what)])
        declared = drive_of(find_plant(self.machine))
        assert self.axis.plant.stroke is not None
        low, high = self.axis.plant.stroke
        point = Point(float(random.uniform(low + MARGIN, high - MARGIN)), float(random.uniform(0.03, 0.08)))
        if self.what == "nothing":
            return point, declared, (), random
        if self.what == "payload":
            share = float(random.uniform(1.3, 1.8))
            return point, replace(declared, table=share * declared.table), (share,), random
        if self.what == "mode":
            first = float(frequencies(declared, point.position, False, 1)[0])
            mass, at = float(random.uniform(0.08, 0.2)) * declared.table, float(random.uniform(0.35, 0.8)) * first
            return point, declared, (mass, at, float(random.uniform(0.015, 0.04))), random
        share = float(random.uniform(0.45, 0.65))
        return point, replace(declared, **dict(softer(declared, PARTS[self.what], share))), (share,), random

    @property
    def may_be_within(self) -> bool:
        """Whether a mass that is planted may be one that the file's tolerance allows."""
        source = str(self.axis.entries["source"])
        return self.what == "payload" and "typical" in source and self.drawn[2][0] < EDGE * TYPICAL

    def response(self) -> FrequencyResponse:
        """Motor speed over motor torque, as a drive measures it while the axis moves."""
        point, drive, planted, random = self.drawn
        mode = planted if self.what == "mode" else ()
        exact = _exact(drive, friction_of(self.axis.plant), point, mode)
        scatter = SCATTER * np.sqrt(np.maximum(1.0, np.median(np.abs(exact)) / np.abs(exact)))
        error = scatter * (random.standard_normal(len(exact)) + 1j * random.standard_normal(len(exact)))
        coherence = 1 / (1 + 2 * AVERAGES * scatter**2)
        return FrequencyResponse("made", "motor_torque", "motor_speed", "", LINES, exact * np.exp(error), coherence)


def _exact(drive: Drive, friction: Friction, point: Point, mode: Sequence[float]) -> Array:
    """(rad/s)/(N m); friction as its slope at the speed, that of the screw at its nut's end of the first rotation."""
    M, K = matrices(drive, point.position)
    C = drive.tau * K
    level, turning, viscous, film, exponent = friction.table

    def guide(v: float) -> float:
        return viscous * v + film * v**exponent + level * math.tanh(v / turning)

    v, w = point.velocity, point.velocity / drive.radius
    C[-1, -1] += (guide(1.001 * v) - guide(0.999 * v)) / (0.002 * v)
    C[0, 0] += friction.screw[1] * (2 / 3) * w ** (-1 / 3)
    if mode:
        mass, frequency, damping = mode
        M, C, K = (np.pad(matrix, ((0, 1), (0, 1))) for matrix in (M, C, K))
        row, rate = np.zeros(len(M)), 2 * math.pi * frequency
        row[-2:] = -1.0, 1.0
        M[-1, -1] = mass
        K += mass * rate**2 * np.outer(row, row)
        C += 2 * damping * mass * rate * np.outer(row, row)
    torque = np.eye(len(M))[:, 0] * drive.ratio**2
    found: Array = np.array([s * np.linalg.solve(M * s**2 + C * s + K, torque)[0] for s in 2j * math.pi * LINES])
    return found


@dataclass(frozen=True)
class Explained:
    """A case with what was said of it."""

    case: ResponseCase
    result: ResponseResult

    @property
    def named(self) -> list[str]:
        """What is asserted; a declared value by its key."""
        return [one.parameters[0].key if one.name == "declared_value" else one.name for one in self.result.asserted]

    @cached_property
    def after(self) -> Axis:
        """The machine as its file is after."""
        return axis_of_text(response_plant_text(self.case.axis.text, self.result), self.case.axis.path)

    @cached_property
    def frequency_off(self) -> tuple[float, float]:
        """First two frequencies, motor free, over those of the elements, less one; of the further mode: it alone."""
        point, drive, planted, _ = self.case.drawn
        if self.case.what == "mode":
            told = [one for one in self.result.asserted if one.name == "structural_mode"]
            off = told[0].parameters[1].value / planted[1] - 1 if told else math.nan
            return off, off
        found = resolved_modes(self.after.plant, point.position, 3).free.frequencies
        first, second = found[found > 0][:2] / frequencies(drive, point.position, False, 2) - 1
        return float(first), float(second)

    @cached_property
    def stiffness_off(self) -> float:
        """Static stiffness at the table over that of the elements, less one."""
        point, drive, _, _ = self.case.drawn
        _, K = matrices(drive, point.position)
        true = 1 / np.linalg.solve(K[1:, 1:], np.eye(len(K) - 1)[:, -1])[-1]
        return float(stiffness_budget(self.after.plant, point.position).total / true - 1)

    @property
    def record(self) -> Record:
        """What the table shows, as JSON holds it."""
        return {
            "planted": self.case.drawn[2],
            "may_be_within": self.case.may_be_within,
            "found": [{"name": name} for name in self.named],
            "values": [[p.key, p.value, *p.interval] for one in self.result.asserted for p in one.parameters],
            "frequency_off": self.frequency_off,
            "stiffness_off": self.stiffness_off,
            "error": self.result.error_after,
            "scatter": self.result.scatter,
        }


def explained(case: ResponseCase) -> Explained:
    """The case, diagnosed."""
    axis = case.axis
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = diagnose_response(axis.entries, axis.path, axis.plant, case.response(), case.drawn[0])
    return Explained(case, result)


def response_record(case: ResponseCase, limit: float) -> Record:
    """Record and explain a case; what is raised is kept as its result."""
    begun = time.process_time()
    record: Record = {"machine": case.machine, "what": case.what, "draw": case.draw}
    try:
        with time_limit(limit):
            record |= explained(case).record | {"outcome": "done"}
    except TimeLimitError:
        record |= {"outcome": "time limit"}
    except Exception:
        record |= {"outcome": "raised", "said": traceback.format_exc()}
    return record | {"cpu": time.process_time() - begun}


@dataclass(frozen=True)
class ResponseRow:
    """A record with its questions answered."""

    record: Record

    @property
    def named(self) -> list[str]:
        """Names that are asserted; a declared value by its key."""
        return [one["name"] for one in self.record.get("found", ())]

    @property
    def right(self) -> bool:
        """Whether what was planted is named, or nothing of a part within its tolerance; and the file is right."""
        if self.record["outcome"] != "done":
            return False
        names = NAMES[self.record["what"]]
        if self.named not in names and not (self.record.get("may_be_within", False) and not self.named):
            return False
        off = max(map(abs, self.record["frequency_off"]))
        return off < FREQUENCY and abs(self.record["stiffness_off"]) < STIFFNESS and self.over_scatter < NOTHING_LEFT

    @property
    def over_scatter(self) -> float:
        """What is left over what the lines scatter."""
        return float(self.record["error"] / self.record["scatter"])

    @property
    def told(self) -> str:
        """Values that are named, with their intervals."""
        return ", ".join(
            f"{key} {value:.5g} [{low:.5g}, {high:.5g}]" for key, value, low, high in self.record["values"]
        )

    @property
    def line(self) -> str:
        """The case in a line."""
        head = f"{self.record['key']:36s} {self.record['cpu']:5.0f} s "
        if self.record["outcome"] != "done":
            return head + self.record["outcome"] + " " + str(self.record.get("said", "")).strip()[-300:]
        first, second = (100 * off for off in self.record["frequency_off"])
        planted = ", ".join(f"{one:.5g}" for one in self.record["planted"]) or "nothing"
        return (
            f"{head}{'right' if self.right else 'WRONG'} planted {planted}, named {self.named} {self.told} | "
            f"frequencies {first:+.3f}, {second:+.3f} %, stiffness {100 * self.record['stiffness_off']:+.2f} % | "
            f"error over scatter {self.over_scatter:.3f}"
        )
