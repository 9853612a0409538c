"""A feed drive measured softer and slower than its catalogue says: what can explain it, and what would decide.

The drive of paper 004 (Lee, Park, Ro, Lee): calculated 202.7 N/µm and 195.7 Hz, measured 191 N/µm and 185 Hz. The
script prints how far the screw's own mass closes the gap of the frequency, which single changes close that of the
stiffness, and all pairs that meet both, with the measurement that would single out each. It writes one figure.

    python scenarios/combined_stiffness_gap.py [FOLDER]
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from feeddrive.diagnosis.stiffness.candidates import Candidate, DriveAt
from feeddrive.diagnosis.stiffness.gap import Explanation, Solved, explain_both, explain_stiffness, frequency_of
from feeddrive.files import write_bytes_atomically
from feeddrive.parts.bearings.bearing import SupportBearing
from feeddrive.parts.bearings.supports import ScrewSupports, Support
from feeddrive.parts.combined_stiffness import combined_stiffness, natural_frequency
from feeddrive.parts.coupling import Coupling
from feeddrive.parts.material import ShaftMaterial
from feeddrive.parts.motor import Motor
from feeddrive.parts.screw.ball_screw import ScrewShaft
from feeddrive.parts.screw.nut import Nut
from feeddrive.parts.screw.screw_drive import BallScrewDrive
from feeddrive.plant.analysis.held_frequency import held_frequency
from feeddrive.report.figures.drawing import render
from feeddrive.report.figures.figure_stiffness_gap import stiffness_gap_figure
from feeddrive.units.quantity import format_quantity
from tests.analytic.rayleigh import added_mass

STIFFNESS, FREQUENCY = 191e6, 185.0  # measured [N/m, Hz]
NUT = 0.564  # from the fixed bearing [m]
ELSEWHERE = 0.2  # another nut position, at which a second test would be made [m]


def drive(screw_length: float, coupling_inertia: float) -> BallScrewDrive:
    """The paper's drive; it prints neither the screw's length nor the coupling's inertia."""
    steel = ShaftMaterial(young=210e9, shear=83e9, density=7850.0, expansion=11.7e-6)
    return BallScrewDrive(
        screw=ScrewShaft(lead=0.020, diameter=0.040, length=screw_length, stub=0.106, material=steel),
        nut=Nut(1499e6),
        supports=ScrewSupports(Support.FIXED_SUPPORTED, SupportBearing(780e6)),
        table_mass=134.0,
        motor=Motor(rotor_inertia=6e-3, torque_limit=50.0, shaft_stiffness=69_930.0),
        coupling=Coupling(27_000.0, coupling_inertia),
    )


def print_own_mass(start: DriveAt) -> None:
    """How far the screw's own mass and inertia lower the frequency."""
    stiffness, table = start.stiffness, start.drive.table_mass
    added = added_mass(start.drive, start.position)
    axial = added.axial_stub + added.axial_span + added.axial_overhang
    rotary = added.rotary_span + added.rotary_overhang
    steps = [("table alone", 0.0), ("screw's mass", axial), ("screw's inertia", rotary), ("coupling", added.hubs)]
    mass = table
    for name, more in steps:
        mass += more
        here, softer = (natural_frequency(k, mass) for k in (stiffness, STIFFNESS))
        print(f"  {'+ ' if more else '':2}{name:16} {more:6.2f} kg   {here:7.1f} Hz   {softer:7.1f} Hz")
    exact = held_frequency(start.drive, start.position)
    soft = frequency_of(explain_stiffness(start, STIFFNESS)[0].state)
    print(f"    chain of the screw            {exact:7.1f} Hz   {soft:7.1f} Hz   (Rayleigh's is a bound from above)")


def print_single(found: Sequence[Solved]) -> None:
    """Changes that each give the measured stiffness, and what they foretell at another nut position."""
    for letter, one in zip("ABCDEF", found, strict=False):
        shift = one.state.position - NUT
        other = combined_stiffness(one.state.drive, ELSEWHERE + shift).total
        print(f"  {letter}  {change(one):58} {other / 1e6:6.1f} N/µm   {one.candidate.measurement}")


def print_pairs(pairs: Sequence[Explanation], letters: dict[str, str]) -> None:
    """All pairs that meet both measurements; the measurements that decide are in the lists, by letter."""
    for pair in pairs:
        static, dynamic = pair.static, pair.dynamic
        who = f"{letters[static.candidate.name]} + {letters[dynamic.candidate.name]}"
        what = f"{static.candidate.name} {shown(static)}, {dynamic.candidate.name} {shown(dynamic)}"
        print(f"  {who}  {what:78} {pair.stiffness / 1e6:6.1f} N/µm {pair.frequency:6.1f} Hz")


def print_deciding(candidates: Sequence[Candidate], letters: dict[str, str]) -> None:
    """What would single out each of the other masses."""
    for candidate in candidates:
        print(f"  {letters[candidate.name]}  {candidate.name:20} {candidate.measurement}")


def change(one: Solved) -> str:
    """What is changed, from which value to which."""
    candidate = one.candidate
    before = "rigid" if candidate.declared is None else format_quantity(candidate.declared, candidate.unit)
    return f"{candidate.name}: {before} -> {shown(one)}"


def shown(one: Solved) -> str:
    """The value found, with its unit."""
    return format_quantity(one.value, one.candidate.unit)


def main(folder: Path) -> None:
    """Print the tables and write the figure."""
    short, long = DriveAt(drive(0.9, 0.0), NUT), DriveAt(drive(1.2, 3e-3), NUT)
    print(
        f"Calculated {short.stiffness / 1e6:.1f} N/µm, measured {STIFFNESS / 1e6:.0f}; measured {FREQUENCY:.0f} Hz.\n"
    )
    print("First natural frequency at the calculated and at the measured stiffness, masses after Rayleigh")
    print(" screw of 1.2 m, coupling of 3e-3 kg m²")
    print_own_mass(long)
    print(f"\nSingle changes that give the measured stiffness; foretold at {ELSEWHERE:g} m; what would decide")
    single = explain_stiffness(long, STIFFNESS)
    print_single(single)
    letters = {one.candidate.name: letter for one, letter in zip(single, "ABCDEF", strict=False)}
    dynamic: dict[str, Candidate] = {}
    for start, words in ((short, "0.9 m, coupling without inertia"), (long, "1.2 m, coupling of 3e-3 kg m²")):
        pairs = explain_both(start, STIFFNESS, FREQUENCY)
        dynamic |= {pair.dynamic.candidate.name: pair.dynamic.candidate for pair in pairs}
        letters |= {name: letter for name, letter in zip(dynamic, "abcd", strict=False)}
        print(f"\nPairs that meet both, from a screw of {words} ({frequency_of(start):.1f} Hz before any change)")
        print_pairs(pairs, letters)
    print("\nWhat would decide among the second of each pair")
    print_deciding(tuple(dynamic.values()), letters)
    print("\nOne static and one dynamic number cannot separate these: each pair above meets both exactly.")
    figure = stiffness_gap_figure(long, single, FREQUENCY, np.linspace(0.65, 1.5, 40))
    path = folder / "combined_stiffness_gap.png"
    write_bytes_atomically(path, render(figure).png)
    print(f"Figure: {path}")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out"))
