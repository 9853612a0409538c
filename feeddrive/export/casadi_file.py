"""The equations of motion as a CasADi function file, with named inputs and parameters.

    f = casadi.Function.load("bench_axis.casadi")
    f(x=x0, motor_torque=1.5)["xdot"]                 # what is not given has its default value
    casadi.nlpsol, casadi.integrator, f.jacobian()    # an expression of CasADi as any other

Inputs: `time` [s], `x`, the inputs of the plant and every parameter by its name, with an underscore for a dot or an
index. Outputs: `xdot`, and the outputs of the plant by their names. The rows of x, units and default values stand in
NAME_casadi.json, and the version of CasADi that wrote the file: that one or a newer one loads it, an older one refuses.
feeddrive is not needed.
"""

from __future__ import annotations

import json
import re
import tempfile
from pathlib import Path

import casadi as ca

from feeddrive import __version__
from feeddrive.errors import InputError
from feeddrive.export.json_file import rows
from feeddrive.export.nonlinear_model import Model, Quantity
from feeddrive.symbolic_turn import SYMBOLS


@SYMBOLS.taken()
def casadi_function(model: Model) -> ca.Function:
    """The equations with one input for each input and parameter of the plant; every input has its default.

    Raises:
        InputError: two parameters whose names CasADi cannot tell apart.
    """
    time, x = ca.SX.sym("time"), ca.SX.sym("x", len(model.states))
    u, p = ca.SX.sym("u", len(model.inputs)), ca.SX.sym("p", len(model.parameters))
    xdot, y = model.function(time, x, u, p)
    names = _input_names(model)
    arguments = [time, x, *ca.vertsplit(u), *ca.vertsplit(p)]
    scalars = [0.0, *(row.value for row in (*model.inputs, *model.parameters))]
    default = [scalars[0], 0.0, *scalars[1:]]  # one number for all of x: the start stands in the JSON
    given = [xdot, *ca.vertsplit(y)]
    shown = ["xdot", *(row.name for row in model.outputs)]
    return ca.Function(model.identifier, arguments, given, names, shown, {"default_in": default})


def casadi_bytes(model: Model) -> bytes:
    """The content of the function file.

    Raises:
        InputError: as `casadi_function`, and a temporary folder that cannot hold the file.
    """
    function = casadi_function(model)
    try:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "function.casadi"
            function.save(str(path))
            ca.Function.load(str(path))  # CasADi says nothing where the disk is full
            return path.read_bytes()
    except (OSError, RuntimeError):
        mend = "make room there, or name another folder by TMPDIR"
        raise InputError("the temporary folder cannot hold the function file", tempfile.gettempdir(), mend) from None


def casadi_notes(model: Model) -> str:
    """What the function file cannot hold, as JSON: names and units of the rows of x, units and default values."""
    named = zip(_input_names(model)[2:], (*model.inputs, *model.parameters), strict=True)
    content = {
        "format": "feeddrive-casadi/1",
        "version": __version__,
        "casadi": ca.CasadiMeta.version(),
        "plant": model.name,
        "states": rows(model.states),
        "inputs": rows([Quantity(name, row.unit, row.value, row.name) for name, row in named]),
        "outputs": [{"name": row.name, "unit": row.unit} for row in model.outputs],
        "notes": dict(zip(("included", "left_out"), model.notes, strict=True)),
    }
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _input_names(model: Model) -> list[str]:
    """Names of the function's inputs; CasADi takes letters, digits and single underscores."""
    plain = [re.sub(r"[^A-Za-z0-9]+", "_", row.name).strip("_") for row in (*model.inputs, *model.parameters)]
    names = ["time", "x", *plain]
    if len({name.lower() for name in names}) < len(names):
        raise InputError("two parameters have the same name", model.name, "give the effects other names")
    return names
