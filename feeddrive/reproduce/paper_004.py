"""Every number and checkable claim of paper 004 beside what the program computes."""

from __future__ import annotations

from feeddrive.parts.combined_stiffness import (
    CombinedStiffness,
    Deformation,
    axial_from_torsional,
    combined_stiffness,
    natural_frequency,
)
from feeddrive.parts.screw.ball_screw import ScrewShaft
from feeddrive.parts.screw.screw_drive import BallScrewDrive
from feeddrive.reproduce.paper_004_claims import efficiency_rows, part_rows
from feeddrive.reproduce.paper_004_drive import (
    AXIAL_CHAIN,
    CUT_OFF,
    FORCE_LENGTH,
    LEAD,
    MODULI,
    TABLE_MASS,
    TORQUE_LENGTH,
    TORSIONAL_CHAIN,
    paper_drive,
    printed_chains,
    printed_parts,
)
from feeddrive.reproduce.paper_004_measurement import measurement_rows
from feeddrive.reproduce.row import Paper, Row, number

_OF_SCREW = f"{MODULI}; E and G are the round values that give the printed stiffness of the screw"
_SPLIT = f"{MODULI}; coupling and motor shaft chosen to give it"


def rows() -> tuple[Row, ...]:
    """The comparison, in the paper's order."""
    drive = paper_drive()
    found = combined_stiffness(drive, FORCE_LENGTH)
    return (
        *efficiency_rows(drive, found),
        *_axial_rows(drive),
        *_torsional_rows(drive, found),
        *_combined_rows(),
        *part_rows(found),
        *measurement_rows(drive),
    )


def _axial_rows(drive: BallScrewDrive) -> tuple[Row, ...]:
    screw, paper = drive.screw.axial_stiffness(FORCE_LENGTH), Paper.STIFFNESS
    chain = printed_parts().axial
    return (
        number(paper, "sec. 3", "k_BS, screw", "N/µm", "468", screw / 1e6, law=ScrewShaft.axial_stiffness,
               fitted=_OF_SCREW),
        number(paper, "eq. (6)", "k_XS, axial chain, from the printed parts", "N/µm", "244.7", chain / 1e6,
               law=CombinedStiffness),
    )  # fmt: skip


def _torsional_rows(drive: BallScrewDrive, found: CombinedStiffness) -> tuple[Row, ...]:
    screw = drive.screw.torsional_stiffness(TORQUE_LENGTH)
    return (
        # One unit of the last printed digit, since that is cut off.
        number(Paper.STIFFNESS, "sec. 3", "k_BS,T, screw", "N m/rad", "31134.5", screw,
               law=ScrewShaft.torsional_stiffness,
               within=0.1 / 31134.5, fitted=f"{_OF_SCREW}; {CUT_OFF}"),
        number(Paper.STIFFNESS, "eq. (7)", "k_TS, torsional chain", "N m/rad", "11982.4", found.torsional,
               law=combined_stiffness, fitted=_SPLIT),
    )  # fmt: skip


def _combined_rows() -> tuple[Row, ...]:
    """From the printed stiffness of the two chains."""
    chains, paper, law = printed_chains(), Paper.STIFFNESS, CombinedStiffness
    axial, torsional = (100.0 * chains.share(chain) for chain in (Deformation.AXIAL, Deformation.TORSIONAL))
    ratio = axial_from_torsional(TORSIONAL_CHAIN, LEAD) / AXIAL_CHAIN
    loosely = 'its own shares of 83 and 17 % are 4.9 to 1: "about 4" only loosely'
    return (
        number(paper, "eq. (8)", "k_TOTAL,X, combined", "N/µm", "202.7", chains.total / 1e6, law=law),
        number(paper, "eq. (8), (5)", "k_TOTAL,T, combined", "N m/rad", "2054.3", chains.total_torsional, law=law),
        number(paper, "Fig. 4", "share of the axial chain", "%", "83", axial, law=law),
        number(paper, "Fig. 4", "share of the torsional chain", "%", "17", torsional, law=law),
        number(paper, "abstract", "axial to torsional share, to 1", "", "4", ratio, law=axial_from_torsional,
               otherwise=loosely),
        number(paper, "conclusion 3", "torsional over axial stiffness", "", "4", ratio, law=axial_from_torsional,
               otherwise=loosely),
        number(paper, "sec. 4", "first natural frequency, table's mass on the printed k_TOTAL,X", "Hz", "195.7",
               natural_frequency(202.7e6, TABLE_MASS), law=natural_frequency),
    )  # fmt: skip
