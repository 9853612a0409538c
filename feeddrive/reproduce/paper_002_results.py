"""Paper 002: rises and time constants of figure 7, the claims of figures 5 and 6 and of the conclusions.

Then its difference scheme, its units, and numbers that follow from other printed ones.
"""

from __future__ import annotations

import math
from itertools import pairwise

from feeddrive.reproduce.paper_002_sets import PRELOADS, SPEEDS, Assumptions, WarmUp, nut_friction, torque, warm_up
from feeddrive.reproduce.row import Paper, Row, claim, misprint, number
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


_SAME_CLASSES = {17: 1, 15: 2, 14: 5}
"""Classes of the bearing that are those of the screw or nut under another number."""

_CONTACT_OF = {"screw": "C_bsg", "nut": "C_bng"}
"""Names of the contact conductances under table 5."""

_SURFACE = 16
"""n at the surface of the 16 mm screw, cells of 0.5 mm."""


def scheme_rows() -> tuple[Row, ...]:
    """Equations (13), (14) and the volumes, then what follows by arithmetic, then units."""
    return (*_coefficients(), *_arithmetic(), *_friction_equations(), *_units())


def _coefficients() -> tuple[Row, ...]:
    defect = max(abs(given - taken) for given, taken in _exchanges())
    outer = (_SURFACE + 0.25) / (_SURFACE - 0.25)
    kinds = 17 - len(_SAME_CLASSES)
    return (
        claim(_HEAT, "eq. (13)", "k1 to k6 take from a cell what they give to its neighbour", "conservative",
              f"to {defect:.0e} of an exchange", defect < 1e-12, law=None),
        claim(_HEAT, "eq. (13)", "volume of a bearing's cell, at its outer surface", "n + 0.25",
              f"n - 0.25; at n = {_SURFACE} the printed one is {outer - 1:.1%} larger", math.isclose(outer, 1.0),
              law=None,
              otherwise="n + 0.25 belongs to an inner surface, that of the nut"),
        misprint(_HEAT, "eq. (14)", "contact in the condition of class 8, a cell of the nut", "C_bsg",
                 _CONTACT_OF["nut"],
                 "class 8 meets the nut's contact, 2.7 % less in table 5; C_bsg is the screw's"),
        claim(_HEAT, "sec. 2.4", "kinds of difference equations", "at most 15", f"{kinds} of 17 numbers", kinds <= 15,
              law=None, assumption="classes 4 to 8 and 14 are not printed; 17 = 1, 15 = 2, 14 = 5 by their neighbours"),
    )  # fmt: skip


def _exchanges() -> list[tuple[float, float]]:
    """Size of a cell times its coefficient towards a neighbour, and the same from there (ring areas over pi dr^2)."""
    pairs = [(0.25 * 4, 2 * 1 * _k1(1))]  # axis and n = 1
    pairs += [(2 * n * _k2(n), 2 * (n + 1) * _k1(n + 1)) for n in range(1, 40)]
    for n in range(2, 41):
        outer, inner = 4 * (2 * n - 1) / (4 * n - 1), 4 * (2 * n + 1) / (4 * n + 1)  # k3, k5
        pairs.append(((n - 0.25) * outer, 2 * (n - 1) * _k2(n - 1)))
        pairs.append(((n + 0.25) * inner, 2 * (n + 1) * _k1(n + 1)))
        # k4, k6: through the surface of radius n.
        pairs.append(((n - 0.25) * 8 * n / (4 * n - 1), (n + 0.25) * 8 * n / (4 * n + 1)))
    return pairs


def _k1(n: int) -> float:
    return 1 - 0.5 / n


def _k2(n: int) -> float:
    return 1 + 0.5 / n


def _arithmetic() -> tuple[Row, ...]:
    settled = zip(SPEEDS, ("135", "99", "81"), (45, 33, 27), strict=True)
    return (
        *(number(_HEAT, "sec. 5", f"settling time at {N} rev/min, three time constants", "min", text, 3.0 * tau,
          law=None)
          for N, text, tau in settled),
        number(_HEAT, "fig. 5", "feed at 750 rev/min, lead 5 mm", "m/min", "3.75", 750 * 5e-3, law=None),
        number(_HEAT, "sec. 5", "axial cells of 2.5 mm in 500 mm", "", "200", 500 / 2.5, law=None),
        number(_HEAT, "sec. 5", "radial cells of 0.5 mm", "", "40", 20 / 0.5,
               law=None, assumption="nut of 40 mm outer diameter, which is not printed"),
    )  # fmt: skip


def _friction_equations() -> tuple[Row, ...]:
    nuts = 2  # of the double nut
    return (
        claim(_HEAT, "eq. (22)", "number of nuts in (22) from (18) to (20)", "κ once",
              f"κ in (19) and in (20): {nuts**2} in place of {nuts}", nuts**2 == nuts, law=None,
              otherwise="one of the two is lost, or hidden in 1.93e-4"),
    )  # fmt: skip


def _units() -> tuple[Row, ...]:
    return (
        misprint(_HEAT, "table 4", "unit of a friction torque", "N/m", "N m", "misprint: a torque"),
        misprint(_HEAT, "sec. 5", "viscosities of 32 and 170", "m²/s", "mm²/s",
                 "misprint: table 4 follows with mm²/s, and no oil has 32 m²/s"),
    )  # fmt: skip
