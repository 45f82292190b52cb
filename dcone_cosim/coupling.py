"""Several FMUs in one phase: how they are connected, and how their steps are taken."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Connection:
    """An output of one component that sets an input of another, by instance and variable name.

    The input becomes factor * output + offset, both in SI.
    """

    source: str
    output: str
    target: str
    input: str
    factor: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class Coupling:
    """How the components of a phase are stepped between two communication points of the phase.

    method          jacobi: all with the outputs of the point before; gauss_seidel: one after the other in the order of
                    the scene, each with what those before it have reached
    step            length of a coupling step [s]; 0 for the phase's macro step; the first to try when it is controlled
    control         fixed, or error: two half steps against a whole one, rolled back when they differ too much
    tolerance       of the error control, relative to the size of each connected output
    smallest_step   below which the error control gives up [s]
    extrapolation   constant: inputs are held over a step; linear: they go on at the rate of the step before, where the
                    FMU takes input derivatives
    """

    method: Literal["jacobi", "gauss_seidel"] = "gauss_seidel"
    step: float = 0.0
    control: Literal["fixed", "error"] = "fixed"
    tolerance: float = 1e-4
    smallest_step: float = 1e-6
    extrapolation: Literal["constant", "linear"] = "constant"
