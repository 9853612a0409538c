"""Readers and controls of compensation files, written from the makers' published rules alone.

Nothing here is of `feeddrive`: a sign that is wrong in a writer must not be right again in its reader. Lengths are mm
as in the files, unless said.
"""

from __future__ import annotations

import math
import re
from bisect import bisect_right
from dataclasses import dataclass, field

NUMBER = r"[-+]?[0-9]*\.?[0-9]+"


# --- LinuxCNC: usrmotintf.cc (reading), command.c (EMCMOT_SET_JOINT_COMP), control.c (compute_screw_comp) ---


@dataclass
class LinuxCncJoint:
    """A joint with COMP_FILE_TYPE 0: entries, correction and its ramp."""

    velocity_limit: float
    acceleration_limit: float
    period: float
    nominal: list[float] = field(default_factory=list)
    forward: list[float] = field(default_factory=list)
    reverse: list[float] = field(default_factory=list)
    wanted: float = 0.0
    given: float = 0.0
    speed: float = 0.0

    def load(self, text: str) -> int:
        """Lines until the first that does not begin with three numbers; trim = nominal - actual; at most 256."""
        for line in text.splitlines():
            words = line.split()
            try:
                nominal, forward, reverse = (float(word) for word in words[:3])
            except ValueError:
                break
            if len(self.nominal) >= 256 or (self.nominal and nominal <= self.nominal[-1]):
                break
            self.nominal.append(nominal)
            self.forward.append(nominal - forward)
            self.reverse.append(nominal - reverse)
        return len(self.nominal)

    def _trim(self, trims: list[float], at: float) -> float:
        if at < self.nominal[0]:
            return trims[0]
        if at >= self.nominal[-1]:
            return trims[-1]
        i = bisect_right(self.nominal, at) - 1
        slope = (trims[i + 1] - trims[i]) / (self.nominal[i + 1] - self.nominal[i])
        return trims[i] + slope * (at - self.nominal[i])

    def cycle(self, position: float, velocity: float) -> float:
        """One servo period: position of the motor [mm]."""
        if velocity > 0:
            self.wanted = self._trim(self.forward, position)
        elif velocity < 0:
            self.wanted = self._trim(self.reverse, position)
        highest, change = 0.5 * self.velocity_limit, 0.5 * self.acceleration_limit * self.period
        side = 1.0 if self.wanted >= self.given else -1.0
        to_go, speed = side * (self.wanted - self.given), side * self.speed
        if to_go > 0:
            way = speed * self.period
            stop = 0.5 * (speed + change) ** 2 / (0.5 * self.acceleration_limit)
            if to_go <= stop + way:
                if speed > change:
                    speed, moved = speed - change, way - 0.5 * change * self.period
                else:
                    speed, moved = 0.0, to_go
            else:
                change = min(change, highest - speed)
                bit = 0.5 * change * self.period
                stop = 0.5 * (speed + change) ** 2 / (0.5 * self.acceleration_limit)
                if to_go > stop + way + bit:
                    speed, moved = speed + change, way + bit
                else:
                    moved = way
            self.given, self.speed = self.given + side * moved, side * speed
        return position + self.given


# --- SINUMERIK ---


def _variables(text: str) -> dict[str, str]:
    """Assignments of an initialisation file; what follows a semicolon is a comment."""
    found = {}
    for line in text.splitlines():
        line = line.split(";")[0].strip()
        if "=" in line:
            key, value = line.split("=", 1)
            assert key not in found, f"{key} is set twice"
            found[key] = value
    return found


@dataclass
class EvenTable:
    """A table of a SINUMERIK: straight between its points, the first and last beyond."""

    low: float
    step: float
    values: list[float]

    def at(self, position: float) -> float:
        place = (position - self.low) / self.step
        if place <= 0:
            return self.values[0]
        if place >= len(self.values) - 1:
            return self.values[-1]
        i = math.floor(place)
        return self.values[i] + (place - i) * (self.values[i + 1] - self.values[i])


def read_encoder_table(text: str, axis: str) -> EvenTable:
    """ENC_COMP of the first measuring system."""
    v = _variables(text)
    low, high, step = (float(v[f"$AA_ENC_COMP_{key}[0,{axis}]"]) for key in ("MIN", "MAX", "STEP"))
    count = round((high - low) / step) + 1
    assert abs((high - low) / step - (count - 1)) < 1e-9
    values = [float(v[f"$AA_ENC_COMP[0,{i},{axis}]"]) for i in range(count)]
    assert f"$AA_ENC_COMP[0,{count},{axis}]" not in v
    assert v[f"$AA_ENC_COMP_IS_MODULO[0,{axis}]"] == "0"
    return EvenTable(low, step, values)


def read_cec_tables(text: str, axis: str) -> dict[int, EvenTable]:
    """Direction to its table."""
    v, found = _variables(text), {}
    for t in (0, 1):
        assert v[f"$AN_CEC_INPUT_AXIS[{t}]"] == v[f"$AN_CEC_OUTPUT_AXIS[{t}]"] == f"({axis})"
        low, high, step = (float(v[f"$AN_CEC_{key}[{t}]"]) for key in ("MIN", "MAX", "STEP"))
        count = round((high - low) / step) + 1
        values = [float(v[f"$AN_CEC[{t},{i}]"]) for i in range(count)]
        assert f"$AN_CEC[{t},{count}]" not in v
        found[int(v[f"$AN_CEC_DIRECTION[{t}]"])] = EvenTable(low, step, values)
    return found


# --- ISG kernel ---


def read_isg(text: str) -> list[tuple[int, int, int]]:
    """Set-point, pos and neg of each point [0.1 um]."""
    keys = dict(line.split(None, 1) for line in text.splitlines() if line.strip() and not line.startswith("#"))
    assert keys["kw.ssfk.unit"] == "1"
    assert keys["kw.ssfk.interval"] == "0"
    assert keys["kw.ssfk.bilateral"] == "1"
    count = int(keys["kw.ssfk.kw_nr_max"])
    rows = [tuple(int(keys[f"kw.ssfk.table[{i}].{one}"]) for one in ("setpoint", "pos", "neg")) for i in range(count)]
    assert int(keys["kw.ssfk.kw_startpos"]) == rows[0][0]
    assert f"kw.ssfk.table[{count}].pos" not in keys
    return [(a, b, c) for a, b, c in rows]


# --- Heidenhain, CSV ---


def read_csv(text: str) -> tuple[list[str], list[list[float]]]:
    """Names of the columns and the rows."""
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    return lines[0].split(","), [[float(cell) for cell in line.split(",")] for line in lines[1:]]


# --- FANUC ---


@dataclass
class FanucAxis:
    """Stored pitch error compensation: increments of stretches, put out in their middle; backlash."""

    parameters: dict[int, int]
    increments: dict[int, int]
    unit: float = 1e-3

    @property
    def interval(self) -> float:
        """[mm]."""
        return self.parameters[3624] * self.unit

    def pulses(self, position: float, reference: float) -> float:
        """What is added to the command at a position [mm], without backlash."""
        p, total = self.parameters, 0
        for number, one in self.increments.items():
            middle = reference + (number - p[3620] - 0.5) * self.interval
            if reference < middle <= position:
                total += one
            elif position < middle < reference:
                total -= one
        return total * p[3623] * self.unit


def read_fanuc(text: str) -> FanucAxis:
    """Parameters and pitch data of a punched file."""
    lines = text.splitlines()
    assert lines[0] == lines[-1] == "%"
    parameters, increments = {}, {}
    for line in lines[1:-1]:
        if match := re.fullmatch(r"N(\d{5})A1P(-?\d+)", line):
            parameters[int(match[1])] = int(match[2])
        else:
            match = re.fullmatch(r"N(1\d{4})P(-?\d+)", line)
            assert match, line
            increments[int(match[1]) - 10000] = int(match[2])
    assert sorted(increments) == list(range(parameters[3621], parameters[3622] + 1))
    assert max(map(abs, increments.values())) <= 7
    return FanucAxis(parameters, increments)


# --- temperature: the text is run by this interpreter of its own few statements ---


def run_structured_text(text: str, temperature: float) -> tuple[float, float, float]:
    """K0 [mm], tan beta and P0 [mm] of the function block."""
    bare = re.sub(r"\(\*.*?\*\)", "", text, flags=re.S)
    parts = re.search(r"^VAR\n(.*?)^END_VAR\n(.*)", bare, re.S | re.M)
    assert parts
    declared, body = parts[1], parts[2]
    arrays = {
        name: [0.0, *map(float, values.split(","))]
        for name, values in re.findall(r"(\w+) : ARRAY\[1\.\.\d+\] OF REAL := \[(.*?)\];", declared)
    }
    p0 = re.search(rf"P0 : REAL := ({NUMBER});", bare)
    assert p0
    scope: dict[str, object] = {
        **arrays, "T": temperature, "i": 0, "share": 0.0, "K0": 0.0, "TanBeta": 0.0,
        "LIMIT": lambda low, x, high: min(max(low, x), high),
    }  # fmt: skip
    lines, depth = [], 0
    for line in body.replace("END_FUNCTION_BLOCK", "").splitlines():
        line = line.strip().rstrip(";").replace(":=", "=")
        if line.startswith("WHILE"):
            lines.append("    " * depth + f"while {line[6:-3].strip().replace(' AND ', ' and ')}:")
            depth += 1
        elif line == "END_WHILE":
            depth -= 1
        elif line:
            lines.append("    " * depth + line)
    exec("\n".join(lines), {"__builtins__": {}}, scope)
    return float(scope["K0"]), float(scope["TanBeta"]), float(p0[1])  # type: ignore[arg-type]
