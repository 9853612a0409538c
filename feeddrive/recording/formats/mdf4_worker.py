"""Reads an MDF file in a process of its own: bytes come in, arrays go out.

The library's compiled parts follow the addresses in a file; a damaged one makes them crash, which ends this process
and not the person's. Run by `mdf4`.
"""

from __future__ import annotations

import importlib
import io
import json
import logging
import sys
import warnings

import numpy as np

FINISHED, DAMAGED, ABSENT = 0, 3, 4
"""Exit statuses; any other is a crash."""


def main() -> int:
    """Read standard input, write an .npz archive to standard output."""
    try:
        asammdf = importlib.import_module("asammdf")
    except ImportError:
        return ABSENT
    logging.getLogger("asammdf").setLevel(logging.CRITICAL)
    warnings.simplefilter("ignore")
    sys.unraisablehook = lambda _: None  # the library's object of a damaged file complains when it is thrown away
    names: list[list[str]] = []
    arrays: dict[str, np.ndarray] = {}
    try:
        with asammdf.MDF(io.BytesIO(sys.stdin.buffer.read())) as file:
            for one in file.iter_channels(skip_master=True):
                if np.ndim(one.samples) == 1 and np.size(one.samples) > 1 and one.samples.dtype.kind in "fiub":
                    arrays[f"t{len(names)}"] = np.asarray(one.timestamps, dtype=np.float64)
                    arrays[f"v{len(names)}"] = np.asarray(one.samples, dtype=np.float64)
                    names.append([str(one.name), str(one.unit or ""), str(one.comment or "")])
    except Exception:  # the library meets damage with errors of every kind
        return DAMAGED
    packed = np.frombuffer(json.dumps(names).encode(), dtype=np.uint8)
    buffer = io.BytesIO()
    np.savez(buffer, names=packed, **arrays)  # type: ignore[arg-type]
    sys.stdout.buffer.write(buffer.getvalue())
    return FINISHED


if __name__ == "__main__":
    sys.exit(main())
