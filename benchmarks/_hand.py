"""The drive written by hand in C, compiled with everything that the compiler can do, called through ctypes."""

from __future__ import annotations

import ctypes
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from _drive import BUMP, CHAIN, DIVIDER, FRICTION, GAINS, LAG, SAMPLE
from scipy.linalg import expm

from feeddrive.typing import FloatArray

HERE = Path(__file__).resolve().parent
FLAGS = ("-O3", "-march=native", "-ffp-contract=off", "-fPIC", "-shared")


def compiled(name: str, *options: str) -> ctypes.CDLL:
    """A C file beside this one as a library."""
    folder = Path(tempfile.mkdtemp())
    subprocess.run(["cc", *FLAGS, *options, "-o", str(folder / "it.so"), str(HERE / name), "-lm"], check=True)
    return ctypes.CDLL(str(folder / "it.so"))


def mechanics() -> tuple[FloatArray, FloatArray, FloatArray]:
    """A (10, 10), and how torque and table force accelerate, (10,)."""
    p = CHAIN.values
    mass, damping, stiffness = (np.array(m(p), dtype=float) for m in (CHAIN.mass, CHAIN.damping, CHAIN.stiffness))
    inverse = np.linalg.inv(mass)
    a = np.block([[np.zeros((5, 5)), np.eye(5)], [-inverse @ stiffness, -inverse @ damping]])
    return a, np.concatenate([np.zeros(5), inverse[:, 0]]), np.concatenate([np.zeros(5), inverse[:, 4]])


def gains() -> bytes:
    """The struct of the controller."""
    return np.array([*GAINS.values(), CHAIN.radius]).tobytes() + np.array([DIVIDER]).tobytes()


@dataclass(frozen=True)
class Exact:
    """`drive_exact.c` with its constants, made here from matrix exponentials."""

    binary: ctypes.CDLL
    machine: bytes

    @staticmethod
    def made(bump: bool = False) -> Exact:
        a, by_torque, by_force = mechanics()
        whole = np.zeros((14, 14))  # states, torque, then command and the two monomials of the force
        whole[:10, :10], whole[:10, 10], whole[10, 10], whole[10, 11] = a, by_torque, -1 / LAG, 1 / LAG
        whole[:10, 12] = by_force
        whole *= SAMPLE
        whole[12, 13] = 1.0  # the second monomial drives the first
        maps = []
        for node in (1 / 3, 1.0):
            e = expm(node * whole)
            one, tau = e[:11, 12], e[:11, 13]
            maps += [e[:11, :11].ravel(), e[:11, 11], 1.5 * one - 1.5 * tau, -0.5 * one + 1.5 * tau]
        f = FRICTION
        weights = [1e-9 * 10 * CHAIN.values["table_mass"], 0.0, 0.0]
        friction = [f[k] for k in ("stiffness", "damping", "coulomb", "extra", "stribeck", "viscous")]
        parts = [*maps, [SAMPLE], friction, weights, [BUMP[key] for key in ("peak", "centre", "half_width")]]
        library = compiled("drive_exact.c", *(["-DBUMP"] if bump else []))
        return Exact(library, np.concatenate(parts).tobytes())

    def run(self, wanted: FloatArray) -> FloatArray:
        """Command, coordinates, rates and torque at the samples, shape (n, 12)."""
        table = np.empty((len(wanted), 12))
        self.binary.exact_run(
            ctypes.c_longlong(len(wanted)), self.machine, gains(), ctypes.c_void_p(wanted.ctypes.data),
            ctypes.c_void_p(table.ctypes.data),
        )  # fmt: skip
        return table


@dataclass(frozen=True)
class RungeKutta:
    """`drive_runge_kutta.c` with its constants."""

    binary: ctypes.CDLL
    machine: bytes

    @staticmethod
    def made() -> RungeKutta:
        a, by_torque, by_force = mechanics()
        f = FRICTION
        friction = [f[k] for k in ("stiffness", "damping", "coulomb", "extra", "stribeck", "viscous")]
        parts = [a[5:].ravel(), by_torque[5:], by_force[5:], [LAG], friction]
        return RungeKutta(compiled("drive_runge_kutta.c"), np.concatenate(parts).tobytes())

    def run(self, wanted: FloatArray, substeps: int) -> FloatArray:
        table = np.empty(len(wanted))
        self.binary.runge_kutta_run(
            ctypes.c_longlong(len(wanted)), ctypes.c_longlong(substeps), ctypes.c_double(SAMPLE), self.machine, gains(),
            ctypes.c_void_p(wanted.ctypes.data), ctypes.c_void_p(table.ctypes.data),
        )  # fmt: skip
        return table

    def slopes(self, states: FloatArray, command: float) -> FloatArray:
        """Rates of change of states, shape (12,) or in columns (12, k)."""
        states = np.ascontiguousarray(states)
        out = np.empty_like(states)
        self.binary.drive_slopes_columns(
            self.machine, ctypes.c_longlong(states.size // 12), ctypes.c_void_p(states.ctypes.data),
            ctypes.c_double(command), ctypes.c_void_p(out.ctypes.data),
        )  # fmt: skip
        return out
