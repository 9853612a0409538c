"""How often, and over what length, the grooves of screw and nut are stressed in one stroke.

    g_B = pi d_B / cos(gamma_B),   l_0B = g_B (zeta + l_s / l)            g_M = pi d_M / cos(gamma_M),   l_0M = g_M zeta
    K = d_B cos(gamma_m) cos(gamma_B - gamma_m) / (2 d_m cos(gamma_B))
    u_sB = (z / (l zeta)) min(l_s, l zeta) (1 - K)                        u_sM = (z / (l zeta)) l_s K

| symbol | meaning | unit |
|---|---|---|
| l_s | stroke, one way | m |
| l, zeta, z | lead, loaded turns, loaded balls | m, 1, 1 |
| g, l_0 | groove per turn, stressed groove; B screw, M nut | m |
| u_s | stress cycles in one stroke: of every point of the nut, of the points of the screw stressed most | 1 |
| K | travel of the balls along the nut over that of the screw's surface | 1 |
| d, gamma | diameters and lead angles of `feeddrive.parts.screw.screw_contact` | m, rad |

The nut is stressed everywhere alike, more often the longer the stroke. A point of the screw is stressed at most by one
whole passage of the nut, whatever the stroke: a longer one only stresses more of it.
Source: paper 001, eqs. (18) to (22); that the angle in K is the difference of the two lead angles follows from the
kinematics and is derived here.
"""

from __future__ import annotations

import math

from feeddrive.errors import InputError
from feeddrive.parts.screw.screw_contact import BallTrack


def screw_groove_per_turn(track: BallTrack) -> float:
    """g_B [m]."""
    return math.pi * track.screw_diameter / math.cos(track.lead_angle(track.screw_diameter))


def nut_groove_per_turn(track: BallTrack) -> float:
    """g_M [m]."""
    return math.pi * track.nut_diameter / math.cos(track.lead_angle(track.nut_diameter))


def stressed_screw_groove(track: BallTrack, stroke: float) -> float:
    """l_0B [m] for a stroke [m]."""
    return screw_groove_per_turn(track) * (track.turns + _checked(stroke) / track.lead)


def effective_screw_groove(track: BallTrack, stroke: float, slope: float) -> float:
    """Length of groove stressed as often as the most stressed points that fails as likely as all of the screw [m].

    g_B / l (|l_s - l zeta| + 2 min(l_s, l zeta) / (e + 1)): the product of the survivals along the trapezoid of
    cycles along the screw, to the Weibull slope e; derived here. Paper 001 counts all of l_0B as stressed most.
    """
    if not (math.isfinite(slope) and slope > 0.0):
        raise InputError(f"a Weibull slope of {slope:g}", "stress cycles", "write a slope above 0")
    ramp = min(_checked(stroke), track.loaded_length)
    plateau = abs(stroke - track.loaded_length)
    return screw_groove_per_turn(track) / track.lead * (plateau + 2.0 * ramp / (slope + 1.0))


def stressed_nut_groove(track: BallTrack) -> float:
    """l_0M [m], the same for every stroke."""
    return nut_groove_per_turn(track) * track.turns


def ball_travel_share(track: BallTrack) -> float:
    """K [1]: a little below a half."""
    at_screw, at_balls = track.lead_angle(track.screw_diameter), track.lead_angle(track.pitch_diameter)
    share = track.screw_diameter / (2.0 * track.pitch_diameter)
    return share * math.cos(at_balls) * math.cos(at_screw - at_balls) / math.cos(at_screw)


def stroke_ratio(track: BallTrack, stroke: float) -> float:
    """f_s [1]: stroke over the loaded length of the nut."""
    return _checked(stroke) / track.loaded_length


def screw_cycles(track: BallTrack, stroke: float) -> float:
    """u_sB: cycles of the most stressed points of the screw in one stroke [m]."""
    return track.balls * min(stroke_ratio(track, stroke), 1.0) * (1.0 - ball_travel_share(track))


def nut_cycles(track: BallTrack, stroke: float) -> float:
    """u_sM: cycles of every point of the nut in one stroke [m]."""
    return track.balls * stroke_ratio(track, stroke) * ball_travel_share(track)


def _checked(stroke: float) -> float:
    if not (math.isfinite(stroke) and stroke > 0.0):
        raise InputError(f"a stroke of {stroke:g} m", "stress cycles", "write a stroke above 0")
    return stroke
