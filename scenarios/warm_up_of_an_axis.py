"""An axis without a linear scale repeats one servo cycle for hours: what its heat does to position and torque.

Milliseconds of the servo and hours of heat are one run: a cycle is simulated tick by tick, its friction heats the
screw, and it is simulated again whenever the temperatures have changed enough. The script prints the course and the
energy balance, and writes one figure.

    python scenarios/warm_up_of_an_axis.py [FOLDER [HOURS]]
"""

from __future__ import annotations

import sys

import feeddrive as fd


def main(folder: str, hours: str) -> None:
    """Run, print, and write the figure into a folder, where one is given."""
    warm = fd.repeat("warm_up_cycle", f"{hours} h", tolerance=0.05)  # K of the coupling in one step of the heat
    for table in warm.tables():
        print(table.text())
    if folder:
        print(f"Figure: {warm.save(folder)}")


if __name__ == "__main__":
    main(*[*sys.argv[1:], *["", "4"][len(sys.argv) - 1 :]])
