"""Keys of a controller: a file of its own, [controller] of a scenario, and a cascade that a plant file declares."""

from __future__ import annotations

from dataclasses import replace

from feeddrive.schema.key import Key, Kind
from feeddrive.schema.section import Section, keyed

SOURCE = Key("source", "where the values come from, of every value here that names none itself", kind=Kind.TEXT)


def _above_zero(name: str, unit: str, meaning: str, default: str | None = None, required: bool = False) -> Key:
    return Key(name, meaning, unit, minimum=0.0, open_ends=True, default=default, required=required)


_AT = Key("at", "where the filter acts", kind=Kind.TEXT, choices=("torque", "speed"), default="torque")
_FILTER_KIND = Key("kind", "of the filter", kind=Kind.TEXT, choices=("PT1", "PT2", "notch", "biquad"), required=True)


def _filter(kind: str, meaning: str, *keys: Key) -> Section:
    return Section(f"controller.filter.{kind}", meaning, keyed(*keys))


def _of_filter(name: str, unit: str, meaning: str) -> Key:
    return Key(name, meaning, unit, minimum=0.0, open_ends=True, required=True)


FILTER = Section(
    "controller.filter",
    "one filter of the torque or the speed",
    keyed(_FILTER_KIND, _AT),
    kinds={
        "PT1": _filter("PT1", "lag of first order", _of_filter("frequency", "Hz", "corner frequency")),
        "PT2": _filter(
            "PT2",
            "low-pass of second order",
            _of_filter("frequency", "Hz", "corner frequency"),
            _of_filter("damping", "1", "damping ratio"),
        ),
        "notch": _filter(
            "notch",
            "notch",
            _of_filter("frequency", "Hz", "its middle"),
            _of_filter("bandwidth", "Hz", "width at -3 dB"),
            _of_filter("depth", "dB", "attenuation at its middle"),
        ),
        "biquad": _filter(
            "biquad",
            "zeros and poles of second order",
            _of_filter("zero_frequency", "Hz", "of the zeros"),
            _of_filter("zero_damping", "1", "damping ratio of the zeros"),
            _of_filter("pole_frequency", "Hz", "of the poles"),
            _of_filter("pole_damping", "1", "damping ratio of the poles"),
        ),
    },
    listed=True,
)

FEED_FORWARD = Section(
    "controller.feed_forward",
    "what is added ahead of the loops",
    keyed(
        Key("speed", "share of the set-point's speed", "1", minimum=0.0, default="0"),
        Key("torque", "share of the torque that accelerates the inertia", "1", minimum=0.0, default="0"),
        Key("inertia", "at the motor; that of the plant if left out", "kg m^2", minimum=0.0),
        Key("coulomb", "friction torque", "N m", minimum=0.0, default="0 N m"),
        Key("smoothing_speed", "motor speed at which the friction turns", "rad/s", minimum=0.0, default="1 rad/s"),
        Key("viscous", "torque per speed", "N m s/rad", minimum=0.0, default="0 N m s/rad"),
    ),
)

_KEYS = keyed(
    Key("format", 'its first line, "feeddrive-controller/1"', kind=Kind.TEXT, when="in a file of its own"),
    Key("name", "of the controller", kind=Kind.TEXT),
    SOURCE,
    _above_zero("velocity_rate", "Hz", "of the velocity loop, an integer multiple of position_rate", required=True),
    _above_zero("position_rate", "Hz", "of the position loop", required=True),
    _above_zero("position_gain", "1/s", "K_v; also in (m/min)/mm; needed where the position loop is closed"),
    _above_zero("velocity_gain", "N m s/rad", "K_p; needed where the velocity loop is closed"),
    _above_zero("reset_time", "s", "T_n of the velocity loop; no integrator if left out"),
    _above_zero("tracking_time", "s", "of the anti-windup; the reset time if left out"),
    Key(
        "position_feedback", "which position is controlled", kind=Kind.TEXT, choices=("motor", "table"), default="motor"
    ),
    _above_zero("current_bandwidth", "Hz", "-3 dB of the closed current loop; no lag if left out"),
    Key("dead_time", "between command and torque", "s", minimum=0.0, default="0 s"),
    _above_zero("torque_limit", "N m", "at most that of the motor; that of the motor if left out"),
    _above_zero("current_limit", "A", "with torque_constant another torque limit"),
    _above_zero("torque_constant", "N m/A", "of the motor, with current_limit"),
    _above_zero("speed_limit", "rad/s", "of the speed command; none if left out"),
    Key(
        "balancing_time", "time constant by which the position loop's set-point waits", "s", minimum=0.0, default="0 s"
    ),
    Key("torque_offset", "added to the torque command", "N m", default="0 N m"),
    Key(
        "mode", "which loops are closed", kind=Kind.TEXT, choices=("position", "velocity", "torque"), default="position"
    ),
    Key("allow_unstable", "whether an unstable loop may run", kind=Kind.SWITCH, default="false"),
)

CONTROLLER = Section(
    "controller", "a cascade of position and velocity loop", _KEYS, {"feed_forward": FEED_FORWARD, "filter": FILTER}
)
"""A controller file, or the table of it; names of drives' makers stand for these (`feeddrive.servo.vendor_names`)."""

_SERVO = "a servo that commands a voltage: position over velocity, both proportional"
DECLARED_CONTROLLER = Section(
    "plant.controller",
    "the controller of the machine",
    keyed(
        Key("kind", "of the controller", kind=Kind.TEXT, choices=("position_velocity", "cascade"), required=True),
        SOURCE,
    ),
    kinds={
        "position_velocity": Section(
            "plant.controller.position_velocity",
            _SERVO,
            keyed(
                _above_zero("position_gain", "1/s", "speed command per following error", required=True),
                _above_zero("velocity_gain", "V s/m", "output per error of velocity", required=True),
                _above_zero("output_limit", "V", "of the output", required=True),
                _above_zero("torque_per_output", "N m/V", "motor torque per output", required=True),
                Key(
                    "velocity_samples",
                    "velocity from the position over so many samples; 0 for velocity itself",
                    "1",
                    Kind.WHOLE,
                    0,
                    64,
                    default="0",
                ),
            ),
        ),
        "cascade": replace(CONTROLLER, path="plant.controller.cascade"),
    },
)
"""[controller] of a plant file."""
