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
    "Bode": "interface.bode",
    "Check": "interface.machine_tables",
    "Compensation": "interface.compensating",
    "Controller": "interface.design",
    "Diagnosed": "interface.diagnosed",
    "Draft": "interface.drafts",
    "Effect": "effects.base",
    "Explained": "interface.explaining",
    "InputError": "errors",
    "Iso230": "interface.iso230",
    "Keys": "interface.keys",
    "Life": "interface.machine_tables",
    "Modes": "interface.machine_tables",
    "Motion": "interface.motion",
    "Parts": "interface.drafts",
    "Recording": "recording.recording",
    "Run": "interface.experiments",
    "Servo": "interface.servo",
    "Stiffness": "interface.machine_tables",
    "Sweep": "interface.sweeping",
    "ValidityWarning": "errors",
    "WarmUp": "interface.warm_up",
    "Watched": "interface.watching",
    "bench": "interface.benching",
    "cascade": "interface.design",
    "compensate": "interface.compensating",
    "diagnose": "interface.diagnosed",
    "draft": "interface.drafts",
    "effect": "interface.shipped",
    "explain": "interface.explaining",
    "iso230": "interface.iso230",
    "keys": "interface.keys",
    "list_effects": "interface.shipped",
    "list_parts": "interface.drafts",
    "list_plants": "interface.shipped",
    "list_scenarios": "interface.shipped",
    "load": "interface.axis",
    "move": "interface.motion",
    "read": "interface.reading",
    "run": "interface.experiments",
    "sampled": "interface.design",
    "schedule": "interface.design",
    "si": "interface.quantities",
    "state_feedback": "interface.design",
    "sweep": "interface.sweeping",
    "tune": "interface.servo",
    "warm_up": "interface.warm_up",
    "watch": "interface.watching",
    "with_load": "interface.design",
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
