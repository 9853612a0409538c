"""Runs a step function over many samples: generated C where a compiler is found, CasADi's virtual machine elsewhere.

One binary per structure: lengths, values and inputs are arguments. The cache is written atomically, so that processes
that start together do not meet half a file; where the home is read-only a temporary folder serves.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path

import casadi as ca
import numpy as np

from feeddrive.typing import FloatArray

Loop = Callable[[FloatArray, FloatArray, FloatArray], tuple[FloatArray, FloatArray]]
"""(memory (m,), inputs (n, k), constants (c,)) -> memory after every step (n, m), what else it returns (n, e)."""

FLAGS = ("-O1", "-ffp-contract=off", "-fPIC", "-shared")
"""No fused or reordered arithmetic: the compiled numbers are those of the virtual machine."""

CHUNK = 512
"""Steps per call of the virtual machine."""

DRIVER = """
void feeddrive_loop(long long n, long long inputs, long long memory, long long extras, double *state,
                    const double *input,
                    const double *constants, double *states, double *extra, long long *iw, double *w,
                    const double **arg, double **res) {
  for (long long i = 0; i < n; ++i) {
    double *out = states + i * memory;
    arg[0] = state; arg[1] = input + i * inputs; arg[2] = constants;
    res[0] = out; res[1] = extra + i * extras;
    feeddrive_step(arg, res, iw, w, 0);
    state = out;
  }
}
"""


def loop_of(step: ca.Function) -> Loop:
    """The fastest loop over `step` that this machine offers.

    Args:
        step: function (memory, inputs, constants) -> (memory after, extra outputs), named "feeddrive_step".

    Returns:
        The loop.
    """
    compiler = find_compiler()
    if compiler is not None:
        library = _compiled(step, compiler)
        if library is not None:
            return _compiled_loop(step, library)
    return interpreted_loop(step)


@lru_cache(maxsize=1)
def find_compiler() -> str | None:
    """The C compiler: $CC, cc, gcc or clang; None if there is none or FEEDDRIVE_COMPILER is "none"."""
    if os.environ.get("FEEDDRIVE_COMPILER") == "none":
        return None
    for name in (os.environ.get("CC"), "cc", "gcc", "clang"):
        if name and (found := shutil.which(name)):
            return found
    return None


def interpreted_loop(step: ca.Function) -> Loop:
    """The loop in CasADi's virtual machine."""
    extras = step.size1_out(1)
    chunk = step.mapaccum("chunk", CHUNK)
    start = ca.MX.sym("memory", step.size1_in(0))
    fed = ca.MX.sym("inputs", step.size1_in(1), CHUNK)
    fixed = ca.MX.sym("constants", step.size1_in(2))
    wrapped = ca.Function("loop", [start, fed, fixed], list(chunk(start, fed, ca.repmat(fixed, 1, CHUNK))))

    def run(memory: FloatArray, inputs: FloatArray, constants: FloatArray) -> tuple[FloatArray, FloatArray]:
        n = len(inputs)
        states, extra = np.empty((n, len(memory))), np.empty((n, extras))
        state = memory
        for at in range(0, n, CHUNK):
            part = inputs[at : at + CHUNK]
            short = len(part)
            padded = part if short == CHUNK else np.vstack([part, np.repeat(part[-1:], CHUNK - short, axis=0)])
            after, more = wrapped(state, padded.T, constants)
            states[at : at + short] = np.array(after).T[:short]
            extra[at : at + short] = np.array(more).T[:short]
            state = states[at + short - 1]
        return states, extra

    return run


def _compiled(step: ca.Function, compiler: str) -> ctypes.CDLL | None:
    """The shared library of the step and its loop, from the cache or made now; None if the compiler fails."""
    generator = ca.CodeGenerator("step.c", {"with_header": False})
    generator.add(step)
    source = generator.dump() + DRIVER
    key = hashlib.sha256((source + compiler + " ".join(FLAGS)).encode()).hexdigest()[:24]
    for folder in _cache_folders():
        library = folder / f"{key}.so"
        try:
            if not library.exists():
                _compile(source, compiler, library)
            return ctypes.CDLL(str(library))
        except (OSError, subprocess.CalledProcessError):
            continue
    return None


def _cache_folders() -> list[Path]:
    base = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return [Path(base) / "feeddrive", Path(tempfile.gettempdir()) / f"feeddrive-{os.getuid()}"]


def _compile(source: str, compiler: str, library: Path) -> None:
    library.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    with tempfile.TemporaryDirectory(dir=library.parent) as folder:
        text, made = Path(folder) / "step.c", Path(folder) / "step.so"
        text.write_text(source)
        subprocess.run([compiler, *FLAGS, "-o", str(made), str(text), "-lm"], check=True, capture_output=True)
        made.replace(library)


def _compiled_loop(step: ca.Function, library: ctypes.CDLL) -> Loop:
    function = library.feeddrive_loop
    integer, pointer = ctypes.c_longlong, ctypes.c_void_p
    function.argtypes = [integer] * 4 + [pointer] * 9
    function.restype = None

    def run(memory: FloatArray, inputs: FloatArray, constants: FloatArray) -> tuple[FloatArray, FloatArray]:
        start, fed, fixed = (np.ascontiguousarray(array, dtype=float) for array in (memory, inputs, constants))
        n = len(fed)
        states, extra = np.empty((n, len(start))), np.empty((n, step.size1_out(1)))
        integers = np.empty(step.sz_iw() + 1, dtype=np.int64)
        reals = np.empty(step.sz_w() + 1)
        arguments, results = (ctypes.c_void_p * (step.sz_arg() + 1))(), (ctypes.c_void_p * (step.sz_res() + 1))()
        function(
            n, fed.shape[1], len(start), extra.shape[1], start.ctypes.data, fed.ctypes.data, fixed.ctypes.data,
            states.ctypes.data, extra.ctypes.data, integers.ctypes.data, reals.ctypes.data,
            ctypes.addressof(arguments), ctypes.addressof(results),
        )  # fmt: skip
        return states, extra

    return run
