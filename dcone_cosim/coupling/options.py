"""Several FMUs in one phase, as a scene declares them: how they are connected, and how their steps are taken.

`wiring` checks the connections against the FMUs, `coupled` runs them.
"""

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

    def __str__(self) -> str:
        return f"{self.source}.{self.output} -> {self.target}.{self.input}"


@dataclass(frozen=True)
class Coupling:
    """How the components of a phase are stepped between two communication points of the phase.

    method          jacobi: all with the outputs of the point before; gauss_seidel: one after the other, each with what
                    those before it have reached
    step            length of a coupling step [s]; 0 for the phase's macro step; the first to try when it is controlled
    control         fixed, or error: two half steps against a whole one, rolled back when they differ too much
    tolerance       of the error control: error that may be added in one macro step, relative to the largest size that
                    each connected output has had
    smallest_step   of the error control [s]. At a jump no step meets the tolerance; one of this length is then taken as
                    it is and counted as forced; many of them running are refused
    extrapolation   constant: inputs are held over a step; linear: they go on at the rate of the step before (those from
                    components that have gone ahead are interpolated), where the FMU takes input derivatives
    order           of gauss_seidel, every instance once; empty: the main component, then the others as in the scene
    """

    method: Literal["jacobi", "gauss_seidel"] = "gauss_seidel"
    step: float = 0.0
    control: Literal["fixed", "error"] = "fixed"
    tolerance: float = 1e-4
    smallest_step: float = 1e-6
    extrapolation: Literal["constant", "linear"] = "constant"
    order: tuple[str, ...] = ()

    @property
    def convergence_order(self) -> int:
        """Power of the coupling step with which the error goes down where all is smooth."""
        return 2 if self.extrapolation == "linear" else 1
