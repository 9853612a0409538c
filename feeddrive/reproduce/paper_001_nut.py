"""Paper 001, section 3.3: load distribution along the nut, cycles and rating against the stroke."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from feeddrive.parts.life.rating import Rating, rating, rating_along_screw
from feeddrive.parts.life.stress_cycles import nut_cycles, screw_cycles, stressed_nut_groove, stressed_screw_groove
from feeddrive.parts.screw.load_distribution import load_distribution
from feeddrive.reproduce.row import Paper, Row, claim, not_possible, number
from feeddrive.reproduce.specimen_001 import (
    CIRCLE,
    CIRCLE_AND_NUT,
    PRELOAD,
    STROKE,
    specimen_body,
    specimen_loads,
    specimen_material,
    specimen_track,
)

_LIFE = Paper.LIFE
_MODEL = f"the paper gives no equation: standard model of elastic balls and bodies; {CIRCLE_AND_NUT}"


def nut_rows() -> tuple[Row, ...]:
    """Rows of distribution, cycles and rating."""
    return (*_distribution(), *_cycles(), *_ratings(), *_failures())


def _distribution() -> tuple[Row, ...]:
    loads = specimen_loads().relative
    long = load_distribution(specimen_body(turns=12.5), 5 * PRELOAD).relative.max()
    thin = load_distribution(specimen_body(nut_diameter=0.036), PRELOAD).relative.max()
    return (
        claim(_LIFE, "sec. 3.3 (a), Fig. 5", "load falls away from the ball next to the force", "greatest there",
              f"{loads[0]:.3f} to {loads[-1]:.3f} of the mean", bool(np.all(np.diff(loads) < 0)),
              law=load_distribution, assumption=_MODEL),
        claim(_LIFE, "sec. 3.3 (a)", "uneven load can be neglected in usual nuts, not with many turns or a thin nut",
              "neglected, not neglected",
              f"greatest {loads[0]:.2f} of the mean, {long:.2f} with 12.5 turns, {thin:.2f} with a nut of 36 mm",
              bool(loads[0] < 1.1 and long > 1.5 and thin > loads[0]), law=load_distribution, assumption=_MODEL),
        not_possible(_LIFE, "Fig. 5", "values of the load distribution", "N", "curve",
                     "no values in the available text"),
    )  # fmt: skip


def _cycles() -> tuple[Row, ...]:
    track = specimen_track()
    strokes = track.loaded_length * np.array([0.25, 0.5, 1.0, 2.0, 4.0, 10.0, 19.2])
    nut = np.array([nut_cycles(track, float(stroke)) / stroke for stroke in strokes])
    screw = np.array([screw_cycles(track, float(stroke)) for stroke in strokes if stroke > 0.999 * track.loaded_length])
    lengths = np.array([stressed_screw_groove(track, float(stroke)) for stroke in strokes])
    growth = np.diff(lengths) / np.diff(strokes)
    at_test = f"{nut_cycles(track, STROKE):.1f} cycles of the nut and {screw_cycles(track, STROKE):.2f} of the screw"
    return (
        claim(_LIFE, "sec. 3.3 (b), Fig. 6", "cycles of the nut grow in proportion to the stroke", "in proportion",
              f"{nut[0] / 1e3:.4f} to {nut[-1] / 1e3:.4f} per mm", bool(np.ptp(nut) < 1e-9 * nut[0]),
              law=nut_cycles, assumption=CIRCLE),
        claim(_LIFE, "sec. 3.3 (b), Fig. 6", "cycles of the screw stay constant from f_s = 1 on", "constant",
              f"{screw.min():.2f} to {screw.max():.2f}", bool(np.ptp(screw) < 1e-9 * screw[0]),
              law=screw_cycles, assumption=CIRCLE),
        claim(_LIFE, "sec. 3.3 (b), Fig. 6", "stressed length of the screw grows with the stroke, of the nut not",
              "in proportion, constant",
              f"{growth[0]:.2f} mm per mm, {1e3 * stressed_nut_groove(track):.1f} mm at all strokes",
              bool(np.ptp(growth) < 1e-9 * growth[0]), law=stressed_screw_groove, assumption=CIRCLE),
        not_possible(_LIFE, "Fig. 6", "stressed lengths and cycles of the specimen", "", "curves",
                     f"no values in the available text; at the test's stroke {at_test}"),
    )  # fmt: skip


def _ratings() -> tuple[Row, ...]:
    ratios = (1.0, 1.5, 2.0, 3.0, 4.0, 10.0, 19.2)
    found = [_rating_at(ratio) for ratio in ratios]
    nuts = [one.nut for one in found]
    pairs = [one.pair for one in found]
    growth = found[-1].screw / found[0].screw
    at_two = _rating_at(2.0)
    crossing = brentq(lambda ratio: _rating_at(ratio).screw - _rating_at(ratio).nut, 1.1, 19.0)
    by_zones = brentq(lambda ratio: _zone_rating_at(ratio).screw - _zone_rating_at(ratio).nut, 1.1, 19.0)
    calibrated = f"material constant from 13.5 kN and 300 000 rev; {CIRCLE_AND_NUT}"
    return (
        claim(_LIFE, "sec. 3.3 (b), Fig. 7", "rating of the nut does not depend on the stroke", "constant",
              f"{min(nuts) / 1e3:.3f} to {max(nuts) / 1e3:.3f} kN", bool(np.ptp(nuts) < 1e-9 * nuts[0]),
              law=rating, assumption=calibrated),
        claim(_LIFE, "sec. 3.3 (b), Fig. 7", "rating of the screw is proportional to the stroke above f_s = 1",
              "in proportion", f"{growth:.2f} times for a stroke of {ratios[-1]:g} times", growth > 0.9 * ratios[-1],
              law=rating, otherwise="by eqs. (11), (19), (20) it grows as about the fourth root of the stroke"),
        claim(_LIFE, "sec. 3.3 (b), Fig. 7", "rating of the pair rises with the stroke above f_s = 1", "rises",
              f"{pairs[0] / 1e3:.2f} to {pairs[-1] / 1e3:.2f} kN", bool(np.all(np.diff(pairs) > 0)),
              law=rating, assumption=calibrated),
        number(_LIFE, "sec. 3.3 (b), Fig. 7", "f_s at which the nut takes over from the screw", "", "2", crossing,
               law=rating,
               otherwise=f"by eqs. (19), (20); {by_zones:.1f} where every point of the screw counts with its own "
               f"cycles; {CIRCLE_AND_NUT}"),
        claim(_LIFE, "sec. 3.3 (b)", "C is about C_B at f_s below 2", "about equal",
              f"at f_s = 2 {1 - at_two.pair / at_two.screw:.1%} below", at_two.pair > 0.95 * at_two.screw,
              law=rating, assumption=calibrated),
        claim(_LIFE, "sec. 3.3 (b)", "C is about C_M from f_s = 2 on", "about equal",
              f"at f_s = 2 {1 - at_two.pair / at_two.nut:.1%} below", at_two.pair > 0.95 * at_two.nut,
              law=rating, otherwise=f"within 5 % only from f_s of about {_near_nut():.1f} on"),
        not_possible(_LIFE, "Fig. 7", "rating by eqs. (15) to (17) equal to the simulation of case T-C", "kN",
                     "almost the same", "the constant A_1 of the material is not printed"),
    )  # fmt: skip


def _failures() -> tuple[Row, ...]:
    found = _rating_at(STROKE / specimen_track().loaded_length)
    later = (found.screw / found.nut) ** 3
    return (
        claim(_LIFE, "sec. 2.2, conclusion 2", "all first failures lie in the nut", "all ten",
              f"{found.nut_share:.1%} of the failures are in the nut", found.nut_share**10 > 0.5,
              law=rating, assumption=CIRCLE_AND_NUT),
        claim(_LIFE, "sec. 2.2", "pits on the screw at 2 to 3 times the life of the nut are copies of its pits",
              "not its own fatigue", f"its own rated life is {later:.1f} times that of the nut", later > 3.0,
              law=rating, assumption=CIRCLE_AND_NUT),
    )  # fmt: skip


def _rating_at(ratio: float) -> Rating:
    """Ratings of the specimen at a stroke of f_s, as the paper computes them."""
    track = specimen_track()
    return rating(track, specimen_loads(), ratio * track.loaded_length, specimen_material())


def _zone_rating_at(ratio: float) -> Rating:
    """Rating where every point of the screw counts with its own cycles."""
    track = specimen_track()
    return rating_along_screw(track, specimen_loads(), ratio * track.loaded_length, specimen_material())


def _near_nut() -> float:
    """f_s from which on C is within 5 % of C_M."""
    return float(brentq(lambda ratio: _rating_at(ratio).pair / _rating_at(ratio).nut - 0.95, 1.1, 19.0))
