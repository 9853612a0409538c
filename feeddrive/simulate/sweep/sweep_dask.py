"""Units of a sweep on a Dask cluster. Workers must see the scenario's files under the same path; this is checked.

What they give is written here, so that only the units in their hands are lost where this process is killed.
"""

from __future__ import annotations

import logging
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from typing import Any

from feeddrive import __version__
from feeddrive.errors import InputError
from feeddrive.files import write_text_atomically
from feeddrive.simulate.sweep.sweep_unit import Measure, run_unit
from feeddrive.simulate.sweep.sweep_workers import Unit, Work, Workers

_EXAMPLE = "give the address of a scheduler, e.g. tcp://127.0.0.1:8786"
_PATIENCE = 10.0
"""Seconds until a scheduler that does not answer is given up."""


def on_cluster(address: str) -> Workers:
    """The workers of a Dask cluster.

    Args:
        address: of its scheduler, such as tcp://192.168.0.5:8786.
    """

    @contextmanager
    def opened(_: Measure) -> Iterator[Work]:
        client = client_of(address)
        try:
            refuse_unfit(client, address)
            yield lambda units: _as_finished(client, units, address)
        finally:
            client.close()

    return opened


def client_of(address: str) -> Any:
    """A client of a Dask scheduler.

    Raises:
        InputError: not an address, Dask is not installed, or nothing answers.
    """
    where = f"--scheduler {address}"
    if not re.fullmatch(r"(\w+://)?\S+:\d+", address):
        raise InputError("is not an address", where, _EXAMPLE)
    try:
        distributed: Any = import_module("distributed")
    except ImportError:
        mend = "pip install 'feeddrive[dask]', or leave out --scheduler"
        raise InputError("Dask is not installed", where, mend) from None
    logging.getLogger("distributed").setLevel(logging.CRITICAL + 1)  # what goes wrong is reported in one line instead
    try:
        return distributed.Client(address, timeout=_PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        what = f"no Dask scheduler answers ({' '.join(str(error).split()) or type(error).__name__})"
        raise InputError(what, where, _EXAMPLE) from None


def _version_here() -> str:
    return __version__


def refuse_unfit(client: Any, address: str) -> None:
    """Refuse a cluster without workers, or whose workers have no or another feeddrive."""
    where = f"--scheduler {address}"
    try:
        versions = client.run(_version_here)
    except Exception as error:
        what = f"its workers cannot run feeddrive ({type(error).__name__}: {error})"
        raise InputError(what, where, "install the same version of feeddrive for them") from None
    if not versions:
        raise InputError("the scheduler has no workers", where, f"start one: dask worker {address}")
    for worker, version in versions.items():
        if version != __version__:
            what = f"worker {worker} has feeddrive {version}, here is {__version__}"
            raise InputError(what, where, "install the same version for both")


def _as_finished(client: Any, units: Sequence[Unit], address: str) -> Iterator[int]:
    distributed: Any = import_module("distributed")
    pending = {client.submit(run_unit, unit.task, pure=False): unit for unit in units}
    for future in distributed.as_completed(list(pending), loop=client.loop):
        unit = pending.pop(future)
        try:
            text = future.result()
        except InputError:
            raise
        except Exception as error:
            what = f"a unit came to no end ({type(error).__name__}: {' '.join(str(error).split())})"
            mend = "start again with the same --out; what is finished is kept"
            raise InputError(what, f"--scheduler {address}", mend) from None
        write_text_atomically(unit.path, text)
        yield len(unit.task.overrides)
