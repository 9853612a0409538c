"""Cases diagnosed one after the other, one line of JSON each: killed at any moment, they go on where they were."""

from __future__ import annotations

import json
import multiprocessing
import signal
import tempfile
import time
import traceback
import warnings
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from types import FrameType
from typing import Any

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.diagnosis.plant_text import with_calibrated_values
from feeddrive.errors import InputError
from feeddrive.plant.file.lumped_text import plant_text_with_effects
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from tests.recovery.fleet.case import Case, case
from tests.recovery.fleet.floor import floors
from tests.recovery.fleet.state import fleet_state

Record = dict[str, Any]
Said = Callable[[str], None]

RESULTS = "results.jsonl"


class TimeLimitError(BaseException):
    """A diagnosis that takes longer than it may; no Exception, so that nothing on the way catches it."""


def cases_done(folder: Path, state: str | None = None) -> dict[int, Record]:
    """Return the records of a folder by seed, those of one state of the code where it is given."""
    path = folder / RESULTS
    if not path.exists():
        return {}
    records = []
    for line in path.read_text(encoding="utf-8").splitlines():
        try:
            records.append(json.loads(line))
        except json.JSONDecodeError:
            continue  # the line that was being written when it was killed
    return {one["seed"]: one for one in records if state is None or one["state"] == state}


def run_missing(
    seeds: Sequence[int], folder: Path, workers: int, limit: float, minutes: float, said: Said, most_rows: int = 0
) -> None:  # fmt: skip
    """Run the seeds without a record of this state.

    Args:
        seeds: of the cases.
        folder: of the results, made if missing.
        workers: processes; with one everything happens in this one.
        limit: processor seconds of one diagnosis.
        minutes: no case begins later; 0 for no end.
        said: told a line a case.
        most_rows: cases with longer recordings are left out; 0 for none. For a quick look.
    """
    folder.mkdir(parents=True, exist_ok=True)
    state, begun = fleet_state(), time.monotonic()
    done = cases_done(folder, state)
    missing = [seed for seed in seeds if seed not in done]
    said(f"state {state}: {len(seeds) - len(missing)} of {len(seeds)} cases are there, {len(missing)} to be run")

    def late() -> bool:
        return minutes > 0 and time.monotonic() - begun > 60 * minutes

    def keep(record: Record) -> None:
        with (folder / RESULTS).open("a", encoding="utf-8") as file:
            file.write(json.dumps(record | {"state": state}, ensure_ascii=False) + "\n")
        said(line(record))

    if workers == 1:
        for seed in missing:
            if late():
                break
            if (record := one(seed, limit, most_rows)) is not None:
                keep(record)
        return
    with ProcessPoolExecutor(workers, multiprocessing.get_context("spawn")) as pool:
        for result in until_late(lambda seed: pool.submit(one, seed, limit, most_rows), missing, workers, late):
            if result is not None:
                keep(result)


def until_late(
    begin: Callable[[int], Future[Record | None]], seeds: Sequence[int], workers: int, late: Callable[[], bool]
) -> Iterator[Record | None]:  # fmt: skip
    """Yield results as they come, one case begun for each worker that is free; what is in work when late is awaited."""
    waiting = iter(seeds)
    working = {begin(seed) for seed in islice(waiting, workers) if not late()}
    while working:
        finished, working = wait(working, return_when=FIRST_COMPLETED)
        for future in finished:
            yield future.result()
        working |= {begin(seed) for seed in islice(waiting, len(finished)) if not late()}


def one(seed: int, limit: float, most_rows: int = 0) -> Record | None:
    """Draw, diagnose and compare one case; None where it is longer than wanted."""
    begun = time.process_time()
    drawn = case(seed)
    if 0 < most_rows < len(drawn.fit["time"]):
        return None
    record: Record = {"seed": seed, "truth": drawn.truth, "drawing_s": round(time.process_time() - begun, 2)}
    with tempfile.TemporaryDirectory(prefix="fleet-") as name:
        return record | diagnosed(drawn, Path(name), limit)


def diagnosed(drawn: Case, folder: Path, limit: float) -> Record:
    """Diagnose a case from its files, as a user would; what is raised is kept as its result."""
    plant_file, fit, judge = drawn.write(folder)
    begun = time.process_time()
    try:
        with warnings.catch_warnings(), time_limit(limit):
            warnings.simplefilter("ignore")
            plant = read_plant(plant_file)
            result, effects = diagnose(plant, [read_recording(fit)], [read_recording(judge)])
            cpu = round(time.process_time() - begun, 2)
    except InputError as refusal:
        return {"outcome": "refused", "said": str(refusal), "cpu": round(time.process_time() - begun, 2)}
    except TimeLimitError:
        return {"outcome": "time limit", "cpu": round(time.process_time() - begun, 2)}
    except Exception:
        return {"outcome": "raised", "said": traceback.format_exc(), "cpu": round(time.process_time() - begun, 2)}
    found = found_of(result, [effect.place or str(effect.port) for effect in effects])
    found |= {"outcome": "done", "cpu": cpu, "floor": floors(drawn, result)}
    after = folder / "plant_after.toml"
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            text = with_calibrated_values(plant_file.read_text(encoding="utf-8"), result.calibrated)
            after.write_text(plant_text_with_effects(text, effects), encoding="utf-8")
            read_plant(after)
        found["plant_after"] = "readable"
    except Exception as fault:
        found["plant_after"] = f"{type(fault).__name__}: {fault}"
    return found


def found_of(result: Diagnosis, places: Sequence[str]) -> Record:
    """Return what the diagnosis says, as JSON holds it. Names count as asserted unless a result says otherwise."""
    return {
        "found": [
            {
                "name": effect.name,
                "place": place,
                "asserted": bool(getattr(effect, "asserted", True)),
                "odds": getattr(effect, "odds", None),
                "explains": effect.explains,
                "parameters": {
                    key: {"value": p.value, "ci95": p.ci95, "unit": p.unit} for key, p in effect.parameters.items()
                },
            }
            for effect, place in zip(result.effects, places, strict=False)
        ],
        "ambiguous": [list(names) for names in result.ambiguous],
        "tables": len(places) - len(result.effects),
        "before": {channel.name: channel.before.rms for channel in result.channels},
        "after": {channel.name: channel.after.rms for channel in result.channels},
        "band": {channel.name: channel.band_hz[1] for channel in result.channels},
        "noise": {channel.name: channel.noise_rms for channel in result.channels},
        "notes": list(result.notes),
    }


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Raise TimeLimitError once the process has computed for so long."""

    def stop(number: int, frame: FrameType | None) -> None:
        raise TimeLimitError

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def line(record: Record) -> str:
    """Return a case in a line: what was planted, what was found, errors over the floor."""
    truth = record["truth"]
    planted = ", ".join(
        f"{'~' if p['relative'] else ''}{p['name']}{':' + p['place'] if p['place'] else ''} x{p['size']:.1f}"
        for p in truth["planted"]
    )
    head = f"{record['seed']:6d} {truth['kind']:9s} {record['cpu']:6.1f} s  {planted or truth['spoiling'] or 'nothing'}"
    if truth["off"]:
        head += " (off" + (", may " + " ".join(truth["may"]) if truth["may"] else "") + ")"
    if record["outcome"] != "done":
        return f"{head} -> {record['outcome']}: {str(record.get('said', '')).strip().splitlines()[-1:]}"
    names = ", ".join(f"{f['name']}:{f['place']}" for f in record["found"]) or "nothing"
    sets = f" sets {record['ambiguous']}" if record["ambiguous"] else ""
    tables = f" +{record['tables']} tables" if record["tables"] else ""
    ratios = ", ".join(
        f"{name.split('_')[0]} {record['before'][name] / floor:.2f}->{record['after'][name] / floor:.2f}"
        for name, floor in record["floor"].items()
    )
    return f"{head} -> {names}{sets}{tables} | over floor {ratios}"
