"""A sweep by one process, by two, and on a Dask cluster of two workers: times, ratios, and whether the tables agree.

    python benchmarks/sweep.py [--runs 1000] [--rounds 1] [--scenario s_curve_positioning]

Random values of mass, friction and gains (Monte Carlo). Each time is that of the whole sweep, start of the workers,
compiler (the first round only) and tables included; not the start of Python and of a cluster. Kinds are interleaved,
medians are told. Run with OPENBLAS_NUM_THREADS=1 on an otherwise idle computer: the ratios need its processors.
"""

from __future__ import annotations

import argparse
import hashlib
import statistics
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path

from feeddrive.files import find_scenario_file
from feeddrive.metrology.run_metrics import run_metrics
from feeddrive.simulate.sweep.sweep import run_sweep
from feeddrive.simulate.sweep.sweep_dask import on_cluster
from feeddrive.simulate.sweep.sweep_design import Design, make_design
from feeddrive.simulate.sweep.sweep_table import as_csv
from feeddrive.simulate.sweep.sweep_values import read_parameters
from feeddrive.simulate.sweep.sweep_workers import Workers, in_this_process, processes, usable_processors

VARIED = [
    "plant.table.mass=100~170 kg",
    "plant.effect.guide_friction.coulomb=40~90 N",
    "controller.position_gain=40~80 1/s",
    "controller.velocity_gain=1.5~2.5 N m s/rad",
]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--scenario", default="s_curve_positioning")
    asked = parser.parse_args()
    path = find_scenario_file(f"{asked.scenario}.toml")
    design = make_design(path, {}, read_parameters(VARIED), samples=asked.runs, seed=1)
    with ExitStack() as open_things:
        kinds: dict[str, Workers] = {"one process": in_this_process, "2 processes": processes(2)}
        cluster = _cluster(open_things)
        if cluster:
            kinds["Dask, 2 workers"] = on_cluster(cluster)
        times: dict[str, list[float]] = {kind: [] for kind in kinds}
        tables = {kind: "" for kind in kinds}
        for _ in range(asked.rounds):
            for kind, workers in kinds.items():
                took, tables[kind] = _once(design, workers)
                times[kind].append(took)
    print(f"{asked.runs} runs of {asked.scenario}, {usable_processors()} processors, {asked.rounds} rounds")
    serial = statistics.median(times["one process"])
    for kind, took in times.items():
        median = statistics.median(took)
        same = "same table" if tables[kind] == tables["one process"] else "OTHER TABLE"
        print(f"{kind:16s} {median:7.2f} s  {asked.runs / median:6.1f} runs/s  {serial / median:5.2f} x  {same}")


def _once(design: Design, workers: Workers) -> tuple[float, str]:
    """Seconds, and the checksum of the table."""
    with tempfile.TemporaryDirectory() as folder:
        begun = time.perf_counter()
        sweep = run_sweep(design, run_metrics, Path(folder), workers)
        took = time.perf_counter() - begun
    return took, hashlib.sha256(as_csv(sweep.table).encode()).hexdigest()


def _cluster(open_things: ExitStack) -> str:
    """Address of a local cluster; empty where Dask is not installed."""
    try:
        from distributed import LocalCluster
    except ImportError:
        print("Dask is not installed (pip install 'feeddrive[dask]'): left out")
        return ""
    settings = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None, "silence_logs": 60}
    cluster = open_things.enter_context(LocalCluster(**settings))
    return str(cluster.scheduler_address)


if __name__ == "__main__":
    main()
