"""feeddrive: a control plant of machine-tool ball-screw feed drives that closes the loop with measured data.

    import feeddrive as fd

    axis = fd.load("bench_axis")
    found = fd.diagnose(axis, fd.read("monday.csv"), validate=fd.read("tuesday.csv"))

Every name below is loaded when it is first used, so that the import takes no time. What is not listed in `__all__` may
change without notice.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

__version__ = "0.1.0"

_HOMES = {
    "Axis": "interface.axis",
    "Bench": "interface.benching",
    "Bode": "interface.machine.bode",
    "Check": "interface.machine.check",
    "Compensation": "interface.compensating",
    "Controller": "interface.runs.controllers",
    "Diagnosed": "interface.measured.diagnosed",
    "Draft": "interface.machine.drafts",
    "Effect": "effects.base",
    "Explained": "interface.measured.explaining",
    "Fleet": "interface.measured.fleet",
    "HeatSummary": "interface.machine.heat_summary",
    "InputError": "errors",
    "Inspected": "interface.measured.inspected",
    "Iso230": "interface.measured.iso230",
    "Keys": "interface.keys",
    "Life": "interface.machine.check",
    "Lumped": "interface.machine.modes",
    "Modes": "interface.machine.modes",
    "Motion": "interface.runs.motion",
    "Parts": "interface.machine.drafts",
    "Recording": "recording.recording",
    "Repeated": "interface.runs.cycles",
    "Run": "interface.runs.scenario",
    "Servo": "interface.servo",
    "Stiffness": "interface.machine.summary",
    "Summary": "interface.machine.summary",
    "Sweep": "interface.runs.sweep",
    "ThermalCompensation": "interface.runs.thermal_compensation",
    "ThermalTrial": "interface.runs.thermal_trial",
    "UsedLife": "interface.machine.check",
    "ValidityWarning": "errors",
    "WarmUp": "interface.runs.warm_up",
    "Watched": "interface.measured.watching",
    "bench": "interface.benching",
    "cascade": "interface.runs.controllers",
    "compensate": "interface.compensating",
    "diagnose": "interface.measured.diagnosed",
    "draft": "interface.machine.drafts",
    "effect": "interface.shipped",
    "explain": "interface.measured.explaining",
    "inspect": "interface.measured.inspection",
    "iso230": "interface.measured.iso230",
    "keys": "interface.keys",
    "list_effects": "interface.shipped",
    "list_parts": "interface.machine.drafts",
    "list_plants": "interface.shipped",
    "list_scenarios": "interface.shipped",
    "load": "interface.axis",
    "move": "interface.runs.motion",
    "read": "interface.measured.reading",
    "repeat": "interface.runs.cycles",
    "run": "interface.runs.scenario",
    "sampled": "interface.runs.controllers",
    "schedule": "interface.runs.controllers",
    "shipped": "interface.shipped",
    "si": "interface.quantities",
    "state_feedback": "interface.runs.controllers",
    "sweep": "interface.runs.sweep",
    "thermal_compensation": "interface.runs.thermal_compensation",
    "tune": "interface.servo",
    "warm_up": "interface.runs.warm_up",
    "watch": "interface.measured.watching",
    "watch_fleet": "interface.measured.fleet",
    "with_load": "interface.runs.controllers",
}

__all__ = ["__version__", *sorted(_HOMES)]


def __getattr__(name: str) -> Any:
    """A public name, imported on first use (PEP 562)."""
    if name not in _HOMES:
        raise AttributeError(f"module 'feeddrive' has no attribute {name!r}")
    value = getattr(import_module(f"feeddrive.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """The public names."""
    return list(__all__)
