"""Runs cases of a fuzz module in a watched process, and says which of them broke the promise of the command line.

A fuzz module is a file of this folder with one function

    attempt(generator: random.Random, folder: Path) -> Attempt

which writes its input into the folder and returns what is to be run. The same module, seed and number give the same
input. The promise: status 0 or 2, within a time and a memory; with 2 exactly one line on standard error, short and
printable, that begins with "error: "; no traceback, and no warning but those of the project itself.
"""

from __future__ import annotations

import importlib
import multiprocessing
import os
import pkgutil
import random
import resource
import shutil
import sys
import tempfile
import time
import unicodedata
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from feeddrive.errors import InputError, ValidityWarning

LONGEST = 10.0
"""Time of the processor that a case may take [s]; reading takes milliseconds, so more is a hang. A module may set its
own `LONGEST`. One that waits, as for a pipe, has `WAITING` times as long: the processor may be busy with other work."""

WAITING = 6.0

MAKING = 120.0
"""Time that making an input may take [s]."""

MOST_MEMORY = 800_000_000
"""Growth of the worker's peak memory that a case may cause [bytes]; inputs are below 10 MB. A module may set its
own `MOST_MEMORY`."""

ADDRESS_SPACE = 8_000_000_000
"""Beyond it a worker gets no memory [bytes], so that a case that asks for all there is harms nobody else."""

LONGEST_LINE = 1300
"""Letters of an error line at most: three parts of 400 and the words between them."""


@dataclass(frozen=True)
class Attempt:
    """One case.

    Attributes:
        what: how the input was made, for the report.
        run: runs it; returns the exit status where it is a whole command, anything else where it is a function.
    """

    what: str
    run: Callable[[], object]


@dataclass(frozen=True)
class Outcome:
    """What became of a case.

    Attributes:
        number: of the case.
        what: how the input was made.
        status: exit status; None where there was none.
        line: what was said on standard error.
        seconds: that it took.
        fault: what breaks the promise; empty if nothing does.
    """

    number: int
    what: str
    status: int | None
    line: str
    seconds: float
    fault: str = ""


def modules() -> tuple[str, ...]:
    """Names of the fuzz modules in this folder."""
    names = [entry.name for entry in pkgutil.iter_modules([str(Path(__file__).parent)])]
    return tuple(name for name in names if hasattr(_module(name), "attempt"))


def generator_of(name: str, seed: int, number: int) -> random.Random:
    """Return the random numbers that a case is made from."""
    return random.Random(f"{name}:{seed}:{number}")


def share_of(name: str) -> float:
    """Return the share of the cases asked for that a module runs: 1, or what it sets as `SHARE` where it is slow."""
    return float(getattr(_module(name), "SHARE", 1.0))


def run_cases(name: str, seed: int, numbers: Iterable[int]) -> Iterator[Outcome]:
    """Run cases of a module, one after the other; a worker that hangs or dies is replaced.

    Args:
        name: of the module in this folder, or its full dotted name.
        seed: of all cases.
        numbers: of the cases that are run.
    """
    worker: _Worker | None = None
    try:
        for number in numbers:
            worker = worker if worker is not None and worker.alive() else _Worker(name, seed)
            yield worker.run(number)
    finally:
        if worker is not None:
            worker.end()


class _Worker:
    """A process that runs cases when asked."""

    def __init__(self, name: str, seed: int) -> None:
        context = multiprocessing.get_context("spawn")
        self.connection, other = context.Pipe()
        self.process = context.Process(target=_work, args=(other, name, seed), daemon=True)
        self.process.start()
        other.close()
        self.connection.recv()  # imported and ready: the clock of the first case starts afterwards
        self.longest = float(getattr(_module(name), "LONGEST", LONGEST))

    def alive(self) -> bool:
        return self.process.is_alive()

    def run(self, number: int) -> Outcome:
        self.connection.send(number)
        started = time.monotonic()
        what, fault = "the input was being made", f"not made within {MAKING:g} s"
        try:
            if self.connection.poll(MAKING):
                what, started = self.connection.recv(), time.monotonic()
                used = self._processor_time()
                while time.monotonic() - started < WAITING * self.longest:
                    if self.connection.poll(0.5):
                        outcome: Outcome = self.connection.recv()
                        return outcome
                    if self._processor_time() - used > self.longest:
                        break
                fault = f"no answer within {self.longest:g} s"
        except EOFError:
            self.process.join()
            fault = f"the process died with {self.process.exitcode}"
        self.end()
        return Outcome(number, what, None, "", time.monotonic() - started, fault)

    def _processor_time(self) -> float:
        """Return the time of the processor that the worker has used [s]; that of the clock where nobody tells."""
        try:
            fields = Path(f"/proc/{self.process.pid}/stat").read_text().rsplit(")", 1)[1].split()
        except OSError:
            return time.monotonic()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def end(self) -> None:
        self.process.kill()
        self.process.join()
        self.connection.close()


def _work(connection: Connection, name: str, seed: int) -> None:
    """Run cases until the pipe is closed; the body of the worker."""
    os.environ["NO_COLOR"] = "1"
    resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE, ADDRESS_SPACE))
    attempt, most = _module(name).attempt, int(getattr(_module(name), "MOST_MEMORY", MOST_MEMORY))
    connection.send("ready")
    while True:
        try:
            number = connection.recv()
        except EOFError:
            return
        folder = Path(tempfile.mkdtemp(prefix="fuzz"))
        try:
            made = attempt(generator_of(name, seed, number), folder)
            connection.send(made.what)
            connection.send(_outcome(number, made, folder, most))
        finally:
            shutil.rmtree(folder, ignore_errors=True)


def _outcome(number: int, made: Attempt, folder: Path, most: int) -> Outcome:
    """Run a case with its streams caught, down to what a library in C writes."""
    before, started = _peak(), time.monotonic()
    with tempfile.TemporaryFile() as said:
        with _streams_into(said.fileno()), warnings.catch_warnings():
            warnings.simplefilter("always")
            warnings.simplefilter("ignore", ValidityWarning)
            status = _status(made)
        said.seek(0)
        text = said.read().decode("utf-8", "replace").replace(str(folder), "FOLDER")
    seconds, grown = time.monotonic() - started, _peak() - before
    return Outcome(number, made.what, status, text, seconds, _fault(status, text, grown, most))


@contextmanager
def _streams_into(error_stream: int) -> Iterator[None]:
    """Lead standard error into an open file, and standard output nowhere."""
    _flush()
    kept, nowhere = (os.dup(1), os.dup(2)), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(error_stream, 2)
    try:
        yield
    finally:
        _flush()
        os.dup2(kept[0], 1)
        os.dup2(kept[1], 2)
        for one in (*kept, nowhere):
            os.close(one)


def _flush() -> None:
    sys.stdout.flush()
    sys.stderr.flush()


def _status(made: Attempt) -> int:
    """Return the exit status; a function's errors are judged as the command line judges them."""
    try:
        returned = made.run()
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except BaseException as error:
        print(f"{type(error).__name__}: {str(error)[:2000]}", file=sys.stderr)
        return 1
    return returned if isinstance(returned, int) else 0


def _fault(status: int, text: str, grown: int, most: int) -> str:
    lines = text.splitlines()
    if status not in (0, 2):
        return f"status {status}: {lines[-1] if lines else ''}"
    if grown > most:
        return f"memory grew by {grown / 1e6:.0f} MB"
    if status == 0:
        return f"said on standard error: {lines[0]}" if lines else ""
    if len(lines) != 1 or not lines[0].startswith("error: "):
        return f"{len(lines)} lines on standard error"
    if len(lines[0]) > LONGEST_LINE:
        return f"a line of {len(lines[0])} letters"
    hidden = {letter for letter in lines[0] if unicodedata.category(letter) in ("Cc", "Cf", "Cs", "Zl", "Zp")}
    return f"letters that a terminal obeys or hides: {sorted(map(hex, map(ord, hidden)))}" if hidden else ""


def _peak() -> int:
    """Return the peak memory of this process [bytes].

    Linux hands the peak of the process that started this one down to `ru_maxrss`, so the kernel's own line goes first.
    """
    with suppress(OSError, StopIteration):
        lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
        return int(next(line for line in lines if line.startswith("VmHWM:")).split()[1]) * 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def _module(name: str) -> Any:
    return importlib.import_module(name if "." in name else f"tests.fuzz.{name}")
