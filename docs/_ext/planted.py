"""What an effect does to a residual: planted in a shipped machine, run through the shipped scenarios, compared.

The declared machine predicts torque and table position from the recorded motor motion, as `feeddrive diagnose` does.
What is left is the picture. Its imitators are then fitted in its place; what they leave shows the best scenario.
Results are kept in a folder under a digest of the package, since all effects together take some minutes.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from page_runner import digest

import feeddrive as fd
from feeddrive.diagnosis.certainty.rehearsal import Rehearsal, rehearsals
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.effects.base import Effect

ROOT = Path(__file__).resolve().parents[2]
AXIS = "bench_axis"
SENSORS = ROOT / "tests" / "data" / "bench" / "null_train.csv.gz"
"""A recording without any effect: its sensors' noise is that of the pictures."""

FAITHFUL = 0.2
"""Error of the declared machine about itself, over the noise, up to which a scenario is used: 4 % of its square."""

SIZES: dict[str, dict[str, str]] = {
    "coulomb_asymmetry": {"delta_force": "10 N"},
    "viscous_asymmetry": {"delta_viscous": "60 N s/m"},
    "stribeck": {"delta_force": "25 N", "velocity": "5 mm/s"},
    "presliding": {"stiffness": "6 N/µm"},
    "friction_vs_position": {"peak": "15 N", "centre": "200 mm", "half_width": "50 mm"},
    "friction_deviation": {"coulomb_factor": "1.25", "viscous_factor": "1.1"},
    "load_dependent_friction": {"coefficient": "0.01"},
    "viscous_warmup": {"share": "0.3", "time_constant": "5 s"},
    "torque_ripple": {"amplitude": "0.09 N m", "order": "6", "phase": "0.7 rad"},
    "ball_pass_ripple": {"amplitude": "0.05 N m", "order": "7.6", "phase": "0 rad"},
    "torque_constant_droop": {"share": "0.03", "at_torque": "10 N m"},
    "constant_force": {"force": "20 N"},
    "position_spring": {"stiffness": "120 N/m", "zero": "200 mm"},
    "backlash": {"width": "7.5 um"},
    "lead_error_periodic": {"amplitude": "2 um", "order": "1", "phase": "0.4 rad"},
    "lead_error_cumulative": {"slope": "30 um/m"},
    "thermal_growth": {"strain": "20 um/m", "time_constant": "6 s"},
    "stiffness_deviation": {"factor": "0.75"},
    "stiffness_vs_position": {"share_over_stroke": "0.3", "low": "0 mm", "high": "400 mm"},
    "preload_loss": {"ratio": "0.4", "force": "100 N"},
    "payload": {"mass": "25 kg"},
    "inertia_deviation": {"where": "motor", "inertia": "3e-4 kg m^2"},
    "structural_mode": {"mass": "15 kg", "frequency": "60 Hz", "damping": "0.03"},
    "drive_delay": {"delay": "0.3 ms"},
    "channel_delay": {"channel": "table_position", "delay": "0.3 ms"},
    "motor_heat": {"power": "1 W", "at_speed": "750 rev/min"},
    "bearing_heat": {"factor": "2", "rear_share": "0.5"},
    "ambient_drift": {"amplitude": "2 K", "period": "3600 s"},
    "preload_growth": {"coefficient": "0.02 1/K"},
    "viscosity_temperature": {"coefficient": "0.03 1/K"},
    "cooling": {"conductance": "2 W/K", "start": "3600 s"},
    "convection_deviation": {"where": "all", "factor": "1.3"},
    "contact_conductance_deviation": {"factor": "0.6"},
    "heat_sink": {"conductance": "2 W/K", "capacity": "4000 J/K"},
    "structure_growth": {"growth": "10 um", "slope": "0 um/m", "time_constant": "3600 s"},
    "sensor_lag": {"channel": "nut_temperature", "time_constant": "300 s"},
}
"""A size of every effect that is plain to see and still of the kind that machines have."""

OVER: dict[str, str] = {
    "friction_vs_position": "table_position", "position_spring": "table_position",
    "lead_error_periodic": "turn", "lead_error_cumulative": "table_position", "thermal_growth": "table_position",
    "torque_ripple": "turn", "ball_pass_ripple": "turn", "stiffness_vs_position": "table_position",
    "backlash": "motor_torque", "preload_loss": "motor_torque", "stiffness_deviation": "motor_torque",
    "load_dependent_friction": "motor_torque", "torque_constant_droop": "motor_torque",
    "payload": "acceleration", "inertia_deviation": "acceleration", "structural_mode": "acceleration",
    "presliding": "table_position",
}  # fmt: skip
"""The variable that an effect is best seen over; the table's velocity where none is given."""


@dataclass(frozen=True)
class Seen:
    """How far one scenario shows an effect.

    Attributes:
        scenario: of the shipped ones.
        declared: rms of the declared machine's error over the sensor noise, all channels together.
        imitated: imitator to the rms that it leaves when it is fitted in the effect's place.
    """

    scenario: str
    declared: float
    imitated: dict[str, float]

    @property
    def telling(self) -> float:
        """What the nearest imitator leaves."""
        return min([self.declared, *self.imitated.values()])


@cache
def _sensors() -> AxisEvidence:
    return prepare(fd.read(SENSORS), fd.load(AXIS).plant, 1.0)


def planted(name: str) -> Effect | None:
    """The effect at the size of the pictures; None where no size is given for it."""
    return fd.effect(name, **SIZES[name]) if name in SIZES else None


def imitators_of(effect: Effect) -> list[Effect]:
    """The effects of motion and torque that can look like this one, at a size from which they can be fitted."""
    found = [planted(name) for name in effect.signature.confused_with]
    alike = [one for one in found if one is not None and str(one.kind) != "heat"]
    order = effect.values.get("order")
    return [one.with_values(order=order) if order is not None and "order" in one.values else one for one in alike]


def seen_by_scenarios(effect: Effect, imitators: list[Effect]) -> tuple[list[Seen], dict[str, Rehearsal]]:
    """How far the shipped scenarios show an effect of motion and torque, the most telling first, and their runs."""
    declared = fd.load(AXIS).plant
    found, runs = [], {}
    for run in rehearsals(declared, declared.with_effects(effect), [_sensors()]):
        if run.name not in comparable():
            continue
        problem = Problem(declared, (run.evidence,), AxisPredictor())
        before = _rms(problem.residual([]))
        # an imitator of no size leaves what the declared machine leaves, wherever its fit from a large one ends
        left = {one.name: min(before, _rms(fit(problem, [one], iterations=8).residual)) for one in imitators}
        found.append(Seen(run.name, before, left))
        runs[run.name] = run
    return sorted(found, key=lambda one: -one.telling), runs


@cache
def comparable() -> frozenset[str]:
    """Scenarios in which the declared machine predicts itself, so that what is left is an effect."""
    declared = fd.load(AXIS).plant
    found = rehearsals(declared, declared, [_sensors()])
    return frozenset(
        one.name for one in found if _rms(Problem(declared, (one.evidence,), AxisPredictor()).residual([])) < FAITHFUL
    )


def _rms(residual: Any) -> float:
    value = float(np.sqrt(np.mean(np.square(residual))))
    return value if np.isfinite(value) else float("inf")


def residual_figure(effect: Effect, run: Rehearsal) -> Any:
    """What the declared machine misses in one scenario: over time, and over the variable in which it shows."""
    from matplotlib.figure import Figure

    evidence = run.evidence
    predicted = AxisPredictor().predict(fd.load(AXIS).plant, evidence)
    rows = evidence.counted
    time = evidence.recording.time[rows]
    errors = {name: (evidence.measured[name] - predicted[name])[rows] for name in evidence.channels}
    errors = {name: one - one.mean() * (name in evidence.floating) for name, one in errors.items()}
    channel = max(errors, key=lambda name: float(np.std(errors[name])) / evidence.noise[name])
    words, factor = {"motor_torque": ("torque [N m]", 1.0), "table_position": ("position [µm]", 1e6)}[channel]
    label, over, ahead = _variable(effect.name, evidence, rows)
    figure = Figure(figsize=(7.2, 2.5), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    left.plot(time, factor * errors[channel], color="#1f5f8b", linewidth=0.7)
    left.set(xlabel="time [s]", ylabel=f"measured − declared\n{words}", title=run.name)
    for way, colour, text in ((ahead, "#1f5f8b", "moving +"), (~ahead, "#c8641e", "moving −")):
        right.plot(
            over[way], factor * errors[channel][way], ".", markersize=1.2, color=colour, label=text, rasterized=True
        )
    right.set(xlabel=label, title=f"over {label.split(' [')[0]}")
    right.legend(markerscale=8, fontsize=8, loc="best")
    return figure


def _variable(name: str, evidence: AxisEvidence, rows: Any) -> tuple[str, Any, Any]:
    """Label, values and direction of the variable that an effect is seen over."""
    motion, radius = evidence.motion, fd.load(AXIS).plant.chain.motor_radius
    step = evidence.recording.sample_time
    speed = np.gradient(np.asarray(motion.angle), step)
    ahead = speed[rows] > 0
    turn = np.mod(motion.angle / (2 * np.pi), 1.0)
    choices = {
        "table_position": ("table position [mm]", 1e3 * radius * motion.angle),
        "turn": ("motor angle [turn]", turn),
        "motor_torque": ("motor torque [N m]", evidence.measured.get("motor_torque", motion.angle)),
        "acceleration": ("table acceleration [m/s²]", radius * np.gradient(speed, step)),
    }
    label, values = choices.get(OVER.get(name, ""), ("table velocity [mm/s]", 1e3 * radius * speed))
    return label, np.asarray(values)[rows], ahead


def heat_figure(effect: Effect) -> Any:
    """What an effect of heat does to temperatures and growth of a warm-up of three hours."""
    from matplotlib.figure import Figure

    axis = fd.load("thermal_bench")
    without, with_it = (
        fd.warm_up(one, speed="750 rev/min", duration="180 min") for one in (axis, axis.with_effects(effect))
    )
    minutes = without["time"] / 60.0
    figure = Figure(figsize=(7.2, 2.5), layout="constrained")
    panels = figure.subplots(1, 2)
    for panel, ending, factor, label in (
        (panels[0], "_temperature", 1.0, "change of temperature [K]"),
        (panels[1], "growth", 1e6, "change of growth [µm]"),
    ):
        names = [
            name
            for name in without.channels
            if name.endswith(ending) or name.startswith("table_growth") * (ending == "growth")
        ]
        moved = {name: factor * (with_it[name] - without[name]) for name in names}
        largest = sorted(moved, key=lambda name: -float(np.abs(moved[name]).max()))[:4]
        for name in largest:
            panel.plot(minutes, moved[name], label=name.removesuffix("_temperature").replace("_", " "), linewidth=1.2)
        panel.set(xlabel="time [min]", ylabel=label)
        panel.legend(fontsize=7)
    return figure


@cache
def _state() -> str:
    """Of the package, and of the sizes and pictures here."""
    return digest() + hashlib.sha256(Path(__file__).read_bytes()).hexdigest()[:6]


def kept(folder: Path, name: str) -> dict[str, Any] | None:
    """What was found for an effect by this state of the package; None where it has to be made."""
    path = folder / f"{name}.json"
    if not path.is_file():
        return None
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return found if found.get("digest") == _state() else None


def drawn(folder: Path, effect: Effect) -> dict[str, Any]:
    """Draw an effect into a folder, and give the table of scenarios; taken from there where it was done before."""
    known = kept(folder, effect.name)
    if known is not None:
        return known
    folder.mkdir(parents=True, exist_ok=True)
    if str(effect.kind) == "heat":
        figure, rows = heat_figure(effect), []
    else:
        seen, runs = seen_by_scenarios(effect, imitators_of(effect))
        rows = [{"scenario": one.scenario, "declared": one.declared, "imitated": one.imitated} for one in seen]
        figure = residual_figure(effect, runs[seen[0].scenario])
    figure.savefig(folder / f"{effect.name}.png", dpi=110)
    found = {"digest": _state(), "rows": rows}
    (folder / f"{effect.name}.json").write_text(json.dumps(found), encoding="utf-8")
    return found
