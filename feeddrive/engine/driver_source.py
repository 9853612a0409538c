"""The C of a program: its generated functions between the parts of the driver that are the same for every plant."""

from __future__ import annotations

import re
from pathlib import Path

import casadi as ca

from feeddrive.engine.program import Program

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
    sizes += f"#define READ {{{', '.join(str(row) for row in (*program.step.read, 0))}}}\n"
    return "".join([*_texts(BEFORE), functions, sizes, *_texts(BEHIND)])


def _texts(names: tuple[str, ...]) -> list[str]:
    return [(Path(__file__).parent / name).read_text(encoding="utf-8") for name in names]
