"""Paper 003 (friction force of LM ball guides) beside what the program computes.

It prints the guides' geometry, accuracies, shares and claims in words; its forces are curves without printed values,
and its coefficients are not published.
"""

from __future__ import annotations

import numpy as np

from feeddrive.reproduce.paper_003_equations import equation_rows
from feeddrive.reproduce.paper_003_loads import load_rows
from feeddrive.reproduce.paper_003_shares import share_rows
from feeddrive.reproduce.row import Paper, Row, claim, not_possible

_PAPER = Paper.GUIDE
ACCURACY = {"HSR-20R": (99.98, 89.64, 91.24, 95.58), "HSR-30R": (94.45, 99.26, 90.78, 97.23)}
"""Table 4 [%], at 0, 1, 3, 6 kN."""


def rows() -> tuple[Row, ...]:
    """One row per printed number and checkable claim, in the order of the paper."""
    return (*equation_rows(), *load_rows(), *_accuracies(), *share_rows(), *_unreachable())


def _accuracies() -> tuple[Row, ...]:
    """Means of table 4; its entries rest on measurements that are not printed."""
    means = {"both sizes": np.mean(list(ACCURACY.values())), **{name: np.mean(v) for name, v in ACCURACY.items()}}
    above = (
        claim(_PAPER, "table 4", f"mean accuracy, {name}", "above 93 %", f"{mean:.2f} %", bool(mean > 93.0), law=None)
        for name, mean in means.items()
    )
    entries = [accuracy for values in ACCURACY.values() for accuracy in values]
    below = sum(entry < 93.0 for entry in entries)
    every = claim(
        _PAPER, "sec. 6 (4)", "accuracy against experiment in every condition", "above 93 %",
        f"{min(entries):.2f} % in one condition", min(entries) > 93.0, law=None,
        otherwise=f"the mean of table 4 is above, {below} of its {len(entries)} entries are below",
    )  # fmt: skip
    return (*above, every)


def _unreachable() -> tuple[Row, ...]:
    unpublished = "not published; shares fix ratios alone"
    curves = "curves without printed values"
    return (
        not_possible(_PAPER, "eq. 8", "rolling coefficient mu_t", "1", "", unpublished),
        not_possible(_PAPER, "eq. 10", "slip coefficient mu_s", "1", "", unpublished),
        not_possible(_PAPER, "eq. 9", "viscosity of the oil", "Pa s", "", unpublished),
        not_possible(_PAPER, "fig. 3", "ball load over load and preload", "N", "", curves),
        not_possible(_PAPER, "fig. 7", "measured friction", "N", "", f"{curves}; number of carriages not said"),
        not_possible(_PAPER, "fig. 8", "predicted friction", "N", "", f"{curves}; coefficients not published"),
        not_possible(_PAPER, "fig. 9", "friction parts over load and speed", "N", "", curves),
        not_possible(_PAPER, "table 4", "the eight accuracies", "%", "89.64 to 99.98",
                     "they compare with measurements of which only curves are printed"),
    )  # fmt: skip
