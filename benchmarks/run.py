"""Times the engine beside others on one drive and writes results.md: `make bench`, some minutes.

Ratios are of processor time, from interleaved calls in one process. The slow peers run a part of the stroke and are
told for the whole of it; the table says so.
"""

from __future__ import annotations

import os
import platform
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from _drive import DURATION, LAG, controller, drive, wanted_position
from _hand import Exact, RungeKutta
from _light import light_errors
from _peers import cvodes, radau
from _timing import interleaved, once

from feeddrive.compiler import find_compiler
from feeddrive.plant.structure import forget_machines
from feeddrive.simulate.controlled import ControlledRun, TorqueLoop, simulate_controlled
from feeddrive.simulate.sensitivity import Sensitivity, simulate_sensitivity
from feeddrive.typing import FloatArray

HERE = Path(__file__).resolve().parent
LOOP = TorqueLoop(lag=LAG)
ORACLE_SUBSTEPS = 256
"""Runge and Kutta with 512 substeps differs from this by 1e-14 m."""


@dataclass(frozen=True)
class Figure:
    """One line of the results: what, as it is, what is asked for, whether it is met."""

    what: str
    found: str
    asked: str
    met: bool


CONTROLLER, WANTED = controller(), wanted_position()
DRIVES = {bump: drive(bump) for bump in (False, True)}
"""Plants, controller and set-point are made before, as those of the hand-written C are."""


def simulated(bump: bool = False) -> ControlledRun:
    """The whole call that a user makes: two seconds at 8 kHz."""
    return simulate_controlled(DRIVES[bump], CONTROLLER, WANTED[:, None], None, LOOP)


NAMES = (
    "table_mass", "motor_inertia", "nut_stiffness", "damping_time", "guide_friction.coulomb", "guide_friction.viscous",
    "presliding.stiffness", "stribeck.velocity",
)  # fmt: skip


def gradient() -> Sensitivity:
    """The same run with its derivatives in eight directions."""
    return simulate_sensitivity(DRIVES[False], CONTROLLER, WANTED[:, None], NAMES, torque_loop=LOOP)


def building() -> float:
    """Processor time to make the machine of the gradient from nothing: equations, derivatives, C, compiler [s]."""
    with tempfile.TemporaryDirectory() as folder:
        kept = os.environ.get("XDG_CACHE_HOME")
        os.environ["XDG_CACHE_HOME"] = folder
        forget_machines()
        begin = sum(os.times()[:4])  # the compiler's, too
        simulate_sensitivity(drive(), controller(), wanted_position(2)[:, None], NAMES, torque_loop=LOOP)
        taken = sum(os.times()[:4]) - begin
        forget_machines()
        if kept is None:
            del os.environ["XDG_CACHE_HOME"]
        else:
            os.environ["XDG_CACHE_HOME"] = kept
    return taken


def correct_substeps(rk: RungeKutta, oracle: FloatArray) -> int:
    """Fewest substeps of Runge and Kutta with which the table is right to 1 nm."""
    wanted = wanted_position()
    return next(n for n in range(8, 200) if np.abs(rk.run(wanted, n) - oracle).max() < 1e-9)


def in_virtual_machine() -> tuple[float, FloatArray]:
    """Processor time of the stroke without a compiler [s], and the table position [m]."""
    os.environ["FEEDDRIVE_COMPILER"] = "none"
    find_compiler.cache_clear()
    forget_machines()
    simulated()
    seconds = min(once(simulated) for _ in range(9))
    table = simulated().table_position
    del os.environ["FEEDDRIVE_COMPILER"]
    find_compiler.cache_clear()
    forget_machines()
    return seconds, table


def figures() -> list[Figure]:
    """Everything measured."""
    wanted, rk, hand, bumpy = wanted_position(), RungeKutta.made(), Exact.made(), Exact.made(bump=True)
    oracle = rk.run(wanted, ORACLE_SUBSTEPS)
    fewest = correct_substeps(rk, oracle)
    seconds = interleaved(
        {
            "engine": simulated, "hand": lambda: hand.run(wanted), "rk4": lambda: rk.run(wanted, fewest),
            "engine bump": lambda: simulated(True), "hand bump": lambda: bumpy.run(wanted),
            "gradient": gradient,
        }
    )  # fmt: skip
    engine, mine = simulated(), hand.run(wanted)
    error, hand_error = (np.abs(x - oracle).max() for x in (engine.table_position, mine[:, 5]))
    part = 400
    slow = once(lambda: radau(rk, wanted[:part], 1e-6)) * len(wanted) / part
    of_casadi = once(lambda: cvodes(wanted, 1e-6))
    virtual, table = in_virtual_machine()
    apart = np.abs(table - engine.table_position).max() / np.abs(table).max()
    by_effect = (seconds["engine bump"] - seconds["engine"]) / (seconds["hand bump"] - seconds["hand"])
    e = seconds["engine"]
    return [
        _at_most("engine over hand-written C of the scheme", e / seconds["hand"], 1.3),
        Figure("the same, in milliseconds", f"{1e3 * e:.2f} and {1e3 * seconds['hand']:.2f}", "", True),
        _at_most("error of the engine [nm]", 1e9 * error, 1.0),
        _at_most("error of the hand-written C [nm]", 1e9 * hand_error, 1.0),
        _at_least(f"Runge-Kutta in C, {fewest} substeps, over the engine", seconds["rk4"] / e, 10),
        _at_least("scipy Radau 1e-6 over the engine (0.05 s run, told for 2 s)", slow / e, 1000),
        _at_least("CasADi cvodes 1e-6 over the engine", of_casadi / e, 200),
        _at_least("virtual machine, times real time", DURATION / virtual, 50),
        _at_most("compiled and virtual machine apart, of full scale", apart, 1e-12),
        _at_most("cost of a friction bump over the same in hand-written C", by_effect, 1.3),
        _at_most("gradient in 8 directions, over the engine's run", seconds["gradient"] / e, 20),
        _at_most("gradient, built from nothing [s]", building(), 3.0),
        *[_at_most(f"light axis at {rate:g} kHz, error [nm]", 1e9 * worst, 5.0) for rate, worst in light_errors()],
    ]


def _at_most(what: str, found: float, limit: float) -> Figure:
    return Figure(what, f"{found:.3g}", f"<= {limit:g}", bool(found <= limit))


def _at_least(what: str, found: float, limit: float) -> Figure:
    return Figure(what, f"{found:.3g}", f">= {limit:g}", bool(found >= limit))


def table_of(found: list[Figure]) -> str:
    """The results as a page."""
    lines = [
        "# Results of `make bench`", "",
        f"Machine: {_processor()}, {os.cpu_count()} cores, Python {platform.python_version()}.",
        "Processor time, medians of interleaved calls in one process; the drive is that of `_drive.py`, 2 s at 8 kHz.",
        "The engine's time is that of the whole call: constants, loop and result. Its error is against Runge and Kutta",
        f"with {ORACLE_SUBSTEPS} substeps in C, which shares nothing with it.", "",
        "| what | found | asked for | met |", "|---|---|---|---|",
    ]  # fmt: skip
    lines += [f"| {f.what} | {f.found} | {f.asked} | {'yes' if f.met else 'NO'} |" for f in found]
    return "\n".join(lines) + "\n"


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), platform.machine())


def main(write: Callable[[str], int] = sys.stdout.write) -> None:
    """Measure, print, keep."""
    page = table_of(figures())
    (HERE / "results.md").write_text(page, encoding="utf-8")
    write(page)


if __name__ == "__main__":
    main()
