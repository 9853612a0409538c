"""Scenario files: an experiment written down, every number with its unit. Nothing in the file is evaluated.

format = "feeddrive-scenario/1"
name = "positioning with an S-curve"
description = "..."
plant = "bench_axis"                       # shipped name, or a path from the scenario's folder
controller = "controllers/bench_axis.toml" # or a table [controller], see simulate.scenario_controller
travel = ["0 mm", "500 mm"]                # may be left out; a set-point beyond it is refused
[run]
duration = "2 s"                           # left out: that of the trajectory
[record]
rate = "2 kHz"                             # velocity_rate is an integer multiple of it; left out: position_rate
channels = ["setpoint", "motor_torque", "motor_angle", "table_position"]  # left out: these, and what is injected
noise = { table_position = "5 nm" }        # white, standard deviation
quantised = false                          # round to the resolution of the plant's sensors
seed = 1
[trajectory], [excitation], [[force]]      # see simulate.scenario_motion
[[evaluate]]                               # see simulate.scenario_evaluations

What a scenario may ask for: kinds of figures and their settings; `metrology.evaluate` works them out.

[[evaluate]] kind =
  following       start, end                    following error in a stretch of time
  settling        window                        at every stop of the set-point
  positioning     average                       ISO 230-2; mean over the last `average` of each dwell
  circular                                      ISO 230-4 of one axis, quadrant glitches
  friction_map    skip                          mean torque at each constant velocity, the first `skip` left out
  force_loop      start, period                 stiffness and lost motion of one loading cycle
  step            channel, at                   rise, overshoot, settling
  response        input, output, segment, start frequency response by averaged spectra
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from feeddrive import __version__
from feeddrive.errors import InputError
from feeddrive.files import find_plant
from feeddrive.plant.file.effect_sections import read_effects
from feeddrive.plant.file.plant_file import plant_from_entries
from feeddrive.plant.file.plant_schema import EFFECT, PLANT
from feeddrive.plant.passive_friction import refuse_active_friction
from feeddrive.plant.plant import Plant
from feeddrive.recording.channels import CHANNEL_UNITS, channel_unit
from feeddrive.schema.key import Kind
from feeddrive.schema.scenario import scenario
from feeddrive.schema.table import Table, whole_file
from feeddrive.schema.toml_text import read_toml, refuse_other_format
from feeddrive.servo.cascade import Cascade, divider
from feeddrive.servo.linear_loop import refuse_unstable
from feeddrive.servo.vendor_names import with_own_names
from feeddrive.simulate.scenario.scenario import SERIES, Evaluation, Excitation, Place, Recorder, Scenario
from feeddrive.simulate.scenario.scenario_controller import insert_controller, read_cascade
from feeddrive.simulate.scenario.scenario_motion import read_excitation, read_forces, read_trajectory
from feeddrive.simulate.scenario.scenario_overrides import with_absolute_paths, with_overrides
from feeddrive.simulate.setpoints.trajectories import refuse_beyond_travel


def read_evaluations(tables: list[Table]) -> tuple[Evaluation, ...]:
    """The figures of the tables [[evaluate]].

    Raises:
        InputError: unknown kind, key or series, or a value that is missing.
    """
    return tuple(_evaluation(table) for table in tables)


def _evaluation(table: Table) -> Evaluation:
    kind = table.choice("kind")
    table = table.of_kind(kind)
    table.refuse_undeclared()
    settings: dict[str, float | str] = {}
    for name, declared in SCENARIO.sections["evaluate"].kinds[kind].keys.items():
        if declared.required or name in table.entries:
            settings[name] = table.choice(name) if declared.kind is Kind.TEXT else table.quantity(name)
    for key, value in settings.items():
        if isinstance(value, float) and value < 0:
            raise InputError("is negative", table.place(key), "write zero or more")
    return Evaluation(kind, settings)


FORMAT = "feeddrive-scenario/1"
SCENARIO = scenario(EFFECT)
"""What may stand in a scenario file."""

CHANNELS = tuple(name for name in SERIES if name in CHANNEL_UNITS)
"""What can be recorded, besides the time."""
_USUAL = ("setpoint", "motor_torque", "motor_angle", "table_position")
_INJECTED = {Place.SPEED: "injected_speed", Place.TORQUE: "injected_torque"}
_LONGEST = 2e9
"""Ticks: three days at 8 kHz; more is a slip of a unit."""


@dataclass(frozen=True)
class GivenPlant:
    """A plant in place of the one that a scenario names.

    Attributes:
        plant: the machine.
        content: bytes that are the same where the machine is the same.
    """

    plant: Plant
    content: bytes


def read_scenario(
    path: Path,
    overrides: Mapping[str, str] | None = None,
    given: GivenPlant | None = None,
    controller: Mapping[str, Any] | None = None,
) -> Scenario:
    """Read a scenario file.

    Args:
        path: of the file.
        overrides: dotted key to text, put in place of what the file says; "plant.table.mass" and the like lead into
            the plant file. Paths among them count from the current folder, those in the file from its folder.
        given: plant in place of the one that the file names.
        controller: entries in place of those of the file.

    Raises:
        InputError: not found, not TOML, unknown key, a value missing or impossible, rates that do not fit, a motion
            beyond the travel, an unstable loop that is not allowed.
    """
    where = str(path)
    entries = read_toml(path, "scenario file")
    refuse_other_format(entries, FORMAT, where)
    wanted = with_absolute_paths(overrides or {})
    of_plant = {key.removeprefix("plant."): wanted.pop(key) for key in list(wanted) if key.startswith("plant.")}
    if "controller" in wanted:
        entries["controller"] = wanted.pop("controller")
    if controller is not None:
        entries["controller"] = dict(controller)
    controller_where = insert_controller(entries, path)
    entries = with_overrides(entries, _own_keys(wanted))
    top = whole_file(entries, where, SCENARIO)
    top.refuse_undeclared(_elsewhere(wanted))
    if given is None:
        plant_path = _plant_path(top, path.parent)
        given = GivenPlant(_plant(plant_path, of_plant), plant_path.read_bytes())
    plant = given.plant.with_effects(*read_effects(top))
    refuse_active_friction(plant, where)
    written = top.table("controller")
    cascade, unstable = read_cascade(Table(written.entries, controller_where, top.origins), plant)
    _require(top, "trajectory")
    trajectory = read_trajectory(top.table("trajectory"))
    excitation = read_excitation(top.table("excitation")) if "excitation" in entries else None
    ticks = _ticks(top, cascade, trajectory.duration)
    travel = _travel(top) if "travel" in entries else plant.stroke
    if travel is not None:
        refuse_beyond_travel(trajectory, travel, cascade.sample_time * cascade.position_divider, where)
    if not unstable:
        refuse_unstable(plant, cascade, controller_where, plant.middle)
    return Scenario(
        name=top.text("name", path.stem), description=top.text("description", ""), plant=plant, cascade=cascade,
        trajectory=trajectory, force=read_forces(top.tables("force"), path.parent), excitation=excitation,
        recorder=_recorder(top, cascade, excitation), ticks=ticks, evaluations=read_evaluations(top.tables("evaluate")),
        digest=_digest(entries, path.parent, given.content, of_plant),
    )  # fmt: skip


def _elsewhere(overrides: Mapping[str, str]) -> dict[str, str]:
    """What is to be written for keys that are set as if they were the scenario's: those of its controller and plant."""
    found: dict[str, str] = {}
    for owner, section in (("plant", PLANT), ("controller", SCENARIO.sections["controller"])):
        of_owner = (key for key in overrides if key.partition(".")[0] in section.names())
        found |= {key.partition(".")[0]: f"write {owner}.{key}" for key in of_owner}
    return found


def _own_keys(overrides: Mapping[str, str]) -> dict[str, str]:
    """Overrides of the controller under our names, so that they meet what the file says."""
    start = "controller."
    settings = {key.removeprefix(start): value for key, value in overrides.items() if key.startswith(start)}
    others = {key: value for key, value in overrides.items() if not key.startswith(start)}
    return others | {start + key: value for key, value in with_own_names(settings, "--set").items()}


def _require(top: Table, key: str) -> None:
    if key not in top.entries:
        raise InputError(f"{key} is missing", top.where, f"write a table [{key}]")


def _plant_path(top: Table, folder: Path) -> Path:
    named = top.text("plant")
    beside = folder / named
    return beside if beside.is_file() else find_plant(named)


def _plant(path: Path, overrides: Mapping[str, str]) -> Plant:
    return plant_from_entries(with_overrides(read_toml(path, "plant file"), overrides), path)


def _ticks(top: Table, cascade: Cascade, trajectory: float) -> int:
    run = top.table("run")
    run.refuse_undeclared()
    duration = run.positive("duration") if "duration" in run.entries else trajectory
    ticks = math.ceil(duration / cascade.sample_time - 1e-6)
    if not 2 <= ticks <= _LONGEST:
        what = f"a run of {duration:g} s is {ticks} ticks"
        raise InputError(what, run.where, f"2 to {_LONGEST:g} are possible; check the units")
    return ticks


def _travel(top: Table) -> tuple[float, float]:
    ends = top.listed("travel")
    if len(ends) != 2 or ends[1] <= ends[0]:
        raise InputError("is not two ascending positions", top.place("travel"), 'write travel = ["0 mm", "500 mm"]')
    return ends[0], ends[1]


def _recorder(top: Table, cascade: Cascade, excitation: Excitation | None) -> Recorder:
    table = top.table("record")
    table.refuse_undeclared()
    ticks = cascade.position_divider
    if "rate" in table.entries:
        ticks = divider(1 / cascade.sample_time, table.positive("rate"), table.place("rate"))
    injected = () if excitation is None else (_INJECTED[excitation.place],)
    channels = table.words("channels", (*_USUAL, *injected))
    for channel in channels:
        Table({"channel": channel}, table.place("channels"), top.origins).choice("channel", CHANNELS)
    inner = table.table("noise")
    inner.refuse_unknown((*channels, "source"))
    noise = {
        name: inner.quantity(name, channel_unit(name, inner.where), name) for name in channels if name in inner.entries
    }
    if any(value < 0 for value in noise.values()):
        raise InputError("a noise is negative", inner.where, "write its standard deviation")
    return Recorder(ticks, channels, noise, table.switch("quantised"), table.whole("seed"))


def _digest(entries: Mapping[str, Any], folder: Path, plant: bytes, overrides: Mapping[str, str]) -> str:
    """Checksum of the version, the scenario with its controller, the plant, overrides, and the files of forces."""
    content = hashlib.sha256(__version__.encode())
    content.update(json.dumps([entries, overrides], sort_keys=True, default=str).encode())
    content.update(plant)
    for force in entries.get("force", []):
        if "path" in force:
            content.update((folder / force["path"]).read_bytes())
    return content.hexdigest()
