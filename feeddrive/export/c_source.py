"""The equations of motion in C99, self-contained: the functions CasADi generates, tables of names, units and values.

    #include "bench_axis.h"
    double p[BENCH_AXIS_PARAMETERS], rate[BENCH_AXIS_STATES], y[BENCH_AXIS_OUTPUTS];
    memcpy(p, bench_axis_parameter_defaults, sizeof p);
    bench_axis_ode(time, x, u, p, rate, y);

No memory is allocated and nothing is kept between calls, so they may run in several threads. Compile with
`-ffp-contract=off` (and never `-ffast-math`) where the last digit matters: the numbers are then those of feeddrive.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from feeddrive.errors import printable
from feeddrive.export.nonlinear_model import Model, Quantity, slopes_of
from feeddrive.symbolic_turn import SYMBOLS


def header_text(model: Model) -> str:
    """The header: sizes, indices, tables and prototypes."""
    name, upper = model.identifier, model.identifier.upper()
    groups = _groups(model)
    lines = [
        *comment(model.heading),
        f"#ifndef {upper}_H",
        f"#define {upper}_H",
        "",
        *(f"#define {upper}_{group} {len(rows)}" for group, rows in groups.items()),
        "",
        *(line for group, rows in groups.items() for line in _indices(upper, group, rows)),
        *(line for group in groups for line in _declarations(name, upper, group)),
        *comment(_ODE_COMMENT),
        f"int {name}_ode(double time, const double x[], const double u[], const double p[],",
        "    double rate[], double y[]);",
        "",
        *comment(_SLOPES_COMMENT),
        f"int {name}_slopes(double time, const double x[], const double u[], const double p[],",
        "    double a[], double b[], double c[], double d[]);",
        "",
        "#endif",
    ]
    return "\n".join(lines) + "\n"


def source_text(model: Model) -> str:
    """The source that goes with the header."""
    name = model.identifier
    functions = [_dense(model.function, f"{name}_function_ode"), slopes_of(model, f"{name}_function_slopes")]
    generator = ca.CodeGenerator(f"{name}_functions.c", {"with_header": False, "with_export": False})
    for function in functions:
        generator.add(function)
    lines = [
        *comment((f"{model.name}: see {name}.h.", f"Compile with -ffp-contract=off: {name}_selftest.c.")),
        f'#include "{name}.h"',
        generator.dump(),
        *(line for group, rows in _groups(model).items() for line in _tables(name, group, rows)),
        *call(functions[0], f"{name}_ode", ("rate", "y")),
        *call(functions[1], f"{name}_slopes", ("a", "b", "c", "d")),
    ]
    return "\n".join(lines)


def comment(lines: Sequence[str]) -> list[str]:
    """A comment of C; what would end it early is taken apart, and what an editor obeys is shown."""
    return ["/*", *(f" * {_one_line(line)}" for line in lines), " */"]


def _one_line(text: str) -> str:
    return printable(text).replace("*/", "* /").replace("/*", "/ *").rstrip()


def numbers(values: Sequence[float]) -> str:
    """Initialiser of an array that reads back as the same bits."""
    return "{" + ", ".join(repr(float(value)) for value in values) + "}"


_ODE_COMMENT = (
    "Equations of motion. Any of the results may be left out (null).",
    "time [s] from the start; x, u, p: states, inputs, parameters in the order above, SI units.",
    "rate: time derivative of x; y: outputs. Returns 0.",
)
_SLOPES_COMMENT = (
    "Slopes of the equations, row by row: a = d rate/dx, b = d rate/du, c = dy/dx, d = dy/du.",
    "Arguments as above; any result may be null. Returns 0.",
)


def _groups(model: Model) -> dict[str, Sequence[Quantity]]:
    return {
        "STATES": model.states, "INPUTS": model.inputs, "OUTPUTS": model.outputs, "PARAMETERS": model.parameters
    }  # fmt: skip


def _indices(upper: str, group: str, rows: Sequence[Quantity]) -> list[str]:
    """A comment with one line for each row: index, name, unit, value and source."""
    values = "" if group == "OUTPUTS" else ", default" if group == "PARAMETERS" else ", at the start"
    shown = [f"{group.lower()}: index, name, unit{values}"]
    for index, row in enumerate(rows):
        value = "" if group == "OUTPUTS" else f" = {row.value!r}"
        shown.append(f"{index:3d} {row.name}{value} [{row.unit}]{f' ({row.comment})' if row.comment else ''}")
    return comment(shown)


def _declarations(name: str, upper: str, group: str) -> list[str]:
    one, size = group.lower().removesuffix("s"), f"{upper}_{group}"
    lines = [f"extern const char *const {name}_{one}_names[{size}];"]
    lines.append(f"extern const char *const {name}_{one}_units[{size}];")
    if group != "OUTPUTS":
        lines.append(f"extern const double {name}_{one}_defaults[{size}];")
    return lines


def _tables(name: str, group: str, rows: Sequence[Quantity]) -> list[str]:
    one, upper = group.lower().removesuffix("s"), f"{name.upper()}_{group}"
    texts = {key: ", ".join(f'"{text}"' for text in column) for key, column in
             (("names", [row.name for row in rows]), ("units", [row.unit for row in rows]))}  # fmt: skip
    lines = [f"const char *const {name}_{one}_{key}[{upper}] = {{{text}}};" for key, text in texts.items()]
    if group != "OUTPUTS":
        values = numbers([row.value for row in rows])
        lines.append(f"const double {name}_{one}_defaults[{upper}] = {values};")
    return lines


def call(function: ca.Function, name: str, results: Sequence[str], given: Sequence[str] = ("x", "u", "p")) -> list[str]:
    """A function with arrays as arguments around a generated one; work memory lies on the stack."""
    arguments = ", ".join(f"double {result}[]" for result in results)
    arrays = ", ".join(f"const double {array}[]" for array in given)
    sizes = function.sz_arg(), function.sz_res(), function.sz_iw() or 1, function.sz_w() or 1
    lines = [
        "",
        f"int {name}(double time, {arrays},",
        f"    {arguments}) {{",
        f"  const casadi_real *arg[{sizes[0]}];",
        f"  casadi_real *res[{sizes[1]}];",
        f"  casadi_int iw[{sizes[2]}];",
        f"  casadi_real w[{sizes[3]}];",
        *(f"  arg[{index}] = {text};" for index, text in enumerate(["&time", *given])),
        *(f"  res[{index}] = {text};" for index, text in enumerate(results)),
        f"  return {function.name()}(arg, res, iw, w, 0);",
        "}",
    ]
    return [*lines, ""]


@SYMBOLS.taken()
def _dense(function: ca.Function, name: str) -> ca.Function:
    """The function with dense results: generated code hands out no structural zeros."""
    arguments = [ca.SX.sym(of, function.size1_in(of)) for of in function.name_in()]
    results = [ca.densify(result) for result in function(*arguments)]
    return ca.Function(name, arguments, results, function.name_in(), function.name_out())
