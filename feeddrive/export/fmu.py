"""An FMU of the equations of motion: FMI 2.0 for model exchange, with units, sources and, here, a binary.

    fmpy.simulate_fmu("bench_axis.fmu", stop_time=0.1, start_values={"motor_torque": 1.5})

Its states are the table's position and velocity and what shafts and nut have beside them (`export.beside_table`).

The binary is compiled from the generated C and needs nothing but the C library: no Python, no feeddrive. It runs on
the platform that exported it; the sources inside the FMU are whole, so that a tool can compile them for another. Where
no compiler is found the FMU holds the sources alone.

Written here and not by CasADi's own export, which is marked experimental, is not in every version that feeddrive runs
with, and needs headers that do not come with it.

Equations of motion in states beside the table, so that a solver's relative tolerance meets springs and not turns.

    q_i = y_i + G_i x,     y_i' likewise,     x and the bristles as they are

A shaft that stands at 30 rad, integrated to 1e-6 of that, leaves its springs uncertain by 0.1 µm, tens of newtons; the
angle by which it stands beside the table, microradians, is integrated to 1e-6 of itself.

| symbol | meaning | unit |
|---|---|---|
| q, x | coordinates of the chain, and its last one, the table position | rad, m |
| G | motion of the chain where nothing is stretched, per travel of the table | rad/m, 1 |
| y | what a coordinate has beyond G x | rad, m |
"""

from __future__ import annotations

import hashlib
import io
import platform
import sys
import tempfile
import zipfile
from dataclasses import replace
from pathlib import Path

import casadi as ca
import numpy as np

from feeddrive.compiler import CompilerError, run_compiler
from feeddrive.errors import InputError
from feeddrive.export.c_source import call, comment, header_text, numbers, source_text
from feeddrive.export.fmu_description import description_text, fixed_parameters
from feeddrive.export.kinks import Kinks, kinks_of
from feeddrive.export.nonlinear_model import Model, nominals
from feeddrive.plant.structure import chain_symbols, parameter_symbols
from feeddrive.symbolic_turn import SYMBOLS
from feeddrive.typing import Expression

_WRAPPER = "fmi2_model_exchange.c"
_FLAGS = ("-O1", "-ffp-contract=off", "-fPIC", "-shared", "-fvisibility=hidden")
_EARLIEST = (1980, 1, 1, 0, 0, 0)  # of a zip file; the same export gives the same file


def fmu_bytes(model: Model, compiler: str | None) -> bytes:
    """The FMU of equations in the plant's own states, with a binary where there is a C compiler.

    Raises InputError where the compiler fails.
    """
    model = beside_table(model)
    name, kinks = model.identifier, kinks_of(model)
    sources = {f"{name}.h": header_text(model), f"{name}.c": source_text(model), _WRAPPER: _wrapper()}
    sources[f"{name}_events.c"] = _events_text(name, kinks)
    guid = hashlib.sha256("".join([*sources.values(), *model.heading]).encode()).hexdigest()[:32]
    sources["fmu_model.h"] = _sizes(model, guid, kinks)
    compiled = (f"{name}.c", f"{name}_events.c", _WRAPPER)
    files = {"modelDescription.xml": description_text(model, guid, compiled, kinks.count).encode()}
    if compiler is not None:
        folder, suffix = binary_platform()
        files[f"binaries/{folder}/{name}{suffix}"] = _compiled(sources, compiled, compiler)
    files |= {f"sources/{file}": text.encode() for file, text in sources.items()}
    return _packed(files)


def binary_platform() -> tuple[str, str]:
    """Folder of FMI 2.0 for binaries of this platform, and the suffix of a shared library."""
    bits = "64" if sys.maxsize > 2**32 else "32"
    system, suffix = {"Windows": ("win", ".dll"), "Darwin": ("darwin", ".dylib")}.get(
        platform.system(), ("linux", ".so")
    )
    return f"{system}{bits}", suffix


def _wrapper() -> str:
    return (Path(__file__).parent / _WRAPPER).read_text(encoding="utf-8")


def _sizes(model: Model, guid: str, kinks: Kinks) -> str:
    """fmu_model.h: what the wrapper asks for."""
    name, upper = model.identifier, model.identifier.upper()
    given = "double time, const double x[], const double u[], const double p[]"
    lines = [
        f'#include "{name}.h"',
        f'#define MODEL_GUID "{guid}"',
        *(f"#define MODEL_{of} {upper}_{of}" for of in ("STATES", "INPUTS", "OUTPUTS", "PARAMETERS")),
        f"#define MODEL_FIXED {fixed_parameters(model)}",
        f"#define MODEL_INDICATORS {kinks.count}",
        f"#define MODEL_HELD {name}_held",
        f"#define MODEL_HELD_SLOPES {name}_held_slopes",
        f"#define MODEL_INDICATE {name}_indicators",
        f"int MODEL_HELD({given}, const double m[], double rate[], double y[]);",
        f"int MODEL_HELD_SLOPES({given}, const double m[], double a[], double b[], double c[], double d[]);",
        f"int MODEL_INDICATE({given}, double g[]);",
        *(f"#define MODEL_{of.upper()}_DEFAULTS {name}_{of}_defaults" for of in ("state", "input", "parameter")),
        f"static const double MODEL_NOMINALS[] = {numbers(nominals(model).tolist())};",
        f"static const double MODEL_HYSTERESIS[] = {numbers([*kinks.hysteresis.tolist(), 0.0])};",
    ]
    return "\n".join(lines) + "\n"


@SYMBOLS.taken()
def _events_text(name: str, kinks: Kinks) -> str:
    """The equations with held branches, their slopes, and the event indicators, in C."""
    arguments = [ca.SX.sym(of, kinks.held.size1_in(of)) for of in kinks.held.name_in()]
    _, x, u, _, _ = arguments
    shown = kinks.held(*arguments)
    slopes = [ca.densify(ca.jacobian(of, to).T) for of in shown for to in (x, u)]
    functions = {
        "held": ca.Function(f"{name}_function_held", arguments, list(shown)),
        "held_slopes": ca.Function(f"{name}_function_held_slopes", arguments, slopes),
        "indicators": ca.Function(f"{name}_function_indicators", arguments[:4], [kinks.indicators(*arguments[:4])]),
    }
    generator = ca.CodeGenerator(f"{name}_events_functions.c", {"with_header": False, "with_export": False})
    for function in functions.values():
        generator.add(function)
    given = ("x", "u", "p", "m")
    lines = [
        *comment((f"{name}: equations between events, and event indicators.",)),
        generator.dump(),
        *call(functions["held"], f"{name}_held", ("rate", "y"), given),
        *call(functions["held_slopes"], f"{name}_held_slopes", ("a", "b", "c", "d"), given),
        *call(functions["indicators"], f"{name}_indicators", ("g",)),
    ]
    return "\n".join(lines)


def _compiled(sources: dict[str, str], units: tuple[str, ...], compiler: str) -> bytes:
    """The shared library."""
    mend = "set FEEDDRIVE_COMPILER=none for an FMU of sources"
    try:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            for file, text in sources.items():
                (folder / file).write_text(text, encoding="utf-8")
            run_compiler([compiler, *_FLAGS, "-o", "model", *units, "-lm"], folder)
            return (folder / "model").read_bytes()
    except CompilerError as failure:
        raise InputError(f"the model was not compiled: {failure}", compiler, mend) from None
    except OSError as error:
        what = f"the model was not compiled: the temporary folder cannot be used ({error.strerror})"
        raise InputError(what, tempfile.gettempdir(), f"name another one by TMPDIR, or {mend}") from None


def _packed(files: dict[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name, _EARLIEST)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, data)
    return buffer.getvalue()


BESIDE = "beside_table"
"""Ends the name of a state that is given beside the table."""


@SYMBOLS.taken()
def beside_table(model: Model) -> Model:
    """The model with its states, their start and its equations beside the table; results and parameters as they are.

    A heat network has no table, and stays as it is.
    """
    plant = model.plant
    if plant is None:
        return model
    n = len(plant.chain.coordinates)
    symbols = parameter_symbols(plant)
    rigid = plant.chain.rigid_motion(chain_symbols(plant, symbols))
    motion = ca.Function("motion", [symbols.vector], [ca.vertcat(*map(ca.SX, rigid))])
    time, y, u, p = (ca.SX.sym(name, model.function.size1_in(name)) for name in model.function.name_in())
    column = motion(p)
    xdot, shown = model.function(time, _changed(y, column, n, 1), u, p)
    function = ca.Function("ode", [time, y, u, p], [_changed(xdot, column, n, -1), shown],
                           model.function.name_in(), model.function.name_out())  # fmt: skip
    values = ca.DM([row.value for row in model.parameters])
    start = np.array(_changed(ca.DM([row.value for row in model.states]), motion(values), n, -1))[:, 0]
    rows = [
        replace(row, value=float(value), name=f"{row.name}_{BESIDE}" if i < 2 * n and i % n != n - 1 else row.name)
        for i, (row, value) in enumerate(zip(model.states, start, strict=True))
    ]
    return replace(model, states=tuple(rows), function=function)


def _changed(x: Expression, motion: Expression, n: int, sign: int) -> Expression:
    """States with G x of the table added to, or taken from, the other coordinates and their rates."""
    if n == 1:
        return x
    others = motion[: n - 1]
    first, rates = x[: n - 1] + sign * others * x[n - 1], x[n : 2 * n - 1] + sign * others * x[2 * n - 1]
    return ca.vertcat(first, x[n - 1], rates, x[2 * n - 1], x[2 * n :])
