"""modelDescription.xml of an exported model, FMI 2.0 for model exchange.

States are given beside the table (`feeddrive.export.fmu`). Variables in the order of their value references:
states `state.NAME`, their derivatives `der(state.NAME)`, inputs, outputs, parameters. Values of inertias and springs
are fixed once the simulation starts, since the states hang on them; those of effects can be tuned.
"""

from __future__ import annotations

import re
from xml.etree import ElementTree as Tree

import casadi as ca

from feeddrive import __version__
from feeddrive.errors import printable
from feeddrive.export.nonlinear_model import Model, Quantity, nominals
from feeddrive.symbolic_turn import SYMBOLS

_BASE = {
    "N": {"kg": 1, "m": 1, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "J": {"kg": 1, "m": 2, "s": -2},
    "Hz": {"s": -1},
    **{name: {name: 1} for name in ("kg", "m", "s", "A", "K", "rad")},
}
_FACTOR = re.compile(r"([A-Za-z]+)(?:\^(-?\d+))?")


def exponents(unit: str) -> dict[str, int] | None:
    """Exponents of kg, m, s, A, K and rad; {} for a pure number, None where there are no whole ones.

    Args:
        unit: SI unit as feeddrive writes it, such as "N m s/rad" or "kg m^2".
    """
    if unit == "1":
        return {}
    total: dict[str, int] = {}
    above, _, below = unit.partition("/")
    for text, sign in ((above, 1), (below.removeprefix("(").removesuffix(")"), -1)):
        for factor in text.split():
            match = _FACTOR.fullmatch(factor)
            if match is None or match[1] not in _BASE:
                if factor == "1":
                    continue
                return None
            for base, exponent in _BASE[match[1]].items():
                total[base] = total.get(base, 0) + sign * exponent * int(match[2] or 1)
    return {base: exponent for base, exponent in total.items() if exponent}


TOLERANCE = 1e-8
"""Relative, asked of the solver: of a shaft that has turned 100 rad it leaves a microradian, nanometres of travel."""


def description_text(model: Model, guid: str, sources: tuple[str, ...], indicators: int) -> str:
    """The XML text of a model whose binary has a guid, C files in `sources` and so many event indicators."""
    root = Tree.Element("fmiModelDescription", {
        "fmiVersion": "2.0", "modelName": _one_line(model.name), "guid": guid,
        "description": " | ".join(map(_one_line, model.heading)),
        "generationTool": f"feeddrive {__version__}", "variableNamingConvention": "structured",
        "numberOfEventIndicators": str(indicators),
    })  # fmt: skip
    exchange = Tree.SubElement(root, "ModelExchange", {
        "modelIdentifier": model.identifier, "canNotUseMemoryManagementFunctions": "true",
        "providesDirectionalDerivative": "true",
    })  # fmt: skip
    files = Tree.SubElement(exchange, "SourceFiles")
    for name in sources:
        Tree.SubElement(files, "File", {"name": name})
    _add_units(root, model)
    lasts = "1" if model.plant is not None else "3600"
    Tree.SubElement(root, "DefaultExperiment", {"startTime": "0", "stopTime": lasts, "tolerance": repr(TOLERANCE)})
    _add_variables(Tree.SubElement(root, "ModelVariables"), model)
    _add_structure(Tree.SubElement(root, "ModelStructure"), model)
    Tree.indent(root)
    text: str = Tree.tostring(root, encoding="utf-8", xml_declaration=True).decode()
    return text + "\n"


def fixed_parameters(model: Model) -> int:
    """How many parameters, the first ones, are fixed once the simulation starts."""
    return sum(row.of_chain for row in model.parameters)


def _add_units(root: Tree.Element, model: Model) -> None:
    definitions = Tree.SubElement(root, "UnitDefinitions")
    rows = (*model.states, *model.inputs, *model.outputs, *model.parameters)
    for unit in sorted({row.unit for row in rows} | {_rate_unit(row.unit) for row in model.states}):
        if unit == "1":
            continue
        element = Tree.SubElement(definitions, "Unit", {"name": unit})
        base = exponents(unit)
        if base is not None:  # FMI knows whole exponents alone
            Tree.SubElement(element, "BaseUnit", {key: str(value) for key, value in base.items()})


def _add_variables(parent: Tree.Element, model: Model) -> None:
    sizes = [repr(float(size)) for size in nominals(model)]
    start: dict[str, str]
    for row, nominal in zip(model.states, sizes, strict=True):
        start = {"start": repr(row.value), "nominal": nominal}
        _add(parent, f"state.{row.name}", row, ("local", "continuous", "exact"), start)
    for index, row in enumerate(model.states, start=1):
        rate = Quantity(row.name, _rate_unit(row.unit))
        _add(parent, f"der(state.{row.name})", rate, ("local", "continuous", "calculated"), {"derivative": str(index)})
    for row in model.inputs:
        _add(parent, row.name, row, ("input", "continuous", ""), {"start": repr(row.value)})
    for row in model.outputs:
        _add(parent, row.name, row, ("output", "continuous", "calculated"), {})
    for row in model.parameters:
        kind = "fixed" if row.of_chain else "tunable"
        _add(parent, row.name, row, ("parameter", kind, "exact"), {"start": repr(row.value)})


def _add(parent: Tree.Element, name: str, row: Quantity, kind: tuple[str, str, str], real: dict[str, str]) -> None:
    """One variable; its value reference is its place."""
    causality, variability, initial = kind
    attributes = {"name": name, "valueReference": str(len(parent))}
    attributes |= {"description": _one_line(row.comment)} if row.comment else {}
    attributes |= {"causality": causality, "variability": variability} | ({"initial": initial} if initial else {})
    variable = Tree.SubElement(parent, "ScalarVariable", attributes)
    Tree.SubElement(variable, "Real", ({"unit": row.unit} if row.unit != "1" else {}) | real)


def _add_structure(parent: Tree.Element, model: Model) -> None:
    """Outputs, derivatives and what each depends on, by index from 1."""
    n, nu = len(model.states), len(model.inputs)
    rates, outputs = range(n + 1, 2 * n + 1), range(2 * n + nu + 1, 2 * n + nu + len(model.outputs) + 1)
    known = [*range(1, n + 1), *range(2 * n + 1, 2 * n + nu + 1)]
    by_rate, by_output = _dependencies(model)
    for name, unknowns, dependencies in (("Outputs", outputs, by_output), ("Derivatives", rates, by_rate)):
        element = Tree.SubElement(parent, name)
        for index, row in zip(unknowns, dependencies, strict=True):
            on = " ".join(str(known[column]) for column in row)
            Tree.SubElement(element, "Unknown", {"index": str(index), "dependencies": on})
    initial = Tree.SubElement(parent, "InitialUnknowns")
    for index in (*rates, *outputs):
        Tree.SubElement(initial, "Unknown", {"index": str(index)})


@SYMBOLS.taken()
def _dependencies(model: Model) -> list[list[list[int]]]:
    """For the rates and for the outputs: columns of (x, u) on which each row depends."""
    arguments = [ca.SX.sym(of, model.function.size1_in(of)) for of in model.function.name_in()]
    known = ca.vertcat(arguments[1], arguments[2])
    patterns = [ca.jacobian_sparsity(result, known) for result in model.function(*arguments)]
    return [[[c for c in range(pattern.size2()) if pattern.has_nz(r, c)] for r in range(pattern.size1())]
            for pattern in patterns]  # fmt: skip


def _one_line(text: str) -> str:
    """A text as an attribute may hold it: XML knows no control characters at all."""
    return " ".join(printable(text).split())


def _rate_unit(unit: str) -> str:
    return unit.replace("/s", "/s^2") if unit.endswith("/s") else f"{unit}/s"
