"""A feed drive measured softer and slower than its catalogue says: what can explain it, and what would decide.

The drive of paper 004 (Lee, Park, Ro, Lee): calculated 202.7 N/µm and 195.7 Hz, measured 191 N/µm and 185 Hz. The
script prints the verdict, each declared value made alone to meet both numbers, and what a further measurement would
tell; it writes the report with its figure.

    python scenarios/combined_stiffness_gap.py [FOLDER]
"""

from __future__ import annotations

import sys
from pathlib import Path

import feeddrive as fd


def main(folder: str) -> None:
    """Print the verdict and the table, and write the report."""
    drive = fd.load("kimm_testbed")
    print(drive.stiffness(at="464 mm"))  # the nut is then 564 mm from the bearing, as in the paper
    print(drive.modes("464 mm"))
    found = fd.explain(drive, Path(__file__).parent / "measured" / "kimm_testbed.toml")
    print(f"\n{found.verdict}\n\n{found.listing().text()}")
    print(f"Report: {found.save(folder)}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
