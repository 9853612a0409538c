"""Paper 002: rises and time constants of figure 7, the claims of figures 5 and 6 and of the conclusions."""

from __future__ import annotations

from itertools import pairwise

from feeddrive.reproduce.paper_002_sets import PRELOADS, SPEEDS, Assumptions, WarmUp, nut_friction, torque, warm_up
from feeddrive.reproduce.row import Paper, Row, claim, number
from feeddrive.thermal.full.moving import moving_system
from feeddrive.thermal.laws.friction import nut_load_torque

_HEAT = Paper.HEAT
_RISES = {670: ("3.14", "5.18", "6.93"), 1300: ("6.97", "11.03", "14.32")}
_CONSTANTS = ("45", "33", "27")
_WITHIN = {Assumptions.FITTED: 0.02, Assumptions.PRINTED: 0.05}

Runs = dict[tuple[int, int], WarmUp]
"""(preload [N], speed [rev/min]) to its run."""


def result_rows() -> tuple[Row, ...]:
    """Six rises and time constants under both sets of assumptions, and the claims."""
    runs = {kind: {(F, N): warm_up(kind, F, N) for F in PRELOADS for N in SPEEDS} for kind in Assumptions}
    tables = [row for kind in (Assumptions.FITTED, Assumptions.PRINTED) for row in _figure_7(kind, runs[kind])]
    return (*tables, *_claims(runs[Assumptions.PRINTED], runs[Assumptions.FITTED]), _contact_claim(runs))


def _figure_7(kind: Assumptions, runs: Runs) -> list[Row]:
    within = _WITHIN[kind]
    rows = [
        number(_HEAT, "fig. 7", f"nut rise at {F} N, {N} rev/min", "K", text, runs[F, N].rise,
               law=moving_system, within=within,
               fitted=kind.value)
        for F in PRELOADS
        for N, text in zip(SPEEDS, _RISES[F], strict=True)
    ]  # fmt: skip
    rows += [
        number(_HEAT, "fig. 7", f"time constant at {F} N, {N} rev/min", "min", text, runs[F, N].time_constant,
               law=moving_system, within=within,
               fitted=kind.value, otherwise=f"{kind.value}; its contact grows with the preload")
        for F in PRELOADS
        for N, text in zip(SPEEDS, _CONSTANTS, strict=True)
    ]  # fmt: skip
    return rows


def _claims(printed: Runs, fitted: Runs) -> tuple[Row, ...]:
    """Claims, under set P; the time constants under set F."""
    rises = [[printed[F, N].rise for N in SPEEDS] for F in PRELOADS]
    gaps = [[printed[F, N].nut[-1] - printed[F, N].shaft[-1] for N in SPEEDS] for F in PRELOADS]
    constants = [[fitted[F, N].time_constant for N in SPEEDS] for F in PRELOADS]
    spread = max(abs(a - b) for a, b in zip(*constants, strict=True))
    torques = [[torque(nut_friction(F), N) for N in SPEEDS] for F in PRELOADS]
    p, f = Assumptions.PRINTED.value, Assumptions.FITTED.value
    return (
        claim(_HEAT, "concl. (1)", "nut rise grows with preload and speed", "grows", _shown(rises), _grows(rises),
              law=moving_system, unit="K", assumption=p),
        claim(_HEAT, "fig. 6", "shaft cooler than nut, gap grows with preload and speed", "grows", _shown(gaps),
              _grows(gaps) and min(gaps[0]) > 0, law=moving_system, unit="K", assumption=p),
        claim(_HEAT, "concl. (2)", "friction torque grows with preload and speed", "grows", _shown(torques),
              _grows(torques),
              law=nut_load_torque, unit="N m", assumption="constants through table 4; any positive ones make it grow"),
        claim(_HEAT, "concl. (3)", "time constant falls with speed", "falls", _shown(constants),
              all(a > b for row in constants for a, b in pairwise(row)), law=moving_system, unit="min", fitted=f),
        claim(_HEAT, "concl. (3)", "time constant does not depend on the preload", "equal", f"{spread:.2f} apart",
              spread < 0.5, law=moving_system, unit="min", fitted=f),
        _settling(printed),
    )  # fmt: skip


def _settling(runs: Runs) -> Row:
    """Within 5 % of the rise at 180 min after three time constants."""
    shares = [_rise_at(runs[670, N], 3 * float(text)) for N, text in zip(SPEEDS, _CONSTANTS, strict=True)]
    shown = ", ".join(f"{100 * share:.1f}" for share in shares)
    return claim(_HEAT, "concl. (4)", "settled to 5 % after 135, 99, 81 min", "95 to the whole percent", shown,
                 all(share >= 0.945 for share in shares), law=moving_system, unit="%",
                 assumption=Assumptions.PRINTED.value)  # fmt: skip


def _rise_at(run: WarmUp, minutes: float) -> float:
    """Share of the rise at 180 min reached after some minutes."""
    return float(run.nut[round(2 * minutes)]) / run.rise


def _contact_claim(runs: dict[Assumptions, Runs]) -> Row:
    kind = Assumptions.PRINTED
    more = [runs[kind][F, 750].rise - warm_up(kind, F, 750, with_contact=False).rise for F in PRELOADS]
    return claim(_HEAT, "fig. 5", "contact resistance warms the nut, more so at 1300 N", "larger at 1300 N",
                 f"{more[0]:.2f} and {more[1]:.2f}", 0 < more[0] < more[1], law=moving_system, unit="K",
                 assumption=f"{kind.value}; the reason is the larger heat, not the contact")  # fmt: skip


def _grows(table: list[list[float]]) -> bool:
    with_speed = all(a < b for row in table for a, b in pairwise(row))
    return with_speed and all(a < b for a, b in zip(*table, strict=True))


def _shown(table: list[list[float]]) -> str:
    return " | ".join(" ".join(f"{value:.3g}" for value in row) for row in table)
