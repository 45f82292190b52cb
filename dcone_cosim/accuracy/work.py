"""One case run in a worker: the quantities of its phase, and the CPU time that its steps took."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field

from dcone_cosim.cases.case import Case
from dcone_cosim.cases.rows import Row
from dcone_cosim.cases.work import run_case
from dcone_cosim.errors import FAILED_AFTER
from dcone_cosim.phases import kind_of
from dcone_cosim.results import RunResult

CPU = "cpu of the steps"
STEPS, END = "steps of the solver", "end of the phase"
TOLD = "solver.steps"
"""Output that counts them."""


@dataclass(frozen=True)
class Measured(Case):
    """A case of one phase.

    instants    at which curves are compared [s]
    """

    instants: tuple[float, ...] = ()


@dataclass(frozen=True)
class OfPeer(Measured):
    """A case of another program.

    what, peer    what it computes, and its name there (`peers.PEERS`)
    size          its tolerance or step
    values        parameters, and outputs at the start, of our FMU
    """

    what: str = ""
    peer: str = ""
    size: float = 0.0
    values: Mapping[str, float] = field(default_factory=dict)


def tell(case: Case, result: RunResult, timings: Mapping[str, float]) -> Row:
    """The row of a run that is judged by its quantities."""
    assert isinstance(case, Measured)
    samples = {}
    for name, phase in result.phases.items():
        samples = {q.key: asdict(q) for q in kind_of(name).quantities(result, phase, case.instants)}
        steps = phase.recorder.last().get(TOLD, 0.0) if len(phase.recorder) else 0.0
        timings = {**timings, CPU: phase.cpu, STEPS: steps, END: phase.end - phase.start}
    return Row(case.key, result.status, result.exit_code, result.message, timings=timings, samples=samples)


def measure(case: Case) -> Row:
    """Run a case in this process, whose FMUs stay loaded for the next."""
    return _by_peer(case) if isinstance(case, OfPeer) else run_case(case, tell)


def _by_peer(case: OfPeer) -> Row:
    from dcone_cosim.accuracy import peers

    try:
        found = peers.run(case.what, case.peer, case.values, case.size, case.instants)
    except Exception as error:
        return Row(case.key, "failed", FAILED_AFTER, f"{case.peer}: {type(error).__name__}: {error}")
    samples = {q.key: asdict(q) for q in found.quantities}
    return Row(case.key, "completed", timings={CPU: found.cpu, STEPS: 0.0, END: 0.0}, samples=samples)
