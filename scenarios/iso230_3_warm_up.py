"""ISO 230-3: a linear axis heats itself by moving, then cools down; what each thermal compensation leaves of the error.

The axis of plants/thermal_bench.toml with motor, bearing housings and bed (their values are assumed, for an axis of
this size) goes to and fro at 750 rev/min for 4 h and rests for 4 h. The machine that is tried is not as declared: 10 %
more heat, 10 % less film, a motor that heats the front bearing by an undeclared 10 W, air that warms by 2 K. The script
prints the numbers of the test, the best places for one, two, three sensors and the error that each compensation leaves;
it writes figures and the table for a CNC.

    python scenarios/iso230_3_warm_up.py [FOLDER]
"""

from __future__ import annotations

import sys

import feeddrive as fd

BODIES = {
    "motor_flange": ("front", "900 J/K", "0.5 W/K", "0.4 W/K"),
    "front_housing": ("front", "1500 J/K", "3 W/K", "0.4 W/K"),
    "rear_housing": ("rear", "1000 J/K", "3 W/K", "0.3 W/K"),
    "bed": ("front", "60 kJ/K", "0.2 W/K", "4 W/K"),
}
MOTOR = {"motor_flange": "10 W"}


def main(folder: str) -> None:
    """Print the tables and write the files."""
    axis = fd.load("thermal_bench")
    for name, (port, capacity, conductance, to_air) in BODIES.items():
        axis = axis.with_body(name, port, capacity=capacity, conductance=conductance, to_air=to_air)
    design = fd.thermal_compensation(axis, sensors=3, heats=MOTOR, reference="200 mm")
    tried = design.on("750 rev/min", "4 h", "4 h", heat=1.1, film=0.9, undeclared=MOTOR, air="2 K")
    for table in tried.tables():
        print(table.text(), end="\n\n")
    print(f"Figures and the table for a CNC: {tried.save(folder)}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
