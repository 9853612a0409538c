"""The declared plant of a generated axis with the controller of the generator declared too."""

from __future__ import annotations

from pathlib import Path

from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from tests.generator.axis import AXES


def controller_text(axis: str, soft: bool = False, rate: str = "2 kHz") -> str:
    """The table of a plant file; `soft` as the generator's controller of an axis with a delay."""
    control = AXES[axis].controller
    gain = control.soft_speed_gain if soft else control.speed_gain
    return f"""
[controller]
kind = "cascade"
velocity_rate = "{rate}"
position_rate = "{rate}"
position_gain = "{control.position_gain} 1/s"
velocity_gain = "{gain} N m s/rad"
reset_time = "{control.integral_time} s"
torque_limit = "{control.torque_limit} N m"
[controller.feed_forward]
speed = 1.0
"""


def plant_file(folder: Path, axis: str, soft: bool = False, rate: str = "2 kHz") -> Path:
    """The plant file of the axis with its controller, written into a folder."""
    text = (plants_folder() / f"{axis}_axis.toml").read_text(encoding="utf-8")
    path = folder / f"{axis}_axis.toml"
    path.write_text(text + controller_text(axis, soft, rate), encoding="utf-8")
    return path


def controlled_plant(folder: Path, axis: str, soft: bool = False, rate: str = "2 kHz") -> Plant:
    """The plant of that file."""
    return read_plant(plant_file(folder, axis, soft, rate))
