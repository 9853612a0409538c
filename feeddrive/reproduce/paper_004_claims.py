"""Claims of paper 004 about efficiency, conversion and the weakest parts."""

from __future__ import annotations

import math

from feeddrive.parts.combined_stiffness import (
    CombinedStiffness,
    Deformation,
    axial_from_torsional,
    combined_stiffness,
    torsional_from_axial,
)
from feeddrive.parts.screw.screw_drive import BallScrewDrive
from feeddrive.parts.screw.wedge import (
    self_locking,
    self_locking_lead,
    wedge_back_driving_efficiency,
    wedge_efficiency,
)
from feeddrive.reproduce.paper_004_drive import MODULI, printed_chains, printed_parts
from feeddrive.reproduce.row import Paper, Row, claim, not_possible, number, span

_BALLS = (0.002, 0.004)
_SLIDING = (0.1, 0.2)
_PAPER = Paper.STIFFNESS


def efficiency_rows(drive: BallScrewDrive, found: CombinedStiffness) -> tuple[Row, ...]:
    """Friction, efficiency, self-locking and the conversion (section 2)."""
    lead, diameter = drive.screw.lead, drive.screw.diameter
    own = tuple(100.0 * wedge_efficiency(mu, lead, diameter) for mu in _BALLS)
    finer = tuple(100.0 * wedge_efficiency(mu, lead / 2.0, diameter) for mu in _BALLS)
    paired = _SLIDING[0] / _BALLS[0]
    return (
        number(_PAPER, "sec. 2", "friction of lead screw over ball screw", "", "50", paired,
               law=None, assumption="least with least, most with most; unpaired it is 25 to 100"),
        span(_PAPER, "sec. 2", "efficiency of this screw, lead 20 mm", "%", 95.0, 98.0, own,
             law=wedge_efficiency, slack=0.5,
             otherwise="its lead angle of 9 degrees loses less than printed at the printed friction"),
        span(_PAPER, "sec. 2", "efficiency at half this lead", "%", 95.0, 98.0, finer, law=wedge_efficiency, slack=0.5,
             assumption="a lead of 10 mm on 40 mm, as a wedge; the lead is not printed with the claim"),
        _locking_row(lead, diameter),
        _lossless_row(drive, found),
        _conversion_row(drive),
    )  # fmt: skip


def part_rows(found: CombinedStiffness) -> tuple[Row, ...]:
    """Which part is the weakest (section 3, Figs. 2 and 3, conclusions)."""
    axial, twist = printed_parts().shares_within(Deformation.AXIAL), found.shares_within(Deformation.TORSIONAL)
    order = sorted(axial, key=lambda part: -axial[part])
    chains = printed_chains()
    too_stiff = 100.0 * (chains.axial / chains.total - 1.0)
    rest = 1.0 / (1.0 / found.torsional - twist["screw"] / found.torsional)
    split = "only the sum of coupling and motor is printed; 27 000 and 69 930 N m/rad are chosen for this order"
    return (
        claim(_PAPER, "Fig. 2, conclusion 2", "weakest axial part", "screw, over half", _percent(axial),
              order[0] == "screw" and axial["screw"] > 0.5, law=CombinedStiffness),
        claim(_PAPER, "sec. 3", "second weakest axial part", "bearing", order[1], order[1] == "bearing",
              law=CombinedStiffness),
        claim(_PAPER, "Fig. 3, conclusion 2", "weakest in torsion", "coupling, screw close, motor small",
              _percent(twist), twist["coupling"] > twist["screw"] > twist["motor shaft"], law=combined_stiffness,
              fitted=split),
        not_possible(_PAPER, "eq. (7)", "coupling and motor each", "N m/rad", "in Fig. 3 only",
                     f"text and tables give only both in series, {rest:.0f} N m/rad"),
        claim(_PAPER, "sec. 1, 3", "torsion must not be left out", "not to be overlooked",
              f"axial chain alone is {too_stiff:.0f} % too stiff", too_stiff > 10.0, law=CombinedStiffness),
    )  # fmt: skip


def _locking_row(lead: float, diameter: float) -> Row:
    states = [self_locking(mu, lead, diameter) for mu in _SLIDING]
    texts = [f"{'locks' if state else 'runs back'} at {mu:g}" for mu, state in zip(_SLIDING, states, strict=True)]
    finest = 1e3 * self_locking_lead(_SLIDING[0], diameter)
    otherwise = f"at 0.1 a screw of 40 mm locks up to a lead of {finest:.1f} mm only"
    return claim(
        _PAPER, "sec. 2", "lead screw of friction 0.1 to 0.2 locks itself", "locks", ", ".join(texts),
        all(states), law=self_locking, otherwise=otherwise,
    )  # fmt: skip


def _lossless_row(drive: BallScrewDrive, found: CombinedStiffness) -> Row:
    """Losses at the nut keep the share 1 - eta_back of a force from the twist: the drive gets that little stiffer."""
    eta = min(wedge_back_driving_efficiency(mu, drive.screw.lead, drive.screw.diameter) for mu in _BALLS)
    stiffer = 1.0 / (1.0 / found.axial + eta / axial_from_torsional(found.torsional, found.lead))
    gain = 100.0 * (stiffer / found.total - 1.0)
    return claim(
        _PAPER, "sec. 2", "twist and displacement turn into each other almost without loss", "almost no loss",
        f"back-driving {100.0 * eta:.1f} %, stiffness +{gain:.2f} %", gain < 1.0, law=wedge_back_driving_efficiency,
        assumption=MODULI,
    )  # fmt: skip


def _conversion_row(drive: BallScrewDrive) -> Row:
    """Eqs. (2)-(4) with one force: the twist that the torque makes must be the one that the displacement needs."""
    stiffness, force, r = 200e6, 1000.0, drive.screw.lead / (2.0 * math.pi)
    twist = force * r / torsional_from_axial(stiffness, drive.screw.lead)
    error = abs(twist * r / (force / stiffness) - 1.0)
    return claim(
        _PAPER, "eqs. (1)-(5)", "the conversion follows from equal power", "both ways",
        f"eqs. (2)-(4) close to {max(error, 1e-15):.0e}", error < 1e-12, law=torsional_from_axial,
    )  # fmt: skip


def _percent(shares: dict[str, float]) -> str:
    return ", ".join(f"{part} {100.0 * share:.0f} %" for part, share in sorted(shares.items(), key=lambda one: -one[1]))
