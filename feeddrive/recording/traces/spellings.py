"""How units and names are spelt in files: units as controls write them, words of other languages."""

from __future__ import annotations

import re

SPELLINGS = {
    "ampere": "A",
    "amp": "A",
    "amps": "A",
    "nm": "N m",
    "n.m": "N m",
    "n·m": "N m",
    "1/min": "rev/min",
    "min-1": "rev/min",
    "min^-1": "rev/min",
    "u/min": "rev/min",
    "rpm": "rev/min",
    "r/min": "rev/min",
    "grad": "deg",
    "degree": "deg",
    "degrees": "deg",
    "°": "deg",
    "grad/s": "deg/s",
    "°/s": "deg/s",
    "mm/sec": "mm/s",
    "sec": "s",
    "inch": "in",
    "inch/min": "in/min",
    "inches": "in",
    "rad/sec": "rad/s",
    "u": "rev",
    "umdr": "rev",
    "turns": "rev",
    "upm": "rev/min",
    "min⁻¹": "rev/min",
    "giri/min": "rev/min",
    "newton meter": "N m",
    "newtonmeter": "N m",
    "c": "degC",
    "°c": "degC",
    "celsius": "degC",
    "ma": "mA",
    "a": "A",
    "n": "N",
    "kn": "kN",
    "sek": "s",
    "secs": "s",
    "second": "s",
    "seconds": "s",
    "msec": "ms",
    "usec": "µs",
} | {
    unit.lower(): unit
    for unit in ("mm", "µm", "um", "mm/s", "mm/min", "m/s", "m/min", "in", "in/min", "deg/s", "rad/s")
}
"""Units as controls write them, in small letters -> as feeddrive reads them."""

_WORDS = {
    "实际": "actual", "反馈": "actual", "指令": "set", "设定": "set", "给定": "set", "位置": "position",
    "速度": "velocity",
    "转速": "speed", "转矩": "torque", "扭矩": "torque", "力矩": "torque", "电流": "current", "电机": "motor",
    "工作台": "table",
    "误差": "error", "偏差": "error", "时间": "time",
    "positionsistwert": "actual position", "momentenistwert": "actual torque", "coppia motore": "motor torque",
    "corrente motore": "motor current", "velocità motore": "motor speed", "giri motore": "motor speed",
    "posizione": "position", "velocità": "velocity", "coppia": "torque", "corrente": "current", "motore": "motor",
    "tavola": "table", "errore": "error", "effettiva": "actual", "effettivo": "actual", "reale": "actual",
    "misurata": "measured", "comandata": "commanded", "nominale": "nominal", "giri": "speed", "tempo": "time",
    "ist position": "actual position", "antriebsmoment": "motor torque", "motormoment": "motor torque",
    "motorstrom": "motor current", "motordrehzahl": "motor speed", "motorlage": "motor position",
    "motorwinkel": "motor angle", "lageist": "actual position", "lagesoll": "set position",
    "drehmomentist": "actual torque", "stromist": "actual current", "drehzahlist": "actual speed",
    "lageistwert": "actual position", "lagesollwert": "set position", "tischposition": "table position",
    "tischlage": "table position",
}  # fmt: skip
"""Words of Chinese and Italian, and German ones that are written together -> English."""
_FOREIGN_WORD = re.compile(
    "|".join(
        re.escape(word) if ord(word[0]) > 0x3000 else rf"\b{re.escape(word)}\b"  # Chinese has no word boundaries
        for word in sorted(_WORDS, key=len, reverse=True)
    )
)


def in_english(name: str) -> str:
    """Return a name in small letters with its foreign words in English, between blanks."""
    return _FOREIGN_WORD.sub(lambda word: f" {_WORDS[word[0]]} ", name)
