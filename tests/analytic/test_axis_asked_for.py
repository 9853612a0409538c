"""A machine may be named wherever an axis is asked for; what cannot be is one line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import feeddrive as fd

ASKED: dict[str, Callable[[object], object]] = {
    "cascade": lambda axis: fd.cascade(axis, velocity_gain="1 N m s/rad", reset_time="10 ms"),  # type: ignore[arg-type]
    "sampled": lambda axis: fd.sampled(axis, "4 kHz"),  # type: ignore[arg-type]
    "move": lambda axis: fd.move(axis, torque=0.0, duration="10 ms"),  # type: ignore[arg-type]
    "bench": lambda axis: fd.bench(axis, controller="step_position"),  # type: ignore[arg-type]
}


@pytest.mark.parametrize("name", ASKED)
def test_a_machine_is_named(name: str) -> None:
    assert ASKED[name]("bench_axis") is not None


@pytest.mark.parametrize("name", [*ASKED, "tune", "explain", "watch", "iso230"])
def test_a_name_that_is_none_is_one_line(name: str, tmp_path: Path) -> None:
    """In place of a message about an attribute that a string has not."""
    asked = ASKED | {
        "tune": lambda axis: fd.tune(axis),  # type: ignore[arg-type]
        "explain": lambda axis: fd.explain(axis, tmp_path / "numbers.toml"),  # type: ignore[arg-type]
        "watch": lambda axis: fd.watch(tmp_path, axis),  # type: ignore[arg-type]
        "iso230": lambda axis: fd.iso230(tmp_path / "laser.csv", plant=axis),  # type: ignore[arg-type]
    }
    with pytest.raises(fd.InputError, match="neither a file nor the name of a shipped plant"):
        asked[name]("no_axis")


@pytest.mark.parametrize(
    "wish",
    [
        {"channels": {"motor_torque": "foo"}}, {"lead": "10 mm"}, {"rate": "1 kHz"}, {"part": 1}, {"axis": "X1"},
        {"sample_time": "1 ms"}, {"columns": ("time",)},
    ],
)  # fmt: skip
def test_a_wish_is_not_passed_over(wish: dict[str, Any], tmp_path: Path) -> None:
    """Headings of the package's own say which is which: a file that is wished otherwise is refused."""
    rows = "".join(f"{k / 1000},{k},{k}\n" for k in range(50))
    (tmp_path / "own.csv").write_text("time [s],motor_torque [N m],motor_angle [rad]\n" + rows, encoding="utf-8")
    with pytest.raises(fd.InputError, match="canonical headings"):
        fd.inspect(tmp_path / "own.csv", **wish)


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        (lambda: fd.cascade("bench_axis", velocity_gain="1 N m s/rad", feedback="x"), "feedback"),
        (lambda: fd.move("bench_axis", torque=0.0, duration="1e9 s"), "write a shorter one"),
        (lambda: fd.move("bench_axis", torque=0.0, duration="1 s", rate="-1 kHz"), "above zero"),
        (lambda: fd.move("bench_axis", torque=0.0, duration="1 s", rate="0 Hz"), "above zero"),
        (lambda: fd.warm_up("thermal_bench", speed="750 rev/min", duration="10 min", order=0), "above zero"),
        (
            lambda: fd.warm_up("thermal_bench", speed="750 rev/min", duration="10 min", segments=0),
            "above zero",
        ),
        (lambda: fd.state_feedback("bench_axis", np.full((1, 8), np.nan), np.zeros((9, 2))), "no finite number"),
        (lambda: fd.Recording.from_arrays(time=["a", "b"], motor_angle=[0.0, 1.0]), "no real numbers"),
        (lambda: fd.Recording.from_arrays(time=[0.0, 1.0], motor_angle=[0.0, 1.0j]), "no real numbers"),
    ],
)
def test_what_cannot_be_is_one_line(asked: Callable[[], object], said: str) -> None:
    with pytest.raises(fd.InputError, match=said):
        asked()
