"""What no named effect explains, as it stands in `diagnosis.json` and beside its tables in `plant_after.toml`."""

from __future__ import annotations

from typing import Any

from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.diagnosis.unexplained.unexplained_result import Above, Carried, Dependence, Table, Unexplained


def unexplained_record(diagnosis: Diagnosis) -> dict[str, Any]:
    """The content of `unexplained`: per channel."""
    return {name: _channel(left) for name, left in diagnosis.unexplained.items()}


def carried_remarks(diagnosis: Diagnosis) -> list[str]:
    """A comment for each tabulated effect, in the order in which the plant gets them."""
    tables = [one for left in diagnosis.unexplained.values() for one in left.carried]
    return [carried_sentence(one) for one in tables]


def carried_sentence(one: Carried) -> str:
    """What a tabulated effect explains, in a sentence."""
    shares = ", ".join(f"{share:.1%} of {name}" for name, share in one.explains.items() if share > 0.001)
    word = one.variable.replace("periodic_", "the period of the ").replace("_", " ")
    return f"Of no known name: what was left, as a table over {word}. Explains {shares} on data not fitted."


def _channel(left: Unexplained) -> dict[str, Any]:
    record: dict[str, Any] = {"share": left.share, "depends_on": [_dependence(one) for one in left.depends_on]}
    if left.above is not None:
        record["above_noise"] = _above(left.above)
    record |= {"statement": left.statement, "carried": [_carried(one) for one in left.carried]}
    if left.not_carried:
        record["not_carried"] = list(left.not_carried)
    if left.share_after is not None:
        record["share_after"] = left.share_after
    if left.instead is not None:
        record["instead"] = {"of": list(left.instead.names), **_carried(left.instead.carried)}
    return record


def _above(above: Above) -> dict[str, Any]:
    return {
        "share_of_rest": above.share,
        "standard_error": above.standard_error,
        "rms": above.rms,
        "noise_floor": above.floor,
        "is_left": above.is_left,
    }


def _dependence(one: Dependence) -> dict[str, Any]:
    record: dict[str, Any] = {"variable": one.variable, "share": one.share}
    if one.times:
        record["times"] = one.times
    if one.period:
        record |= {"period": one.period, "order": one.order}
    if one.table is not None:
        record |= {"form": one.form, "shape": one.statement, "amplitude": one.amplitude, "table": _table(one.table)}
        record |= {"share_judged": one.judged_share, "confirmed": one.confirmed}
    if one.alike:
        record["cannot_be_told_from"] = list(one.alike)
    return record


def _table(table: Table) -> dict[str, Any]:
    record: dict[str, Any] = {
        "breakpoints": list(table.breakpoints),
        "breakpoint_unit": table.breakpoint_unit,
        "values": list(table.values),
        "unit": table.unit,
    }
    if table.errors:
        record["standard_errors"] = list(table.errors)
    return record | ({"period": table.period} if table.period else {})


def _carried(one: Carried) -> dict[str, Any]:
    return {
        "name": one.name,
        "port": one.port,
        "variable": one.variable,
        **_table(one.table),
        "explains": one.explains,
        "rms_without": one.before,
        "rms_with": one.after,
    }
