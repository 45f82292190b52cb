"""The yardstick in plain C: a square net in free flight, built with a compiler at hand and driven by ctypes.

It shares no code with the model: start, masses and the thread's constants are worked out here from the same
parameters, by FMI name.
"""

from __future__ import annotations

import ctypes
import os
import shlex
import subprocess
import sys
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import numpy.typing as npt

SOURCE = Path(__file__).with_name("plain_net.c")
FLAGS = ("-std=c99", "-O3", "-march=native", "-ffp-contract=off", "-fno-math-errno", "-fPIC", "-shared")
DEFAULTS = {
    "net.side": 24.0,
    "net.mesh": 1.0,
    "net.mass": 0.33,
    "net.youngs_modulus": 70e9,
    "net.density": 1440.0,
    "net.damping_ratio": 0.106,
    "net.fold_side": 0.5,
    "bullets.mass": 0.5,
    "bullets.speed": 3.0,
    "bullets.angle": np.radians(40.0),
    "vertex.mass": 0.15,
}
"""Table 1's net and shot, SI."""
VECTOR = 8
"""Doubles in the longest vector there is, 64 bytes."""

Plane = npt.NDArray[np.float64]
Pointer = ctypes.POINTER(ctypes.c_double)


class Fields(ctypes.Structure):
    """`Net` of the C file."""

    _fields_ = (
        ("knots", ctypes.c_int),
        ("pitch", ctypes.c_int),
        ("length", ctypes.c_double),
        ("stiffness", ctypes.c_double),
        ("damping", ctypes.c_double),
        ("substep", ctypes.c_double),
        ("position", Pointer * 3),
        ("velocity", Pointer * 3),
        ("predicted", Pointer * 3),
        ("inverse", Pointer),
        ("peak", Pointer * 2),
        ("scratch", Pointer),
        ("kicked", ctypes.POINTER(ctypes.c_int)),
    )


@lru_cache
def compiled() -> tuple[ctypes.CDLL, str]:
    """The library, and what it was built with: the clang that links the FMUs, or what PLAIN_NET_CC names."""
    named = os.environ.get("PLAIN_NET_CC")
    # without zig's run-time library, of which nothing is called, and which would be built for this processor first
    command = shlex.split(named) if named else [sys.executable, "-m", "ziglang", "cc", "-nostdlib", "-lc"]
    told = subprocess.run([*command, "--version"], check=True, capture_output=True, text=True).stdout.splitlines()[0]
    with TemporaryDirectory() as folder:
        path = Path(folder) / "plain_net.so"
        subprocess.run([*command, *FLAGS, str(SOURCE), "-o", str(path), "-lm"], check=True)
        library = ctypes.CDLL(str(path))
    library.fly.argtypes = (ctypes.POINTER(Fields), ctypes.c_long)
    library.fly.restype = None
    return library, f"{told}, {' '.join(FLAGS)}"


class PlainNet:
    """A net that has been shot, in the frame of the shot: two transverse axes, then the axis itself; muzzle at 0.

    parameters   SI by FMI name, those of DEFAULTS
    substep      [s]

    `position`, `velocity` (half a substep back) and `predicted` (for the instant of the positions) are (3, K, K), rows
    along the second transverse axis; `mass` (K, K); `peak` (2, K, K) the largest tension of the thread from each knot
    along the row, and to the next row [N].
    """

    def __init__(self, parameters: Mapping[str, float], substep: float) -> None:
        p = {**DEFAULTS, **parameters}
        meshes = round(p["net.side"] / p["net.mesh"])
        self.knots, self.threads, self.substep = meshes + 1, 2 * meshes * (meshes + 1), substep
        total = self.threads * p["net.mesh"]
        stiffness = p["net.youngs_modulus"] * p["net.mass"] / (p["net.density"] * total) / p["net.mesh"]
        inner = 2.0 * p["net.mass"] / self.threads
        pitch = -(-self.knots // VECTOR) * VECTOR
        planes = _aligned(12, self.knots, pitch)
        self.position, self.velocity, self.predicted, (inverse,), self.peak = np.split(
            planes[:, :, : self.knots], (3, 6, 9, 10)
        )
        self.mass = _masses(self.knots, inner, p["bullets.mass"], p["vertex.mass"])
        inverse[...] = 1.0 / self.mass
        place = p["net.fold_side"] * (np.arange(self.knots) / meshes - 0.5)
        self.position[0], self.position[1] = place[None, :], place[:, None]
        outward = p["bullets.speed"] * np.sin(p["bullets.angle"]) * np.sqrt(0.5)
        for row, along_row in ((0, -outward), (-1, outward)):
            for column, along_column in ((0, -outward), (-1, outward)):
                forward = p["bullets.speed"] * np.cos(p["bullets.angle"])
                self.velocity[:, row, column] = along_column, along_row, forward
        self.predicted[...] = self.velocity  # nothing is taut yet: half a substep back they were the same
        self._scratch, self._kicked = _aligned(7, 1, pitch), (ctypes.c_int * self.knots)()
        pointers = [plane.ctypes.data_as(Pointer) for plane in planes]
        self._fields = Fields(
            self.knots,
            pitch,
            p["net.mesh"],
            stiffness,
            2.0 * p["net.damping_ratio"] * np.sqrt(stiffness * inner),
            substep,
            (Pointer * 3)(*pointers[:3]),
            (Pointer * 3)(*pointers[3:6]),
            (Pointer * 3)(*pointers[6:9]),
            pointers[9],
            (Pointer * 2)(*pointers[10:]),
            self._scratch.ctypes.data_as(Pointer),
            self._kicked,
        )
        self._fly = compiled()[0].fly

    def fly(self, steps: int) -> None:
        """So many substeps on."""
        self._fly(self._fields, steps)

    def step(self, size: float) -> None:
        """Advance by a time [s], a whole number of substeps."""
        self.fly(round(size / self.substep))

    def mouth_area(self) -> float:
        """Area spanned by the bullets, projected on the plane normal to the shot [m2]."""
        x, y = (self.position[i][[0, 0, -1, -1], [0, -1, -1, 0]] for i in (0, 1))
        return float(0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)))

    def momentum(self) -> Plane:
        """Of net, bullets and vertex [N s], (3,)."""
        momentum: Plane = (self.mass * self.velocity).sum(axis=(1, 2))
        return momentum


def _masses(knots: int, inner: float, bullet: float, vertex: float) -> Plane:
    """Of all knots [kg]: half of each adjoining thread, the bullets at the corners, the vertex in the middle, which
    four knots share where no knot is there."""
    threads = np.full((knots, knots), 4.0)
    for edge in (threads[0], threads[-1], threads[:, 0], threads[:, -1]):
        edge -= 1.0
    mass: Plane = inner / 4.0 * threads
    mass[:: knots - 1, :: knots - 1] += bullet
    middle = slice((knots - 1) // 2, knots // 2 + 1)
    mass[middle, middle] += vertex / mass[middle, middle].size
    return mass


def _aligned(*shape: int) -> Plane:
    """Zeros whose first lies on a multiple of a vector's bytes."""
    block = np.zeros(int(np.prod(shape)) + VECTOR)
    first = -block.ctypes.data % (8 * VECTOR) // 8
    return block[first : first + int(np.prod(shape))].reshape(shape)
