"""What is planted in the machines of parts, and in which sizes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from feeddrive.files import find_plant
from feeddrive.plant.analysis.lumping import lump
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from tests.generator.screw_elements import Drive, drive_of
from tests.recovery.parts_runs import MARGIN, made, softer

MACHINES = ("kimm_testbed", "hsr_axis", "vertical_axis")
SECONDS, JUDGED = 9.0, 7.0
"""Fitted and judged [s]."""

KNOWN_MASS = ("kimm_testbed",)
"""Machines whose table was weighed; the others' mass is known to 30 %."""

SOFT = {"nut": ("nut", 0.8), "bearing": ("near", 0.7), "drive": ("coupling", 0.75)}
"""Part, as the diagnosis calls it, to the field of the generator's drive and its share of the declared stiffness."""

WHAT = ("nothing", "nut", "bearing", "drive", "payload", "backlash", "bump", "lead", "stribeck")
"""Nothing, a softer part (nut -20 %, bearing -30 %, coupling -25 %), or an effect of which the size is drawn."""

NULLS = 10
"""Recordings with nothing planted, and as many frequency responses, of the machines in turn, the noise drawn anew."""

PUBLISHED = 200
"""Draws below are for development or were published once; those of the published table begin here."""

ALONE = {"vertical_axis": 25.0, "kimm_testbed": 40.0, "hsr_axis": 55.0}
"""Processor seconds of a machine with nothing planted, about: the cheap are run first."""

TIMES = {
    "nothing": 1.0, "nut": 1.2, "drive": 1.2, "coupling": 1.2, "bump": 1.4, "stribeck": 2.2, "lead": 2.2,
    "mode": 3.0, "payload": 3.5, "bearing": 4.5, "backlash": 6.0,
}  # fmt: skip
"""Of that with something planted, about."""


@dataclass(frozen=True)
class Case:
    """A machine with one thing planted, or none; the draw decides its size and the noise.

    With `lumped` it is diagnosed with the file of three inertias that `feeddrive lump` writes of it.
    """

    machine: str
    what: str
    draw: int
    lumped: bool = False

    @property
    def kind(self) -> str:
        """What of a machine is diagnosed, and with which file."""
        return "lumped" if self.lumped else "recording"

    @property
    def key(self) -> str:
        """What a record of it is found by."""
        return f"{self.machine} {self.what} {self.draw}{' lumped' if self.lumped else ''}"

    @property
    def cost(self) -> float:
        """Processor seconds, about."""
        return ALONE[self.machine] * TIMES[self.what]

    @property
    def plant(self) -> Plant:
        """The machine as its file declares it."""
        plant = read_plant(find_plant(self.machine))
        return lump(plant).plant if self.lumped else plant

    @cached_property
    def drive(self) -> Drive:
        """The declared drive."""
        return drive_of(find_plant(self.machine))

    @cached_property
    def planted(self) -> tuple[tuple[tuple[str, Any], ...], str, dict[str, Any]]:
        """What the generator changes, the effect that says so, and its values (SI); a part's is a factor."""
        random = np.random.default_rng([20261122, self.draw, MACHINES.index(self.machine), WHAT.index(self.what)])
        if self.what == "nothing":
            return (), "", {}
        if self.what in SOFT:
            part, factor = SOFT[self.what]
            changes = softer(self.drive, part, factor)
            if part == "coupling":
                before, after = (sum(1 / k for k, _ in springs) for springs in (self.drive.springs, changes[0][1]))
                factor = before / after
            return changes, "stiffness_deviation", {"part": self.what, "factor": factor}
        low, high = stroke_of(self.machine)
        match self.what:
            case "payload":
                share = random.uniform(0.1, 0.3) if self.machine in KNOWN_MASS else random.uniform(0.4, 0.8)
                changes = (("table", (1 + share) * self.drive.table),)
                return changes, "payload", {"mass": share * self.drive.table}
            case "backlash":
                width = random.uniform(2e-6, 8e-6)
                return (("backlash", width),), "backlash", {"width": width}
            case "bump":
                peak, half = random.uniform(20.0, 60.0), random.uniform(0.02, 0.05)
                centre = random.uniform(low + MARGIN + 2 * half, high - MARGIN - 2 * half)
                truth = {"peak": peak, "centre": centre, "half_width": half}
                return (("bump", (peak, centre, half)),), "friction_vs_position", truth
            case "lead":
                amplitude, order = random.uniform(0.5e-6, 3e-6), float(random.integers(1, 4))
                phase = random.uniform(-math.pi, math.pi)
                # the generator's order is of the screw, the effect's as well
                truth = {"amplitude": amplitude, "order": order, "phase": phase}
                return (("lead_error", (amplitude, order, phase)),), "lead_error_periodic", truth
        assert self.what == "stribeck"
        force, velocity = random.uniform(15.0, 50.0), random.uniform(0.002, 0.010)
        return (("stribeck", (force, velocity)),), "stribeck", {"delta_force": force, "velocity": velocity}

    def recordings(self) -> tuple[Recording, Recording]:
        """To fit and to judge."""
        changes, seed = self.planted[0], 2 * self.draw + 1
        made_of = (
            made(self.machine, seconds, validate, seed + validate, changes)
            for seconds, validate in ((SECONDS, False), (JUDGED, True))
        )
        fitted, judged = made_of
        return fitted, judged


def stroke_of(machine: str) -> tuple[float, float]:
    """Ends of the stroke [m]."""
    stroke = read_plant(find_plant(machine)).stroke
    assert stroke is not None
    return stroke
