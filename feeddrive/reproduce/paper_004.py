"""Every number and checkable claim of paper 004 beside what the program computes."""

from __future__ import annotations

from feeddrive.parts.combined_stiffness import CombinedStiffness, Deformation, axial_from_torsional, combined_stiffness
from feeddrive.parts.screw_drive import BallScrewDrive
from feeddrive.reproduce.paper_004_claims import efficiency_rows, part_rows
from feeddrive.reproduce.paper_004_drive import CUT_OFF, FORCE_LENGTH, MODULI, TORQUE_LENGTH, paper_drive
from feeddrive.reproduce.paper_004_measurement import measurement_rows
from feeddrive.reproduce.row import Paper, Row, number

_CUT = f"{MODULI}; {CUT_OFF}"
_OF_SCREW = f"{MODULI}; E and G are the round values that give the printed stiffness of the screw"
_SPLIT = f"{MODULI}; coupling and motor shaft chosen to give it, so this checks eq. (7), not the paper"


def rows() -> tuple[Row, ...]:
    """The comparison, in the paper's order."""
    drive = paper_drive()
    found = combined_stiffness(drive, FORCE_LENGTH)
    return (
        *efficiency_rows(drive, found),
        *_axial_rows(drive, found),
        *_torsional_rows(drive, found),
        *_combined_rows(drive, found),
        *part_rows(found),
        *measurement_rows(drive, found),
    )


def _axial_rows(drive: BallScrewDrive, found: CombinedStiffness) -> tuple[Row, ...]:
    screw = drive.screw.axial_stiffness(FORCE_LENGTH)
    return (
        number(Paper.STIFFNESS, "sec. 3", "k_BS, screw", "N/µm", "468", screw / 1e6, assumption=_OF_SCREW),
        number(Paper.STIFFNESS, "eq. (6)", "k_XS, axial chain", "N/µm", "244.7", found.axial / 1e6, assumption=MODULI),
    )


def _torsional_rows(drive: BallScrewDrive, found: CombinedStiffness) -> tuple[Row, ...]:
    screw = drive.screw.torsional_stiffness(TORQUE_LENGTH)
    chain = found.torsional
    return (
        # One unit of the last printed digit, since that is cut off.
        number(Paper.STIFFNESS, "sec. 3", "k_BS,T, screw", "N m/rad", "31134.5", screw, within=0.1 / 31134.5,
               assumption=f"{_OF_SCREW}; {CUT_OFF}"),
        number(Paper.STIFFNESS, "eq. (7)", "k_TS, torsional chain", "N m/rad", "11982.4", chain, assumption=_SPLIT),
    )  # fmt: skip


def _combined_rows(drive: BallScrewDrive, found: CombinedStiffness) -> tuple[Row, ...]:
    axial, torsional = (100.0 * found.share(chain) for chain in (Deformation.AXIAL, Deformation.TORSIONAL))
    ratio = axial_from_torsional(found.torsional, found.lead) / found.axial
    loosely = 'its own shares of 83 and 17 % are 4.9 to 1: "about 4" only loosely'
    paper = Paper.STIFFNESS
    return (
        # One unit of the last printed digit, since that is cut off.
        number(paper, "eq. (8)", "k_TOTAL,X, combined", "N/µm", "202.7", found.total / 1e6, within=0.1 / 202.7,
               assumption=_CUT),
        number(paper, "eq. (8), (5)", "k_TOTAL,T, combined", "N m/rad", "2054.3", found.total_torsional,
               within=0.1 / 2054.3, assumption=_CUT),
        number(paper, "Fig. 4", "share of the axial chain", "%", "83", axial, assumption=MODULI),
        number(paper, "Fig. 4", "share of the torsional chain", "%", "17", torsional, assumption=MODULI),
        number(paper, "abstract", "axial to torsional share, to 1", "", "4", ratio, otherwise=loosely),
        number(paper, "conclusion 3", "torsional over axial stiffness", "", "4", ratio, otherwise=loosely),
        number(paper, "sec. 4", "first natural frequency, table's mass alone", "Hz", "195.7",
               found.natural_frequency(drive.table_mass), within=0.1 / 195.7, assumption=_CUT),
    )  # fmt: skip
