"""What a peer is."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

from dcone_cosim.quantities import Quantity
from dcone_cosim.scene.data import PhaseScene


class Found(NamedTuple):
    """What a run of a peer came to, and the CPU time that its steps took [s]."""

    quantities: list[Quantity]
    cpu: float


class Peer(NamedTuple):
    """Another program, with a method of it.

    name       as the figure tells it
    package    that has to be installed
    sizes      its tolerances or steps, coarse to fine
    able(phase)                         whether it can compute a phase of ours
    run(values, size, instants)         values: parameters, and outputs at the start, of our FMU, SI by FMI name;
                                        instants at which curves are wanted [s]
    """

    name: str
    package: str
    sizes: tuple[float, ...]
    able: Callable[[PhaseScene], bool]
    run: Callable[[Mapping[str, float], float, Sequence[float]], Found]
