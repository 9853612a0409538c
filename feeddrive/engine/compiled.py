"""Generated C of a program with its driver, compiled and kept.

One binary per structure: lengths, values and inputs are arguments.
"""

from __future__ import annotations

import ctypes
import re
from functools import lru_cache
from pathlib import Path

import casadi as ca
import numpy as np

from feeddrive.compiler import compiled_library
from feeddrive.engine.program import CELL, Position, Program, Run, Status, Stop, Task
from feeddrive.symbolic_turn import SYMBOLS
from feeddrive.typing import FloatArray

BEFORE, BEHIND = ("driver_math.c",), ("driver_step.c", "driver_tangents.c", "driver.c")
"""Files that stand before and behind what is generated."""

_NULL_CHECK = re.compile(r"arg\[(\d+)\]\? (arg\[\1\]\[\d+\]) : 0")
_RESULT_CHECK = re.compile(r"if \(res\[\d+\]!=0\) ")
_FUNCTION = re.compile(r"^casadi_real casadi_", re.MULTILINE)


def source_of(program: Program) -> str:
    """C of a program: its functions, its sizes, the driver."""
    generator = ca.CodeGenerator("step.c", {"with_header": False, "with_export": True})
    for function in program.functions:
        generator.add(function)
    # the driver passes every argument and result, so that what may be absent need not be asked for
    functions = _RESULT_CHECK.sub("", _NULL_CHECK.sub(r"\2", generator.dump()))
    functions = _FUNCTION.sub("static inline casadi_real casadi_", functions)
    sizes = "".join(f"#define {name} {size}\n" for name, size in program.sizes.items())
    reads_input = any(row >= program.sizes["N_STATES"] for row in program.step.read)
    sizes += f"#define READS_INPUT {int(reads_input)}\n"
    sizes += f"#define READ {{{', '.join(str(row) for row in (*program.step.read, 0))}}}\n"
    return "".join([*_texts(BEFORE), functions, sizes, *_texts(BEHIND)])


def _texts(names: tuple[str, ...]) -> list[str]:
    return [(Path(__file__).parent / name).read_text(encoding="utf-8") for name in names]


FLAGS = (
    "-O2",
    "-ftree-loop-vectorize",
    "-ffp-contract=off",
    "-fno-math-errno",
    "-fno-trapping-math",
    "-fPIC",
    "-shared",
)
"""No fused or reordered arithmetic: the compiled numbers are those of the virtual machine."""

FOR_THIS_PROCESSOR = ("-march=native", "-mprefer-vector-width=256")
"""Where processors have vectors of 512 bits: arrays of some ten numbers written by them and read in narrower pieces
wait for the memory, and the loop takes half as long again; narrower vectors give the same numbers."""


@lru_cache(maxsize=1)
def processor() -> str:
    """What this processor can do, where Linux tells it for an x86; a binary made for it serves it alone."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return ""
    return next((line for line in lines if line.startswith("flags")), "")


def compiled_run(program: Program) -> Run | None:
    """The driver of a program in C; None without a compiler, or where it fails or no folder can hold what it makes."""
    flags = (*FLAGS, *FOR_THIS_PROCESSOR) if processor() else FLAGS
    source = source_of(program)
    with SYMBOLS.laid_down():
        library = compiled_library(source, flags, processor())
    return None if library is None else _bound(program, library)


class _Place(ctypes.Structure):
    """`place_of_run` of the driver."""

    _fields_ = [(name, ctypes.c_longlong) for name in ("sample", "level", "cell", "needed_cell", "needed_level")]


class _Constants(ctypes.Structure):
    """`constants_of_run` of the driver."""

    _fields_ = [
        ("fixed", ctypes.c_void_p), ("made", ctypes.c_void_p), ("first_cell", ctypes.c_longlong),
        ("cells", ctypes.c_longlong), ("width", ctypes.c_double),
    ]  # fmt: skip


class _Tangents(ctypes.Structure):
    """`tangents_of_run` of the driver."""

    _fields_ = [
        ("directions", ctypes.c_longlong), ("stride", ctypes.c_longlong),
        *((name, ctypes.c_void_p) for name in ("memory", "own", "seen", "settings", "values", "fixed", "on_fixed")),
    ]  # fmt: skip


def _bound(program: Program, library: ctypes.CDLL) -> Run:
    """The driver as a Python function on arrays."""
    function = library.feeddrive_run
    function.argtypes = [ctypes.c_longlong, *[ctypes.c_void_p] * 14]
    function.restype = ctypes.c_int
    work_size = max(f.sz_w() for f in program.functions) + 1, max(f.sz_iw() for f in program.functions) + 1

    def run(task: Task, position: Position, first: int, seen: FloatArray, report: FloatArray) -> Stop:
        place = _Place(first, position.level, position.cell, 0, 0)
        cells = task.made.shape[0]
        table = _Constants(task.fixed.ctypes.data, task.made.ctypes.data, task.first_cell, cells, CELL)
        memory, own = position.memory.copy(), position.own.copy()
        tangents, room = _tangents(program, task)
        given = [np.ascontiguousarray(array) for array in (task.fed, task.spans, task.settings, task.values)]
        fed, spans, settings, values = (array.ctypes.data for array in given)
        work, integers = np.empty(work_size[0]), np.empty(work_size[1], dtype=np.int64)
        status = function(
            len(task.fed), ctypes.addressof(place), memory.ctypes.data, own.ctypes.data, fed, spans,
            ctypes.addressof(table), settings, values, ctypes.addressof(tangents), seen.ctypes.data,
            report.ctypes.data, room.ctypes.data, integers.ctypes.data, work.ctypes.data,
        )  # fmt: skip
        at = Position(memory, own, place.level, place.cell)
        return Stop(Status(status), place.sample, at, place.needed_cell, place.needed_level)

    return run


def _tangents(program: Program, task: Task) -> tuple[_Tangents, FloatArray]:
    """The directions of a task as the driver takes them, and the room that it needs for them."""
    t, sizes = task.tangents, program.sizes
    if t is None:
        return _Tangents(), np.empty(0)
    arrays = (t.memory, t.own, t.seen, t.settings, t.values, t.fixed, t.on_fixed)
    count = len(t.values)
    carried = sizes["N_STATES"] + sizes["N_BRISTLES"]
    room = np.empty(count * (sizes["N_PARTS"] * sizes["N_HELD"] + sizes["N_OWN"] + carried) + 1)
    return _Tangents(count, t.fixed[0].size if count else 0, *(array.ctypes.data for array in arrays)), room
