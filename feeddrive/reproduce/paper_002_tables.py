"""Paper 002: tables 3 to 5, the equations behind them, and what the paper does not give."""

from __future__ import annotations

import math

import numpy as np

from feeddrive.reproduce.paper_002_sets import (
    BEARING_FILM,
    FILMS,
    LEAD_ANGLE,
    MEAN_DIAMETER,
    PRELOADS,
    SPEEDS,
    bearing_friction,
    nut_friction,
    torque,
)
from feeddrive.reproduce.row import Paper, Row, claim, not_possible, number
from feeddrive.thermal.laws.films import Films, conductance_at_preload, rotating_cylinder_film
from feeddrive.thermal.laws.friction import Friction, nut_load_torque

_HEAT = Paper.HEAT
_FILM = "W/(m² K)"


def table_rows() -> tuple[Row, ...]:
    """Tables 3, 4, 5 and the equations that should give them."""
    return (*_film_rows(), *_nut_torque_rows(), *_literal_torque_rows(), *_bearing_torque_rows(), *_contact_rows())


def missing_rows() -> tuple[Row, ...]:
    """What is not given, and what contradicts itself."""
    given = "not in the paper; every rise and time constant depends on it"
    missing = (
        ("sec. 5", "conductivity, density, specific heat of the steel", given),
        ("sec. 5", "length of the nut", f"{given} (70 to 90 mm: rise +4 to -4 %)"),
        ("sec. 5", "boundary condition at the shaft's ends", "no class of figure 3 describes the free end"),
        ("sec. 5", "time step", "not in the paper; class 1 allows 4.4 to 4.8 ms"),
        ("eq. (12)", "area A", "not given; with the Hertz ellipse C would fall with the preload"),
        ("eq. (22)", "basic static rating hidden in 1.93e-4", "1.93e-4 would need 106 N; no rating gives it"),
        ("eq. (15)", "preload and rating of the support bearing", "not given; its load torque is fitted"),
        ("ref. (15)", "law of h_n", "reference not public; three values only"),
        ("ref. (16)", "law of h_b", f"a constant, {BEARING_FILM} W/(m² K), from its reference"),
    )
    return (*(not_possible(_HEAT, place, what, "", "", why) for place, what, why in missing), *_contradictions())


def _film_rows() -> tuple[Row, ...]:
    rows = []
    law = "0.29033 N^(2/3): law of (30), its factor through the table"
    blend = "fourth-power blend of free 4.857 and forced 5.024 at 250 rev/min, fitted to the three values"
    for speed, h_n, h_s in zip(SPEEDS, ("5.88", "7.46", "8.91"), ("11.52", "18.29", "23.97"), strict=True):
        turning = np.array([speed * math.pi / 30])
        rows.append(number(_HEAT, "table 3", f"h_s at {speed} rev/min", _FILM, h_s,
                           float(FILMS.on_screw(turning)[0]), law=Films.on_screw, fitted=law))  # fmt: skip
        rows.append(number(_HEAT, "table 3", f"h_n at {speed} rev/min", _FILM, h_n,
                           float(FILMS.on_nut(turning)[0]), law=Films.on_nut, within=1e-3, fitted=blend))  # fmt: skip
        film = rotating_cylinder_film(float(turning[0]), MEAN_DIAMETER)
        rows.append(number(_HEAT, "eq. (30)", f"h_s at {speed} rev/min, from air at 25 °C", _FILM, h_s, film,
                           law=rotating_cylinder_film, within=0.05,
                           assumption="Re = ω d²/ν; d_m 16.75 mm from table 4; properties of air, 5 %"))  # fmt: skip
    return tuple(rows)


def _nut_torque_rows() -> tuple[Row, ...]:
    fitted = "d_m 16.75 mm and 4.1364e-4 for 1.93e-4·κ·cot α_c; factor 1e-7 put back into (24)"
    printed = {670: (".0457", ".0490", ".0518"), 1300: (".1021", ".1055", ".1083")}
    return tuple(
        number(_HEAT, "table 4", f"T_bs at {preload} N, {speed} rev/min", "N m", f"0{text}",
               torque(nut_friction(preload), speed), law=nut_load_torque, fitted=fitted)
        for preload in PRELOADS
        for speed, text in zip(SPEEDS, printed[preload], strict=True)
    )  # fmt: skip


def _literal_torque_rows() -> tuple[Row, ...]:
    """Equation (22) as printed."""
    why = "(22) as printed at α_c 45° is 6 % low; it fits with α_c 43.0° or 2.068e-4"
    rows = []
    for preload, text in zip(PRELOADS, ("0.0457", "0.1021"), strict=True):
        load = nut_load_torque(1.93e-4 * 2, preload, MEAN_DIAMETER, LEAD_ANGLE)
        literal = torque(Friction(load, 10, 170e-6, MEAN_DIAMETER), 250)
        name = f"T_bs at {preload} N, 250 rev/min, literally"
        rows.append(number(_HEAT, "eq. (22), (24)", name, "N m", text, literal, law=nut_load_torque, otherwise=why))
    return tuple(rows)


def _bearing_torque_rows() -> tuple[Row, ...]:
    fitted = "load torque 0.539 mN m and f0 3.915 fitted (d_m 22 mm); table 2 offers 3.3 at most"
    texts = zip(SPEEDS, ("0.0022", "0.0032", "0.0040"), strict=True)
    rows = [
        number(_HEAT, "table 4", f"T_b at {speed} rev/min", "N m", text, torque(bearing_friction(), speed),
               law=Friction.viscous_torques, fitted=fitted)
        for speed, text in texts
    ]  # fmt: skip
    rises = [torque(Friction(0.0, 3.3, 32e-6, 0.022), speed) for speed in (250, 750)]
    name, short = "T_b(750) - T_b(250) with f0 of an oil bath", "f0 3.3 at d_m 22 mm is 14 % short; d_m 23 mm would do"
    oil = number(_HEAT, "table 2, eq. (23)", name, "N m", "0.0018", rises[1] - rises[0], law=Friction.viscous_torques,
                 otherwise=short)  # fmt: skip
    return (*rows, oil)


def _contact_rows() -> tuple[Row, ...]:
    law = "third root of the preload from (11), (12) with A constant; the value at 670 N is taken"
    rows = []
    for side, low, high in (("C_bng", "123.30", "153.84"), ("C_bsg", "126.70", "158.02")):
        why = "number of balls, groove and area are not given; an area of 72 mm length fits"
        rows.append(not_possible(_HEAT, "table 5", f"{side} at 670 N", _FILM, low, why))
        computed = conductance_at_preload(float(low), 1300, 670)
        rows.append(number(_HEAT, "table 5", f"{side} at 1300 N", _FILM, high, computed,
                           law=conductance_at_preload, within=1e-3, assumption=law))  # fmt: skip
    return tuple(rows)


def _contradictions() -> tuple[Row, ...]:
    half = "π N T/60 is half of ω T; added to half rings on two sides it heats with twice the friction power"
    sides, rings, rate = 2, 2, (math.pi / 60) / (2 * math.pi / 60)
    n = 2
    # Cells of radius n are as large as n; k1 = 1 - 0.5/n outwards, k2 = 1 + 0.5/n inwards, as (7) prints them.
    defect = ((n + 1) * (1 + 0.5 / (n + 1)) - n * (1 - 0.5 / n)) / n
    shift, speed = nut_friction(PRELOADS[0]), SPEEDS[0]
    # (24) with mm²/s, rev/min and mm, as they stand beside it, is then in N mm times Harris's 1e7.
    literal = shift.viscous_factor * (1e6 * shift.viscosity * speed) ** (2 / 3) * (1e3 * shift.mean_diameter) ** 3
    excess = literal / float(shift.viscous_torques(np.array([speed * math.pi / 30]))[0])
    return (
        claim(_HEAT, "eq. (25) to (29)", "heat put in over friction power ωT", "1", f"{sides * rings * rate:.1f}",
              math.isclose(sides * rings * rate, 1.0), law=None, otherwise=half),
        claim(_HEAT, "eq. (7)", "heat that node n = 2 loses and its neighbour does not get, over the exchange", "0",
              f"{defect:.1f}", math.isclose(defect, 0.0), law=None, otherwise="k1, k2 swapped; (13)-2 conserves heat"),
        claim(_HEAT, "eq. (23), (24)", "T_v in N m", "f0 (νN)^(2/3) d_m³", f"{excess:.0e} times too large",
              math.isclose(excess, 1.0), law=None,
              otherwise="Harris's factor 1e-7 and N mm, mm²/s, mm are missing"),
    )  # fmt: skip
