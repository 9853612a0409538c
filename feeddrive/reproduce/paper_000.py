"""Paper 000 (efficiency of ball screws from an estimated friction coefficient) beside what the program computes.

Its measured curves are figures without printed values. What it prints are the screws, the springs, the mean friction
coefficient 0.034, a range of efficiencies, equations, and claims in words.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

from feeddrive.parts.screw.contact_angle_optimum import (
    best_contact_angle,
    friction_of_highest_efficiency,
    highest_efficiency,
    largest_lead_angle,
)
from feeddrive.parts.screw.screw_efficiency import (
    driving_efficiency,
    ideal_torque,
    preload_torque,
    relative_preload_torque,
)
from feeddrive.parts.screw.screw_friction import ScrewFriction, ScrewGeometry
from feeddrive.parts.screw.slip_angle import Groove, groove_at, slip_angle
from feeddrive.parts.screw.torque_regression import split_torque
from feeddrive.reproduce.paper_000_equations import equation_rows
from feeddrive.reproduce.row import Paper, Row, claim, not_possible, number, span

ISO_GRADES = (2.2, 3.2, 4.6, 6.8, 10, 15, 22, 32, 46, 68, 100, 150, 220, 320, 460, 680, 1000, 1500, 2200, 3200)
"""ISO 3448: middle of the grade's range of viscosity at 40 degC [mm^2/s]; a grade's name is this number, rounded."""

PAPER = Paper.EFFICIENCY
CONTACT_ANGLE = math.radians(45)
"""Not printed; usual. The deduced friction coefficient changes by less than 2 % between 40 and 50 deg."""

FRICTION = 0.034
ROLLING_FRICTION = 0.0022
LEAD_ANGLE_A, LEAD_ANGLE_B = math.radians(4.44), math.radians(5.26)
LEAD_A, LEAD_B = 0.010, 0.012
DIAMETER = 0.040
SPRINGS, SPRING_STIFFNESS, LARGEST_PRELOAD = 10, 56.9e3, 6e3

ASSUMED_ANGLE = "contact angle 45 deg, which is not printed"
NO_VALUES = "the figure has no printed values"


def rows() -> tuple[Row, ...]:
    """One row per printed number and checkable claim, in the order of the paper."""
    return (*equation_rows(), *_rig(), *_torque(), *_friction(), *_efficiency(), *_figures())


def _groove(lead_angle: float) -> Groove:
    return groove_at(lead_angle, CONTACT_ANGLE)


def _ball_circle(lead: float, lead_angle: float) -> float:
    """Diameter of the circle of ball centres [m]."""
    return lead / (math.pi * math.tan(lead_angle))


def _lead_angle(lead: float, diameter: float) -> float:
    """[deg]."""
    return math.degrees(math.atan(lead / (math.pi * diameter)))


def _rig() -> tuple[Row, ...]:
    """Screws, springs and lubricant."""
    result: list[Row] = []
    for name, lead, printed, circle in (("A", LEAD_A, "4.44", 0.0410), ("B", LEAD_B, "5.26", 0.0415)):
        needed = 1e3 * _ball_circle(lead, math.radians(float(printed)))
        wrong = f"the nominal diameter is not that of the ball centres, which the printed angle puts at {needed:.2f} mm"
        assumed = f"circle of ball centres {1e3 * circle:.1f} mm, not printed and chosen to give the angle"
        quantity = f"lead angle of screw {name}"
        nominal = number(PAPER, "section 4.2", f"{quantity}, on the diameter of 40 mm", "deg", printed,
                         _lead_angle(lead, DIAMETER), law=None, otherwise=wrong)  # fmt: skip
        at_balls = number(PAPER, "section 4.2", f"{quantity}, on the ball centres", "deg", printed,
                          _lead_angle(lead, circle), law=None, fitted=assumed)  # fmt: skip
        result += [nominal, at_balls]
    travel = LARGEST_PRELOAD / (SPRINGS * SPRING_STIFFNESS)
    shown = f"{1e3 * travel:.2f} mm of travel, {LARGEST_PRELOAD / SPRINGS:.0f} N per spring"
    springs = claim(PAPER, "section 3", "10 springs of 56.9 kN/m give the largest preload", "6 kN", shown,
                    travel < 0.02,
                    law=None, assumption="56.9 kN/m is one spring; as a sum it takes ten times the travel",
                    )  # fmt: skip
    nearest = " and ".join(f"{grade:g}" for grade in sorted(ISO_GRADES, key=lambda g: abs(g - 56))[:2])
    oil = claim(PAPER, "section 3", "viscosity grade of the oil DTE24", "ISO VG56", f"nearest grades {nearest}",
                56 in ISO_GRADES, law=None,
                otherwise="no grade of ISO 3448; paper 001 gives the same oil as VG32")  # fmt: skip
    return (*result, springs, oil)


def _torque() -> tuple[Row, ...]:
    """What section 4.1 says of the preload torque."""
    preloads = np.linspace(500.0, LARGEST_PRELOAD, 12)
    torques = preload_torque(_groove(LEAD_ANGLE_A), FRICTION, preloads, LEAD_A)
    spread = float(np.ptp(torques / preloads) * 1e3)
    shown = f"{1e3 * torques[0] / preloads[0]:.4f} N m/kN at every preload"
    dry = claim(PAPER, "figure 5", "dry torque is proportional to the preload, whatever the speed", "proportional",
                shown, spread < 1e-12, law=preload_torque, assumption=ASSUMED_ANGLE)  # fmt: skip
    viscous = 0.05
    share = 100 * viscous / (viscous + torques[[0, -1]])
    grease = claim(PAPER, "figure 7", "speed shows where the viscous effect is not small against the preload",
                   "at small preload", f"{share[0]:.0f} % of the torque at 500 N, {share[1]:.0f} % at 6 kN",
                   share[0] > 3 * share[1], law=preload_torque,
                   assumption=f"a load-free torque of {viscous:g} N m; {ASSUMED_ANGLE}")  # fmt: skip
    ratio = float(preload_torque(_groove(LEAD_ANGLE_B), FRICTION, 1.0, LEAD_B) * preloads[0] / torques[0])
    alike = claim(PAPER, "figure 5", "torque of screw B is less than that of A, with one f for both", "T_B < T_A",
                  f"T_B = {ratio:.4f} T_A", ratio < 1, law=preload_torque,
                  otherwise="with one friction coefficient the torque follows the lead, 12 mm over 10 mm")  # fmt: skip
    bound = _friction_of_equal_torque()
    higher = claim(PAPER, "figure 5", "torque of screw B is less than that of A, with f of their own", "T_B < T_A",
                   f"f_A > {bound:.5f}, f_B < {2 * FRICTION - bound:.5f}", bound > FRICTION, law=preload_torque,
                   assumption="the two coefficients differ about their mean 0.034; contact angle 45 deg")  # fmt: skip
    missing = "neither viscosity nor film thickness is printed, and the model has no lubricant"
    slow = "neither viscosity of the grease nor any coefficient of the speed is printed"
    quiet = "impacts between balls are not in the model; observed in the paper, not measured"
    return (
        dry,
        not_possible(PAPER, "figure 6", "torque with oil above the dry one", "N m", "higher, not with speed", missing),
        not_possible(PAPER, "figures 7, 8", "torque with grease grows with the speed", "N m", "grows", slow),
        grease,
        alike,
        higher,
        not_possible(PAPER, "section 4.1", "lubrication lowers noise and fluctuation", "", "lower", quiet),
    )


def _friction_of_equal_torque() -> float:
    """f_A at which both screws take the same torque, the mean of f_A and f_B being 0.034."""

    def difference(f_a: float) -> float:
        other = preload_torque(_groove(LEAD_ANGLE_B), 2 * FRICTION - f_a, 1.0, LEAD_B)
        return float(preload_torque(_groove(LEAD_ANGLE_A), f_a, 1.0, LEAD_A) - other)

    return float(brentq(difference, 0.5 * FRICTION, 1.5 * FRICTION, xtol=1e-12))


def _friction() -> tuple[Row, ...]:
    """The estimate of the friction coefficient."""
    geometry = ScrewGeometry(LEAD_A, _ball_circle(LEAD_A, LEAD_ANGLE_A), CONTACT_ANGLE)
    torque = ScrewFriction(geometry, FRICTION).preload_torque(LARGEST_PRELOAD)
    found = not_possible(PAPER, "conclusion 3", "dry friction coefficient, mean of A and B", "", "0.034",
                         "the measured torques are figures without values; "
                         f"0.034 means {torque:.3f} N m on screw A at 6 kN and 45 deg")  # fmt: skip
    ratio = number(PAPER, "section 4.2", "friction coefficient over that of pure rolling, 0.0022", "", "10",
                   FRICTION / ROLLING_FRICTION, law=None, otherwise="the same order of magnitude only")  # fmt: skip
    psi = [float(slip_angle(_groove(angle))) for angle in (LEAD_ANGLE_A, LEAD_ANGLE_B)]
    along = [FRICTION * math.sin(angle) for angle in psi]
    slip = claim(PAPER, "conclusion 2", "slip, not rolling, makes the coefficient that large", "10 times",
                 f"along the ball path f sin(psi) is {along[0] / ROLLING_FRICTION:.1f} and "
                 f"{along[1] / ROLLING_FRICTION:.1f} times the rolling one", max(along) < 3 * ROLLING_FRICTION,
                 law=slip_angle, assumption=ASSUMED_ANGLE)  # fmt: skip
    lead = claim(PAPER, "section 4.2", "the coefficient depends on the lead angle, by the slip angle",
                 "f_A and f_B differ", f"f_B = {math.sin(psi[0]) / math.sin(psi[1]):.3f} f_A", psi[1] > psi[0],
                 law=slip_angle,
                 assumption="f sin(psi) is the same in both screws; contact angle 45 deg")  # fmt: skip
    return (found, ratio, slip, lead, _lubricated(geometry))


def _lubricated(geometry: ScrewGeometry) -> Row:
    """Conclusion 1: with a viscous torque the estimate is no constant, and regression recovers it."""
    preloads = np.linspace(500.0, LARGEST_PRELOAD, 12)
    dry = ScrewFriction(geometry, FRICTION)
    torques = np.array([dry.preload_torque(float(F)) for F in preloads]) + 0.05
    ends = [geometry.friction_from(float(preloads[i]), float(torques[i])) for i in (0, -1)]
    found = geometry.friction_from(1.0, split_torque(preloads, torques)[0])
    return claim(PAPER, "conclusion 1", "a lubricated torque is unfit to estimate the coefficient", "unfit",
                 f"{ends[0]:.4f} at 500 N, {ends[1]:.4f} at 6 kN; by regression {found:.4f}", ends[0] > 1.2 * ends[1],
                 law=split_torque,
                 assumption="a load-free torque of 0.05 N m on screw A; contact angle 45 deg")  # fmt: skip


def _efficiency() -> tuple[Row, ...]:
    """Efficiencies and the best contact angle."""
    eta = tuple(float(driving_efficiency(_groove(angle), FRICTION)) for angle in (LEAD_ANGLE_A, LEAD_ANGLE_B))
    within = span(PAPER, "conclusion 3", "efficiency of screws A and B at f = 0.034", "", 0.90, 0.95, eta,
                  law=driving_efficiency,
                  assumption=ASSUMED_ANGLE)  # fmt: skip
    cap = float(highest_efficiency(FRICTION))
    top = number(PAPER, "conclusion 3", "upper end of the efficiency, at f = 0.034", "", "0.95", cap,
                 law=highest_efficiency,
                 otherwise="no lead or contact angle gives more at 0.034; the range is that of single f")  # fmt: skip
    ends = [float(friction_of_highest_efficiency(value)) for value in (0.90, 0.95)]
    spread = claim(PAPER, "conclusion 3", "efficiencies from 0.90 to 0.95 come from f about 0.034", "0.90 to 0.95",
                   f"f from {ends[0]:.4f} to {ends[1]:.4f}", ends[1] < FRICTION < ends[0],
                   law=friction_of_highest_efficiency,
                   assumption="f of each screw and preload, not their mean; best contact angle")  # fmt: skip
    rise = claim(PAPER, "section 4.1", "the screw of larger lead angle is the more efficient one", "eta_B > eta_A",
                 f"eta_A = {eta[0]:.6f}, eta_B = {eta[1]:.6f}", eta[1] > eta[0], law=driving_efficiency,
                 otherwise="at one f and 45 deg contact angle it falls slightly with the lead angle")  # fmt: skip
    best = [_best(name, angle) for name, angle in (("A", LEAD_ANGLE_A), ("B", LEAD_ANGLE_B))]
    angles = np.radians([5.0, 10.0, 20.0, 30.0, 40.0])
    optimum = np.degrees(best_contact_angle(angles, FRICTION))
    last = math.degrees(float(largest_lead_angle(FRICTION)))
    large = claim(PAPER, "section 4.2", "the best contact angle matters for screws of large lead angle", "grows",
                  f"{optimum[0]:.1f} deg at 5 deg, {optimum[3]:.1f} deg at 30 deg; 90 deg from {last:.1f} deg on",
                  bool(np.all(np.diff(optimum) > 0)), law=best_contact_angle)  # fmt: skip
    return (within, top, spread, rise, *best, large)


def _best(name: str, lead_angle: float) -> Row:
    angle = math.degrees(float(best_contact_angle(lead_angle, FRICTION)))
    return claim(PAPER, "figure 11b", f"best contact angle of screw {name}", "a little above 45", f"{angle:.2f}",
                 45 < angle < 48, law=best_contact_angle, unit="deg")  # fmt: skip


def _figures() -> tuple[Row, ...]:
    """Measured curves."""
    ideal = f"{ideal_torque(LARGEST_PRELOAD, LEAD_A):.3f} N m times a relative torque"
    relative = relative_preload_torque(_groove(LEAD_ANGLE_A), FRICTION)
    note = f"{NO_VALUES}; the model gives {ideal} of {relative:.4f} at 6 kN for screw A"
    return (
        not_possible(PAPER, "figures 5 to 8", "measured preload torques", "N m", "curves", note),
        not_possible(PAPER, "figure 9", "friction coefficient of each screw and preload", "", "curves", NO_VALUES),
        not_possible(PAPER, "figure 10", "efficiency of each screw and preload", "", "curves", NO_VALUES),
        not_possible(PAPER, "figure 11a", "efficiency over lead and contact angle", "", "surface", NO_VALUES),
    )
