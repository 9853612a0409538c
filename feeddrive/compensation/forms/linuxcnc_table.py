"""LinuxCNC: screw compensation file of a joint (`COMP_FILE`), type 0.

    nominal forward reverse          three numbers a line, blanks between, machine units (here mm)

Forward and reverse are the positions at which the joint really stands when `nominal` is commanded. The control adds
trim = nominal - actual of the direction of the commanded velocity to the command of the motor; standing, the last
direction holds. Between points straight, beyond them constant. The value follows by a ramp of half the joint's maximal
velocity and acceleration. Reading stops silently at the first line that is not three numbers: there can be no comment.
With a table, BACKLASH is ignored.

Source: LinuxCNC 5c41560, src/emc/motion/control.c (compute_screw_comp), command.c, usrmotintf.cc;
docs/src/config/ini-config.adoc, COMP_FILE.
"""

from __future__ import annotations

from collections.abc import Sequence

from feeddrive.compensation.forms.control import Control, Reversal, millimetres
from feeddrive.compensation.table import CompensationTable

_MOST = 256  # EMCMOT_COMP_SIZE


def _write(table: CompensationTable, _: Sequence[str], __: str) -> str:
    rows = zip(table.positions, table.positions + table.forward, table.positions + table.reverse, strict=True)
    return "".join(" ".join(millimetres(one, 6) for one in row) + "\n" for row in rows)


def _load(_: CompensationTable, axis: str) -> tuple[str, ...]:
    return (
        f"In the INI file, section [JOINT_n] of axis {axis}: COMP_FILE = name of the file, COMP_FILE_TYPE = 0.",
        "The file is in mm: the machine's LINEAR_UNITS must be mm.",
        "BACKLASH of the joint is ignored then; leave it at 0.",
        "STEPGEN_MAXACCEL must be 1.5 to 2 times MAX_ACCELERATION, as the value comes on top of the motion.",
        "At rest the ramp may stop short by MAX_ACCELERATION / 2 x period^2 (0.5 um at 1 m/s^2 and 1 ms).",
    )


LINUXCNC = Control(
    name="linuxcnc",
    title="LinuxCNC (COMP_FILE_TYPE 0)",
    sign_rule="forward, reverse = nominal + (actual - target), actual positions; the control adds nominal - actual",
    source="LinuxCNC src/emc/motion/command.c and control.c; docs/src/config/ini-config.adoc",
    resolution=1e-9,
    most_points=_MOST,
    usual_points=_MOST,
    reversal=Reversal(ramped=True),
    comments=False,
    load=_load,
    write=_write,
)
