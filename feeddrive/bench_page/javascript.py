"""A CasADi function as plain JavaScript: the page computes with the equations that the simulation has, not with others.

Every function becomes `name(arguments..., results...)` on flat arrays, column-major, as in the C that is generated.
"""

from __future__ import annotations

import json
import math

import casadi as ca

_BINARY = {
    ca.OP_ADD: "{0}+{1}", ca.OP_SUB: "{0}-{1}", ca.OP_MUL: "{0}*{1}", ca.OP_DIV: "{0}/{1}",
    ca.OP_POW: "Math.pow({0},{1})", ca.OP_CONSTPOW: "Math.pow({0},{1})", ca.OP_LT: "{0}<{1}?1:0",
    ca.OP_LE: "{0}<={1}?1:0", ca.OP_EQ: "{0}===({1})?1:0", ca.OP_NE: "{0}!==({1})?1:0", ca.OP_AND: "{0}&&{1}?1:0",
    ca.OP_OR: "{0}||{1}?1:0", ca.OP_FMIN: "Math.min({0},{1})", ca.OP_FMAX: "Math.max({0},{1})",
    ca.OP_FMOD: "{0}%({1})", ca.OP_IF_ELSE_ZERO: "{0}?{1}:0", ca.OP_ATAN2: "Math.atan2({0},{1})",
    ca.OP_COPYSIGN: "Math.abs({0})*(({1})<0||Object.is({1},-0)?-1:1)", ca.OP_HYPOT: "Math.hypot({0},{1})",
}  # fmt: skip
_UNARY = {
    ca.OP_ASSIGN: "{0}", ca.OP_NEG: "-({0})", ca.OP_EXP: "Math.exp({0})", ca.OP_LOG: "Math.log({0})",
    ca.OP_SQRT: "Math.sqrt({0})", ca.OP_SQ: "{0}*{0}", ca.OP_TWICE: "2*{0}", ca.OP_SIN: "Math.sin({0})",
    ca.OP_COS: "Math.cos({0})", ca.OP_TAN: "Math.tan({0})", ca.OP_ASIN: "Math.asin({0})", ca.OP_ACOS: "Math.acos({0})",
    ca.OP_ATAN: "Math.atan({0})", ca.OP_FLOOR: "Math.floor({0})", ca.OP_CEIL: "Math.ceil({0})",
    ca.OP_FABS: "Math.abs({0})", ca.OP_SIGN: "Math.sign({0})", ca.OP_INV: "1/({0})", ca.OP_SINH: "Math.sinh({0})",
    ca.OP_COSH: "Math.cosh({0})", ca.OP_TANH: "Math.tanh({0})", ca.OP_NOT: "{0}?0:1", ca.OP_LOG1P: "Math.log1p({0})",
    ca.OP_EXPM1: "Math.expm1({0})", ca.OP_ATANH: "Math.atanh({0})", ca.OP_ASINH: "Math.asinh({0})",
    ca.OP_ACOSH: "Math.acosh({0})",
}  # fmt: skip

_PIECE = 1200
"""Operations in one JavaScript function: engines leave longer ones unoptimised."""


def javascript(function: ca.Function, name: str) -> str:
    """The function as text.

    Args:
        function: CasADi SX; sparse results are made dense.
        name: of the JavaScript function.

    Raises:
        NotImplementedError: an operation that no equation of the plant has had so far.
    """
    dense = _dense(function)
    given = [f"a{i}" for i in range(dense.n_in())]
    results = [f"r{i}" for i in range(dense.n_out())]
    lines = [_line(dense, k) for k in range(dense.n_instructions())]
    head = ",".join([*given, *results])
    if len(lines) <= _PIECE:
        # local variables are quicker than an array, as long as there are few
        body = ";".join(lines).replace("w[", "w").replace("]W", "")
        names = ",".join(f"w{i}" for i in range(max(1, dense.sz_w())))
        return f"function {name}({head}){{let {names};{body};}}"
    pieces = [lines[i : i + _PIECE] for i in range(0, len(lines), _PIECE)]
    parts = [
        f"function {name}_{i}({head},w){{{';'.join(piece).replace(']W', ']')};}}" for i, piece in enumerate(pieces)
    ]
    calls = ";".join(f"{name}_{i}({head},{name}_w)" for i in range(len(pieces)))
    room = f"const {name}_w=new Float64Array({dense.sz_w()});"
    return "\n".join([*parts, room, f"function {name}({head}){{{calls};}}"])


def _dense(function: ca.Function) -> ca.Function:
    arguments = [ca.SX.sym(f"a{i}", function.size1_in(i), function.size2_in(i)) for i in range(function.n_in())]
    results = [ca.densify(result) for result in function.call(arguments)]
    return ca.Function("dense", arguments, results)


def _line(function: ca.Function, number: int) -> str:
    operation = function.instruction_id(number)
    given, made = function.instruction_input(number), function.instruction_output(number)
    if operation == ca.OP_OUTPUT:
        return f"r{made[0]}[{made[1]}]=w[{given[0]}]W"
    target = f"w[{made[0]}]W="
    if operation == ca.OP_INPUT:
        return f"{target}a{given[0]}[{given[1]}]"
    if operation == ca.OP_CONST:
        return target + number_text(function.instruction_constant(number))
    shape = _BINARY.get(operation) or _UNARY.get(operation)
    if shape is None:
        raise NotImplementedError(f"no JavaScript for CasADi operation {operation}")
    return target + shape.format(*(f"w[{place}]W" for place in given))


def number_text(value: float) -> str:
    """A number as JavaScript reads it, every digit kept."""
    if math.isnan(value):
        return "NaN"
    if math.isinf(value):
        return "Infinity" if value > 0 else "-Infinity"
    return json.dumps(float(value))
