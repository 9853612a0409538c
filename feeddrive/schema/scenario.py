"""Keys of a scenario file; `feeddrive.simulate.scenario.scenario_file` and its neighbours read them."""

from __future__ import annotations

from dataclasses import replace

from feeddrive.schema.controller import CONTROLLER, SOURCE
from feeddrive.schema.key import Key, Kind
from feeddrive.schema.section import Section, keyed

_RECORDED = (
    "setpoint",
    "motor_torque",
    "motor_angle",
    "motor_speed",
    "table_position",
    "table_velocity",
    "cutting_force",
    "injected_torque",
    "injected_speed",
)
_EVALUATED = (*_RECORDED, "speed_command")


def _needed(name: str, unit: str, meaning: str) -> Key:
    return Key(name, meaning, unit, minimum=0.0, open_ends=True, required=True)


def _place(name: str, meaning: str) -> Key:
    return Key(name, meaning, "m", required=True)


def _optional(name: str, unit: str, meaning: str, default: str | None = None) -> Key:
    return Key(name, meaning, unit, minimum=0.0, default=default)


def _listed(name: str, unit: str, meaning: str) -> Key:
    return Key(name, meaning, unit, Kind.QUANTITIES, required=True)


def _count(name: str, meaning: str, default: str | None = None, most: float = 1e9) -> Key:
    return Key(name, meaning, "1", Kind.WHOLE, 0, most, default=default, required=default is None)


_VELOCITY = _needed("velocity", "m/s", "greatest velocity")
_LIMITS = (
    Key("acceleration", "greatest acceleration", "m/s^2", minimum=0.0, open_ends=True, required=True),
    Key("jerk", "greatest jerk", "m/s^3", minimum=0.0, open_ends=True, required=True),
)
_SWEPT = "of a sweep or a multisine"
_WAVEFORM = (
    Key("waveform", "its shape over time", kind=Kind.TEXT, choices=("sweep", "multisine", "prbs"), required=True),
    Key("low", "least frequency", "Hz", minimum=0.0, open_ends=True, when=_SWEPT),
    Key("high", "greatest frequency", "Hz", minimum=0.0, open_ends=True, when=_SWEPT),
    Key("duration", "of the sweep", "s", minimum=0.0, open_ends=True, when="of a sweep"),
    Key("period", "of the multisine", "s", minimum=0.0, open_ends=True, when="of a multisine"),
    Key(
        "periods",
        "how often it is repeated",
        "1",
        Kind.WHOLE,
        0,
        1e9,
        default="1",
        when="of a multisine or a binary sequence",
    ),
    Key(
        "lines",
        "about so many frequencies in equal ratios; 0 for all",
        "1",
        Kind.WHOLE,
        0,
        1e9,
        default="0",
        when="of a multisine",
    ),
    Key("bit", "shortest time between changes", "s", minimum=0.0, open_ends=True, when="of a binary sequence"),
    Key("order", "of the shift register: 2^order - 1 bits", "1", Kind.WHOLE, 0, 1e9, when="of a binary sequence"),
)


def _motion(kind: str, meaning: str, *keys: Key) -> Section:
    return Section(f"scenario.trajectory.{kind}", meaning, keyed(*keys))


_DWELL = _optional("dwell", "s", "rest at each target", "0 s")
TRAJECTORY = Section(
    "scenario.trajectory",
    "the set-point",
    keyed(
        Key(
            "kind",
            "of motion",
            kind=Kind.TEXT,
            required=True,
            choices=("hold", "moves", "staircase", "position_step", "velocity_steps", "circle", "sine", "wave"),
        ),
        SOURCE,
    ),
    kinds={
        "hold": _motion(
            "hold", "rest at one position", _place("position", "of the table"), _needed("duration", "s", "how long")
        ),
        "moves": _motion(
            "moves",
            "from target to target",
            _place("start", "first position"),
            _listed("targets", "m", "positions in their order"),
            _listed("velocity", "m/s", "greatest velocity, one or one per target"),
            *_LIMITS,
            _DWELL,
            _count("repeat", "how often all targets are gone through", "1", 10_000),
        ),
        "staircase": _motion(
            "staircase",
            "forward and backward through targets, as ISO 230-2 asks",
            _listed("targets", "m", "positions, ascending"),
            _count("runs", "runs in each direction", None, 10_000),
            _needed("overrun", "m", "beyond the ends before turning"),
            _VELOCITY,
            *_LIMITS,
            _needed("dwell", "s", "rest at each target"),
        ),
        "position_step": _motion(
            "position_step",
            "a step of the position",
            _place("start", "before the step"),
            Key("height", "of the step", "m", required=True),
            _needed("at", "s", "when it steps"),
            _needed("duration", "s", "of the whole run, longer than `at`"),
        ),
        "velocity_steps": _motion(
            "velocity_steps",
            "constant velocities one after the other",
            _place("start", "first position"),
            _listed("velocities", "m/s", "with their sign"),
            _listed("durations", "s", "one per velocity"),
        ),
        "circle": _motion(
            "circle",
            "one axis of a circle",
            _place("centre", "of the circle"),
            _needed("radius", "m", "of the circle"),
            _needed("turns", "1", "how many"),
            _needed("velocity", "m/s", "the feed along the circle"),
            *_LIMITS,
            _optional("dwell", "s", "rest before and after", "0 s"),
        ),
        "sine": _motion(
            "sine",
            "a sine that fades in and out",
            _place("centre", "of the sine"),
            _needed("amplitude", "m", "of the sine"),
            _needed("frequency", "Hz", "of the sine"),
            _needed("duration", "s", "of the whole"),
            _needed("fade", "s", "in and out"),
        ),
        "wave": _motion(
            "wave",
            "a velocity as a waveform",
            _place("start", "first position"),
            Key("offset_velocity", "added to the waveform", "m/s", default="0 m/s"),
            _needed("amplitude", "m/s", "of the velocity"),
            *_WAVEFORM,
        ),
    },
)

EXCITATION = Section(
    "scenario.excitation",
    "a waveform added inside the controller",
    keyed(
        Key("at", "where it is added", kind=Kind.TEXT, choices=("speed", "torque"), required=True),
        Key("amplitude", "in rad/s at the speed, in N m at the torque", minimum=0.0, open_ends=True, required=True),
        _optional("start", "s", "when it begins", "0 s"),
        *_WAVEFORM,
        SOURCE,
    ),
)


def _force(kind: str, meaning: str, *keys: Key) -> Section:
    return Section(f"scenario.force.{kind}", meaning, keyed(*keys))


_START = Key("start", "when it begins", "s", default="0 s")
_END = Key("end", "when it ends; never if left out", "s")
FORCE = Section(
    "scenario.force",
    "one force on the table; several add",
    keyed(
        Key("kind", "of force", kind=Kind.TEXT, choices=("step", "triangle", "sine", "file", "milling"), required=True),
        SOURCE,
    ),
    kinds={
        "step": _force(
            "step", "a constant force for a time", Key("force", "with its sign", "N", required=True), _START, _END
        ),
        "triangle": _force(
            "triangle",
            "up, down, and back",
            _needed("amplitude", "N", "greatest force"),
            _needed("period", "s", "of one cycle"),
            _count("cycles", "how many", "1"),
            _START,
        ),
        "sine": _force(
            "sine",
            "a sine",
            _needed("amplitude", "N", "of the sine"),
            _needed("frequency", "Hz", "of the sine"),
            Key("mean", "added", "N", default="0 N"),
            _START,
        ),
        "file": _force(
            "file",
            "as recorded",
            Key(
                "path",
                "of a CSV with the columns time [s] and cutting_force [N], from the folder of the scenario",
                kind=Kind.TEXT,
                required=True,
            ),
        ),
        "milling": _force(
            "milling",
            "of a milling cutter",
            _count("teeth", "of the cutter", None, 1000),
            _needed("spindle_speed", "rad/s", "of the cutter"),
            _needed("depth", "m", "of cut, axial"),
            _needed("feed_per_tooth", "m", "of each tooth"),
            _needed("tangential", "Pa", "cutting coefficient along the speed"),
            Key("radial", "cutting coefficient across it", "Pa", default="0 Pa"),
            Key("entry", "angle at which a tooth enters", "rad", default="0 deg"),
            Key("exit", "angle at which it leaves", "rad", default="180 deg"),
            _START,
            _END,
        ),
    },
    listed=True,
)


def _evaluation(kind: str, meaning: str, *keys: Key) -> Section:
    return Section(f"scenario.evaluate.{kind}", meaning, keyed(*keys))


def _since(name: str, meaning: str, required: bool = False) -> Key:
    return Key(name, meaning, "s", minimum=0.0, required=required)


def _series(name: str, meaning: str) -> Key:
    return Key(name, meaning, kind=Kind.TEXT, choices=_EVALUATED, required=True)


_CYCLE = (_since("start", "of the first cycle", True), _since("period", "of one cycle", True))
EVALUATE = Section(
    "scenario.evaluate",
    "one set of figures worked out from the run",
    keyed(
        Key(
            "kind",
            "of figures",
            kind=Kind.TEXT,
            required=True,
            choices=(
                "following",
                "settling",
                "positioning",
                "circular",
                "friction_map",
                "force_loop",
                "torque_loop",
                "step",
                "response",
            ),
        ),
    ),
    kinds={
        "following": _evaluation(
            "following", "following error", _since("start", "of the stretch"), _since("end", "of the stretch")
        ),
        "settling": _evaluation(
            "settling",
            "settling at every stop",
            Key("window", "half-width that counts as settled", "m", minimum=0.0, required=True),
        ),
        "positioning": _evaluation(
            "positioning",
            "accuracy and repeatability, ISO 230-2",
            _since("average", "mean over the last of each dwell", True),
        ),
        "circular": _evaluation("circular", "circular deviation of one axis, ISO 230-4"),
        "friction_map": _evaluation(
            "friction_map", "mean torque at each constant velocity", _since("skip", "left out at the beginning of each")
        ),
        "force_loop": _evaluation("force_loop", "stiffness and lost motion of a loading cycle", *_CYCLE),
        "torque_loop": _evaluation("torque_loop", "the same under torque at the motor", *_CYCLE),
        "step": _evaluation(
            "step",
            "rise, overshoot, settling of a step",
            _series("channel", "that is looked at"),
            _since("at", "when it steps", True),
        ),
        "response": _evaluation(
            "response",
            "frequency response by averaged spectra",
            _series("input", "of the response"),
            _series("output", "of the response"),
            _since("segment", "length of one spectrum", True),
            _since("start", "left out before"),
        ),
    },
    listed=True,
)

RECORD = Section(
    "scenario.record",
    "what is written down",
    keyed(
        Key(
            "rate",
            "of the rows; velocity_rate is an integer multiple of it; position_rate if left out",
            "Hz",
            minimum=0.0,
            open_ends=True,
        ),
        Key("channels", "what is written down", kind=Kind.WORDS, choices=_RECORDED),
        Key("quantised", "round to the resolution of the plant's sensors", kind=Kind.SWITCH, default="false"),
        Key("seed", "of the noise", "1", Kind.WHOLE, 0, 1e9, default="0"),
        SOURCE,
    ),
    {
        "noise": Section(
            "scenario.record.noise",
            "standard deviation of white noise on a recorded channel, in its unit",
            keyed(*(Key(name, "standard deviation of its noise", minimum=0.0) for name in _RECORDED), SOURCE),
        )
    },
)


def scenario(effect: Section) -> Section:
    """The sections of a scenario file.

    Args:
        effect: [[effect]], as a plant file has it.
    """
    held = replace(
        CONTROLLER,
        path="scenario.controller",
        keys={
            **CONTROLLER.keys,
            "file": Key("file", "controller file that the rest of the table changes", kind=Kind.TEXT),
        },
    )
    return Section(
        "scenario",
        "an experiment",
        keyed(
            Key("format", 'its first line, "feeddrive-scenario/1"', kind=Kind.TEXT, required=True),
            Key("name", "of the experiment", kind=Kind.TEXT),
            Key("description", "in a sentence", kind=Kind.TEXT),
            Key("plant", "shipped name, or path from the folder of the scenario", kind=Kind.TEXT, required=True),
            Key("controller", "path of a controller file, or a table [controller]", kind=Kind.TEXT, required=True),
            Key("travel", "least and greatest set-point; the plant's stroke if left out", "m", Kind.QUANTITIES),
            SOURCE,
        ),
        {
            "controller": held,
            "run": Section(
                "scenario.run",
                "how long",
                keyed(Key("duration", "that of the trajectory if left out", "s", minimum=0.0, open_ends=True)),
            ),
            "record": RECORD,
            "trajectory": TRAJECTORY,
            "excitation": EXCITATION,
            "force": FORCE,
            "effect": replace(effect, path="scenario.effect"),
            "evaluate": EVALUATE,
        },
    )
