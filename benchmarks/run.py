"""Times the engine beside others on one drive, each with its error, and writes results.md: `make bench`, some minutes.

Ratios are of processor time, from interleaved calls in one process; bounds are those of docs/claims.toml.
"""

from __future__ import annotations

import argparse
import os
import platform
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from _drive import DURATION, LAG, controller, drive, wanted_position
from _hand import Exact, RungeKutta
from _light import light_errors
from _peers import cvodes, radau, radau_of_known_torque, run_cvodes
from _timing import interleaved, median, once, ratio

from feeddrive.compiler import find_compiler
from feeddrive.plant.structure import forget_machines
from feeddrive.simulate.controlled.controlled import ControlledRun, TorqueLoop, simulate_controlled
from feeddrive.simulate.controlled.sensitivity import Sensitivity, simulate_sensitivity
from feeddrive.typing import FloatArray

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

from tests.claims.book import CLAIMS, keep  # noqa: E402

LOOP = TorqueLoop(lag=LAG)
ORACLE_SUBSTEPS = 256
"""Runge and Kutta with 512 substeps differs from this by 1e-14 m."""


@dataclass(frozen=True)
class Figure:
    """One line of the results: what, as it is, what is claimed, whether it is inside; None where nothing is."""

    what: str
    found: str
    claimed: str
    inside: bool | None


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


def in_virtual_machine(rounds: int = 9) -> tuple[float, FloatArray]:
    """Median processor time of the stroke without a compiler [s], and the table position [m]."""
    os.environ["FEEDDRIVE_COMPILER"] = "none"
    find_compiler.cache_clear()
    forget_machines()
    table = simulated().table_position
    seconds = median([once(simulated) for _ in range(rounds)])
    del os.environ["FEEDDRIVE_COMPILER"]
    find_compiler.cache_clear()
    forget_machines()
    return seconds, table


def figures(one_call: bool) -> list[Figure]:
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
    engine, e, mine = simulated(), seconds["engine"], hand.run(wanted)
    virtual, table = in_virtual_machine()
    apart = np.abs(table - engine.table_position).max() / np.abs(table).max()
    bump = median(seconds["engine bump"]) - median(e), median(seconds["hand bump"]) - median(seconds["hand"])
    return [
        _figure("engine.over_c", "engine over hand-written C of the scheme", ratio(e, seconds["hand"])),
        _told("the same, in milliseconds", f"{1e3 * median(e):.2f} and {1e3 * median(seconds['hand']):.2f}"),
        _figure("engine.error", "error of the engine [nm]", _apart(engine.table_position, oracle)),
        _told("error of the hand-written C [nm]", f"{_apart(mine[:, 5], oracle):.3g}"),
        _figure("engine.rk4", f"Runge-Kutta in C, {fewest} substeps, over the engine", ratio(seconds["rk4"], e)),
        _told("its error [nm]", f"{_apart(rk.run(wanted, fewest), oracle):.3g}"),
        *_solvers(rk, oracle, np.asarray(engine.command).ravel(), one_call),
        _figure("engine.vm", "virtual machine, times real time", DURATION / virtual),
        _figure("engine.compiler", "virtual machine over the compiled engine", virtual / median(e)),
        _figure("engine.vm_apart", "compiled and virtual machine apart, of full scale", apart),
        _figure("engine.bump", "cost of a friction bump over the same in hand-written C", bump[0] / bump[1]),
        _figure("gradient.runs", "gradient in 8 directions, over the engine's run", ratio(seconds["gradient"], e)),
        _figure("gradient.built", "gradient, built from nothing [s]", median([building() for _ in range(3)])),
        *[
            _figure("engine.light", f"light axis at {rate:g} kHz, error [nm]", 1e9 * far)
            for rate, far in light_errors()
        ],
    ]


def _solvers(rk: RungeKutta, oracle: FloatArray, commands: FloatArray, one_call: bool) -> list[Figure]:
    """General solvers over the whole stroke, in turn with the engine, and how far they are off."""
    many, tables = cvodes(WANTED, 1e-6), {}
    tables["cvodes"] = run_cvodes(many, WANTED)

    def by_radau() -> None:
        tables["radau"] = radau(rk, WANTED, 1e-6)

    calls = {"engine": simulated, "cvodes": lambda: run_cvodes(many, WANTED), "radau": by_radau}
    seconds = interleaved(calls, rounds=3, warm=False)
    found = [
        _figure("engine.radau", "scipy Radau 1e-6, compiled right-hand side, over the engine",
                ratio(seconds["radau"], seconds["engine"])),
        _told("its error [nm]", f"{_apart(tables['radau'], oracle):.3g}"),
        _figure("engine.cvodes", "CasADi cvodes 1e-6, compiled, over the engine",
                ratio(seconds["cvodes"], seconds["engine"])),
        _told("its error [nm]", f"{_apart(tables['cvodes'], oracle):.3g}"),
    ]  # fmt: skip
    if one_call:
        taken = once(lambda: tables.update(whole=radau_of_known_torque(rk, commands, 1e-6)))
        times = taken / median(seconds["radau"])
        found.append(_told("Radau in one call under known torque, over Radau started at every sample (one run)",
                           f"{times:.3g}"))  # fmt: skip
        found.append(_told("its error [nm]", f"{_apart(tables['whole'], oracle):.3g}"))
    return found


def _apart(table: FloatArray, oracle: FloatArray) -> float:
    """Largest error [nm]."""
    return float(1e9 * np.abs(table - oracle).max())


def _figure(key: str, what: str, found: float) -> Figure:
    """A figure that is claimed, kept for `make check`."""
    claim = CLAIMS[key]
    keep(key, found)
    return Figure(what, f"{found:.3g}", claim.bound(), claim.inside(found))


def _told(what: str, found: str) -> Figure:
    """A figure of which nothing is claimed."""
    return Figure(what, found, "", None)


def table_of(found: list[Figure], load: str) -> str:
    """The results as a page."""
    lines = [
        "# Results of `make bench`", "",
        f"Machine: {_processor()}, {os.cpu_count()} cores, Python {platform.python_version()}; load {load}.",
        "Processor time; ratios are medians of interleaved calls in one process; the drive is that of `_drive.py`, 2 s",
        "at 8 kHz. The engine's time is that of the whole call: constants, loop and result. Errors are the largest of",
        f"the table position, against Runge and Kutta with {ORACLE_SUBSTEPS} substeps in C, which shares nothing with",
        "it. The general solvers run the whole stroke, started at every sample, where the torque steps.", "",
        "| what | found | claimed | inside |", "|---|---|---|---|",
    ]  # fmt: skip
    inside = {True: "yes", False: "NO", None: ""}
    lines += [f"| {f.what} | {f.found} | {f.claimed} | {inside[f.inside]} |" for f in found]
    return "\n".join(lines) + "\n"


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), platform.machine())


def main(arguments: list[str] | None = None) -> None:
    """Measure, print, keep."""
    parser = argparse.ArgumentParser(description="timings beside those of other programs; writes results.md")
    parser.add_argument("--one-call", action="store_true", help="Radau without starting anew, too: minutes more")
    options = parser.parse_args(arguments)
    before = os.getloadavg()[0]
    found = figures(options.one_call)
    page = table_of(found, f"{before:.1f} before and {os.getloadavg()[0]:.1f} after")
    (HERE / "results.md").write_text(page, encoding="utf-8")
    sys.stdout.write(page)


if __name__ == "__main__":
    main()
