"""Which canonical channel a signal of a trace file is, by its name: the words of vendors, and of English and German.

A name gives a quantity and a role (`s soll`: position, set-point); the unit gives the rest: a position in mm is of the
table, one in degrees of the motor. Only measured values and the position set-point have a channel.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from feeddrive.errors import InputError
from feeddrive.recording.channels import CHANNEL_UNITS, channel_unit
from feeddrive.recording.traces.spellings import SPELLINGS, in_english
from feeddrive.recording.traces.trace import Signal
from feeddrive.units.quantity import Conversion, unit_conversion

UNIT_BEHIND = re.compile(r"^(.*\S)\s*[\[(]([^\])\[(]{1,20})[\])]$")
"""A name with brackets behind it."""

_LENGTH, _ANGLE, _VELOCITY, _SPEED = "m", "rad", "m/s", "rad/s"


@dataclass(frozen=True)
class Candidate:
    """What a signal may be.

    Attributes:
        channel: canonical channel; `motor_side_position` for a motor encoder counted in the unit of the axis, which
            the lead makes a motor_angle.
        unit: that its values are taken in; empty if unknown.
        reason: why, for people.
        rank: among signals that may be the same channel the lowest is taken.
        stated: whether the file itself states the unit.
        sign: -1 where the signal was found to be reversed.
        foreign: unit that the file states and that is not known, such as increments; empty otherwise.
    """

    channel: str
    unit: str
    reason: str
    rank: int
    stated: bool
    sign: float = 1.0
    foreign: str = ""


@dataclass(frozen=True)
class _Rule:
    """A pattern of names.

    Attributes:
        pattern: found in the name, small letters, words divided by single blanks.
        channels: tried in this order against the unit.
        unit: where the file says none; empty if unknown.
        reason: what the name means.
        rank: see `Candidate`.
    """

    pattern: re.Pattern[str]
    channels: tuple[str, ...]
    unit: str
    reason: str
    rank: int


MOTOR_SIDE = "motor_side_position"


def _rule(pattern: str, channels: str, unit: str, reason: str, rank: int = 5) -> _Rule:
    return _Rule(re.compile(pattern), tuple(channels.split()), unit, reason, rank)


_SIDES = f"table_position motor_angle {MOTOR_SIDE}"
_ACTUAL = r"(?:act(?:ual)?|ist|fb|fbk|feedback|meas(?:ured)?|istwert)"
_NOMINAL = (
    r"(?:set(?: ?point)?|cmd|command(?:ed)?|nom(?:inal)?|soll(?:wert)?|target|desired|des(?= ?(?:pos|vel|curr|torq))"
    r"|demand(?:ed)?|ref(?:erence)?)"
)
_POSITION = r"(?:pos(?:ition|n)?|lage)"
_SPEED_WORD = r"(?:v|velo?|velocity|speed|geschwindigkeit|drehzahl|n)"
_ROTARY = r"(?:speed|drehzahl|n|velo?|velocity)"

_RULES = (
    # SINUMERIK Edge: NAME|axis
    _rule(r"^enc2 pos at \S+$", "table_position", "mm", "direct encoder (ENC2)", 0),
    _rule(r"^enc1 pos at \S+$", MOTOR_SIDE, "mm", "motor encoder (ENC1), in the unit of the axis", 0),
    _rule(r"^enc pos at \S+$", "table_position", "mm", "active encoder (ENC)", 1),
    _rule(r"^des pos at \S+$", "setpoint", "mm", "set-point", 0),
    _rule(r"^torque at \S+$", "motor_torque", "N m", "torque", 1),
    _rule(r"^current at \S+$", "motor_current", "A", "torque-producing current", 1),
    # SINUMERIK Operate trace: /Nck/!SD/nckServoData..., /Nck/!SEMA/measPos...
    _rule(r"\b(?:meas pos|act pos) ?2(?:nd enc\d*)?\b", "table_position", "", "direct encoder (measuring system 2)", 0),
    _rule(r"\b(?:meas pos|act pos) ?1(?:st enc\d*)?\b", MOTOR_SIDE, "", "motor encoder (measuring system 1)", 0),
    _rule(r"\bcmd ?pos ?2nd enc\d*\b", "setpoint", "", "set-point", 0),
    _rule(r"nck servo data cmd ?pos|nck sema cmd contr pos", "setpoint", "", "set-point", 1),
    _rule(r"nck servo data act (?:pos|curr pos)", "table_position", "", "actual position", 2),
    _rule(r"nck servo data act vel ?2nd enc", "table_velocity", "", "velocity of the direct encoder", 1),
    _rule(r"nck servo data act vel ?1st enc", "table_velocity", "", "velocity of the motor encoder", 3),
    _rule(r"nck servo data act curr ?\d", "motor_current", "A", "torque-producing current i_q", 0),
    _rule(r"nck servo data act torq", "motor_torque", "N m", "actual torque", 0),
    _rule(r"nck servo data act ?vel ?mot(?! ?or ?side)", "motor_speed", "", "motor speed", 0),
    # TNCscope, also its debug channels of the drive's processor
    _rule(r"^s (?:ist|act|actual)\b", "table_position", "mm", "actual position (s ist)", 0),
    _rule(r"^s (?:soll|nom|nominal)\b", "setpoint", "mm", "set-point (s soll)", 0),
    _rule(r"^v (?:ist|act|actual)\b", "table_velocity motor_speed", "mm/min", "actual feed rate (v ist)", 2),
    _rule(r"^v n (?:ist|act|actual)\b", "motor_speed table_velocity", "", "actual speed of the motor (v N act)", 1),
    _rule(r"^i (?:ist|act|actual)\b", "motor_current", "A", "actual current (I ist)", 2),
    _rule(r"^(?:i|iq) (?:soll|nom|nominal)\b", "motor_current", "A", "nominal current (I nominal)", 3),
    _rule(r"\bid 10\b", "motor_current", "A", "torque current, debug channel id(10)", 0),
    _rule(r"\bid 217\b", "table_position", "", "linear encoder, debug channel id(217)", 1),
    _rule(r"\bid 222\b", "setpoint", "", "commanded position, debug channel id(222)", 1),
    _rule(r"\bid 126\b", "motor_speed", "rad/s", "motor velocity, debug channel id(126)", 0),
    # LinuxCNC: positions of joints, also of their motors, are in machine units
    _rule(r"^joint \d+ pos fb$", "table_position", "", "position of the joint", 0),
    _rule(r"^joint \d+ motor pos fb$", "table_position", "", "position of the joint's motor", 1),
    _rule(r"^joint \d+ pos cmd$", "setpoint", "", "position set-point of the joint", 0),
    _rule(r"^joint \d+ motor pos cmd$", "setpoint", "", "position set-point of the joint's motor", 1),
    # Any program: role and quantity in either order
    _rule(rf"\b{_NOMINAL} ?{_POSITION}\b|\b{_POSITION} ?{_NOMINAL}\b", "setpoint", "", "position set-point", 6),
    _rule(
        r"\b(?:linear (?:scale|encoder)|direct encoder|encoder 2|load (?:pos|position))\b",
        "table_position",
        "",
        "encoder of the table",
        3,
    ),
    _rule(rf"\b(?:table|axis|load|carriage) ?{_POSITION}\b", "table_position", "", "position of the table", 4),
    _rule(
        rf"\bmotor ?(?:angle|{_POSITION}|encoder)(?: {_ACTUAL})?\b", "motor_angle table_position", "", "motor angle", 4
    ),
    _rule(rf"\b{_ACTUAL} ?{_POSITION}\b|\b{_POSITION} ?{_ACTUAL}\b", _SIDES, "", "actual position", 5),
    _rule(rf"^(?:{_POSITION}|s|x)$", _SIDES, "", "position", 8),
    _rule(rf"\bmotor ?{_ROTARY}(?: {_ACTUAL})?\b", "motor_speed table_velocity", "", "motor speed", 4),
    _rule(
        rf"\b{_ACTUAL} ?{_SPEED_WORD}\b|\b{_SPEED_WORD} ?{_ACTUAL}\b",
        "table_velocity motor_speed",
        "",
        "actual velocity",
        5,
    ),
    _rule(
        r"\b(?:table|axis|load|carriage) ?(?:velo|velocity|speed)\b", "table_velocity", "", "velocity of the table", 4
    ),
    _rule(
        rf"\b(?:motor|{_ACTUAL}) ?(?:torque|drehmoment|moment)\b|\b(?:torque|drehmoment|moment) ?{_ACTUAL}\b",
        "motor_torque motor_torque_share",
        "",
        "actual torque",
        4,
    ),
    _rule(r"^(?:torque|drehmoment|motor_torque)$", "motor_torque motor_torque_share", "", "torque", 6),
    _rule(
        rf"\b(?:motor|torque|{_ACTUAL}) ?(?:curr(?:ent)?|strom)\b|\b(?:curr(?:ent)?|strom) ?{_ACTUAL}\b|\bi ?q\b",
        "motor_current",
        "",
        "actual current",
        4,
    ),
    _rule(r"^(?:current|curr|strom|i)$", "motor_current", "", "current", 6),
)
_NOT_MEASURED = re.compile(
    r"\b(?:ffw|feed ?forward|vorsteuer\w*|limit|max|min|error|err|diff|dev|deviation|window|enable|factor|offset|raw"
    r"|load|trig(?:ger)?)\b"
)
_COMMANDED = re.compile(rf"\b{_NOMINAL}\b")
_SUFFIX = re.compile(r"(.*[A-Za-z\d])_(mm|um|µm|nm|deg|rad|rpm|Nm|NM|mA|mm_s|mm_min|m_s|m_min|rad_s|deg_s|degC|mps)")
_WITH_NOT_MEASURED = re.compile(r"^(?:load (?:pos|position|velo|velocity|speed))\b")
_AXIS = re.compile(
    r"(?:axis|achse|joint|joints|axes)[ _.]*(\d+)\b|\baxis[ _.]([a-z])\b"
    r"|\b([xyzabcuvw]\d?)[ _-]?(?:axis|achse)\b",
    re.IGNORECASE,
)


def candidate(signal: Signal) -> Candidate | None:
    """Return what a signal is by its name; None if the name says nothing that has a channel.

    The last part of a path is a name as well (`fast/Position`), and a unit may be joined to it (`position_mm`).
    """
    last = leaf(signal.name)
    suffix = _SUFFIX.fullmatch(last)
    stated = signal.unit or (suffix[2].replace("_", "/").replace("mps", "m/s") if suffix else "")
    unit = known_unit(stated)
    foreign = stated.strip() if not unit and stated.strip().lower() not in _NO_UNIT else ""
    names = list(dict.fromkeys((signal.name, last, suffix[1] if suffix else last)))
    for name in names:
        exact = _canonical(name, unit)
        if exact is not None:
            return replace(exact, unit="" if foreign else exact.unit, foreign=foreign)
    for text in (*names, signal.about):
        words = plain_words(text)
        if _NOT_MEASURED.search(words) and not _WITH_NOT_MEASURED.search(words):
            return None
        for rule in _RULES:
            if rule.pattern.search(words) and not (rule.rank >= 4 and rule.channels != ("setpoint",)
                                                   and _COMMANDED.search(words)):  # fmt: skip
                found = _fitting(rule, unit, foreign) or (_fitting(rule, "nm", "") if stated.strip() == "nm" else None)
                if found is not None:
                    return found
    return None


_NO_UNIT = frozenset(
    ("", "-", "--", "1", "none", "(none)", "[none]", "[]", "[-]", "()", "(-)", "[1]", "n/a", "?", "unit", "%")
)


def leaf(name: str) -> str:
    """Return the last part of the path that a name may be: `ActPos` of `drive/ActPos` and of `rec.ActPos`."""
    match = UNIT_BEHIND.match(name.strip())
    last = re.split(r"[/.]", match[1] if match else name)[-1].strip()
    return (f"{last} [{match[2]}]" if match else last) if last else name


def known_unit(text: str) -> str:
    """Return a unit of a file as feeddrive writes it; empty where the file gives none, or one that is not known."""
    plain = text.strip().replace("\u03bc", "µ")
    if plain[:1] + plain[-1:] in ("[]", "()", "{}"):
        plain = plain[1:-1].strip()
    unit = SPELLINGS.get(plain.lower(), plain)
    if not unit or unit in ("-", "1", "%"):
        return unit if unit == "%" else ""
    for channel in ("m", "rad", "m/s", "rad/s", "N m", "A", "degC", "N", "s"):
        if conversion(unit, channel) is not None:
            return unit
    return ""


def conversion(unit: str, needed: str) -> Conversion | None:
    """Return the conversion of a unit; None if it measures something else."""
    try:
        return unit_conversion(unit, needed, "")
    except InputError:
        return None


def plain_words(name: str) -> str:
    """Return a name in small letters, its words divided by single blanks: `nckServoDataMeasPos1 [u1, 7]`."""
    apart = re.sub(r"([a-z0-9])([A-Z])", r"\1 \2", name.replace("_", " ").replace("|", " at "))
    apart = in_english(apart.lower())
    return re.sub(r"[^a-z0-9äöüß]+", " ", apart.lower()).strip()


def axis_in(*names: str) -> str:
    """Return the axis that a name speaks of, such as `1` of `Axes.Axis 1.ActPos`; empty if it speaks of none."""
    for name in names:
        match = _AXIS.search(name.replace("_", " ") if "joint" not in name.lower() else name)
        if match:
            return next(group for group in match.groups() if group).upper()
    return ""


def is_rotary(axis: str) -> bool:
    """Tell whether an axis is rotary or a spindle by its letter (ISO 841: A, B, C)."""
    return re.fullmatch(r"[ABC]\d*|SP\d*|S\d*|SPINDLE\d*", axis.upper()) is not None


def _canonical(name: str, unit: str) -> Candidate | None:
    """Take a name that is a canonical channel, with or without its unit in brackets."""
    match = re.fullmatch(r"\s*([A-Za-z0-9_]+)\s*(?:\[([^\]]*)\])?\s*", name)
    if match is None:
        return None
    channel, written = match[1], known_unit(match[2] or "") or unit
    try:
        needed = channel_unit(channel, "")
    except InputError:
        return None
    if channel == "time" or (written and conversion(written, needed) is None):
        return None
    return Candidate(channel, written, f"it is called {channel}", -1, bool(written))


def _fitting(rule: _Rule, unit: str, foreign: str) -> Candidate | None:
    """Return the first channel of a rule that the unit allows; a unit that is stated and not known is left open."""
    for channel in rule.channels:
        needed = CHANNEL_UNITS.get(channel, _LENGTH)
        if unit and conversion(unit, needed) is not None:
            return Candidate(channel, unit, rule.reason, rule.rank, True)
    if unit:
        return None
    channel = rule.channels[0]
    return Candidate(channel, "" if foreign else rule.unit, rule.reason, rule.rank, False, 1.0, foreign)
