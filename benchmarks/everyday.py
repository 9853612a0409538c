"""Processor time of what a person waits for: a large file read, a report written, the papers compared, heat reduced.

    python benchmarks/everyday.py

Medians of three; bounds are those of docs/claims.toml.
"""

from __future__ import annotations

import gzip
import math
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from _timing import median, once

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from feeddrive.files import find_plant  # noqa: E402
from feeddrive.plant.file.plant_file import read_plant  # noqa: E402
from feeddrive.recording import read_recording  # noqa: E402
from feeddrive.report.figures.figures import render_figures  # noqa: E402
from feeddrive.report.pages.html import write_report  # noqa: E402
from feeddrive.reproduce.paper_002 import rows  # noqa: E402
from feeddrive.thermal.full.full_model import discretise, full_model, model_of  # noqa: E402
from feeddrive.thermal.full.grid import Cells  # noqa: E402
from feeddrive.thermal.full.moving import moving_system  # noqa: E402
from feeddrive.thermal.reduced.reduction import compressed_basis, reduce_model  # noqa: E402
from feeddrive.thermal.run.warm_up import simulate  # noqa: E402
from tests.analytic import report_examples  # noqa: E402
from tests.claims.book import CLAIMS, keep  # noqa: E402
from tests.heat_oracle.explicit import run_explicitly  # noqa: E402
from tests.heat_oracle.reduction_error import reduced_system  # noqa: E402

ROUNDS = 3
RPM = math.pi / 30
BENCH = read_plant(find_plant("thermal_bench")).heat


def main() -> None:
    """Measure, print, keep."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "big.csv.gz"
        path.write_bytes(_large_file())
        large = report_examples.diagnosis(samples=60_000, recordings=4)
        full = full_model(BENCH.rig)
        small = reduce_model([full], BENCH.limits())[0]
        speeds = np.repeat([500.0, 0.0, 750.0, 250.0, 0.0], [180, 120, 180, 60, 180]) * RPM
        calls: dict[str, Callable[[], object]] = {
            "daily.read": lambda: read_recording(path),
            "daily.report": lambda: write_report(large, Path(folder) / "report.html", render_figures(large)),
            "daily.papers": rows,
            "heat.built": lambda: reduce_model([full], BENCH.limits()),
            "heat.run": lambda: simulate(BENCH, small, 30.0, speeds, np.full(720, 23.0)),
        }
        for key, call in calls.items():
            call()
            _tell(key, median([once(call) for _ in range(ROUNDS)]))
    _tell("heat.faster", _against_explicit())


def _large_file() -> bytes:
    """79 000 rows of four channels."""
    values = np.random.default_rng(2).normal(size=(79_000, 4))
    header = "time [s],setpoint [m],motor_torque [N m],motor_angle [rad],table_position [m]"
    lines = (f"{0.0005 * i:.4f},{a:.7f},{b:.4f},{c:.7f},{d:.8f}" for i, (a, b, c, d) in enumerate(values.tolist()))
    return gzip.compress("\n".join((header, *lines)).encode(), compresslevel=1)


def _against_explicit() -> float:
    """How many times faster ten states are than the compiled explicit scheme with the nut moving, 180 min."""
    travel, speed = BENCH.rig.travel, 400 * RPM
    parts, g, feed = discretise(BENCH.rig, Cells(200, 4, 40, 6)), BENCH.at_speed(speed), BENCH.feed(speed)
    heat = float(BENCH.heats(np.array([speed]))["nut"][0])
    moving = moving_system(parts, g, feed, compressed_basis(model_of(parts, travel).at(g)), travel)
    ten = reduced_system(moving, 10)
    slow = once(lambda: run_explicitly(parts, g, {"nut": heat}, feed, 180 * 60.0, travel=travel))
    fast = median([once(lambda: ten.step_response("nut", heat, 180, 60.0)) for _ in range(9)])
    return slow / fast


def _tell(key: str, found: float) -> None:
    claim = CLAIMS[key]
    keep(key, found)
    print(f"{claim.says:90s} {found:8.3g} {claim.unit:3s} {claim.bound():16s} {'yes' if claim.inside(found) else 'NO'}")


if __name__ == "__main__":
    main()
