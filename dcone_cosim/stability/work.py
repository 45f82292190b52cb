"""One case in a worker: what it would take, its run, and the runs that it is compared with."""

from __future__ import annotations

import os
import sys
import threading
import time as clock
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from dcone_cosim import build
from dcone_cosim.cases.case import Case
from dcone_cosim.cases.cost import Cost, estimate
from dcone_cosim.cases.pace import spoken
from dcone_cosim.cases.rows import FAULT, REFUSED, Row
from dcone_cosim.cases.work import Kept, run_alone
from dcone_cosim.criteria import Criterion, evidence_of
from dcone_cosim.errors import CASES_FAILED, SUCCESS
from dcone_cosim.phases import kind_of
from dcone_cosim.quantities import Quantity
from dcone_cosim.results import PhaseResult
from dcone_cosim.scene.data import Scene
from dcone_cosim.stability import judge
from dcone_cosim.stability.judge import (
    FAILED,
    LEFT,
    ORDER,
    Verdict,
    agreement,
    falls,
    names_bound,
    refusal,
    sameness,
    suited,
    unlike,
    verdict,
)

IDLE = 0.01
"""Share of the time in which a case that does not hang uses some of the processor."""
PATIENCE = 12.0
"""Limits after which a case that is still there counts as hanging: it was reckoned to take one, a finer run four."""
FINER = 5.0
"""What a finer run takes, over the run itself."""


@dataclass(frozen=True)
class Cell(Case):
    """A scheme at an extreme.

    asked      key of the criterion that it is about
    limit      CPU time that it may take [s]
    instants   at which curves are compared [s]
    finer      the same with a finer step or tolerance; with other macro steps for `same`
    jittered   its twin that begins a micrometre beside it, if there is one
    same       whether the other run must come to the same
    scatters   why a finer run cannot be asked to agree; "" where it can
    quick      whether it is left out, and not refused, if it would take longer
    """

    asked: str = ""
    limit: float = 60.0
    instants: tuple[float, ...] = ()
    finer: Scene | None = None
    jittered: Scene | None = None
    same: bool = False
    scatters: str = ""
    quick: bool = False


def measure(case: Case) -> Row:
    """The row of a cell; a case that hangs takes its process with it, and that is told."""
    assert isinstance(case, Cell)
    with _patience(PATIENCE * case.limit + 60.0):
        found, cost, spent = judge_cell(case)
    samples = {**found.told(), "estimate": None if cost is None else {"cpu": cost.cpu, "steps": cost.steps}}
    code = CASES_FAILED if found.red else SUCCESS
    return Row(case.key, found.kind, code, found.text, timings={"cpu": spent}, samples=samples)


@contextmanager
def _patience(seconds: float) -> Iterator[None]:
    """Ends the process after so much of its CPU time, or where it has used next to none of it for as long on the clock:
    on a machine with other work a case takes its time."""
    over = threading.Event()

    def watch() -> None:
        begin = before = clock.process_time()
        while not over.wait(seconds):
            now = clock.process_time()
            if now - begin >= seconds or now - before < IDLE * seconds:
                sys.stderr.write(f"it had not ended after {spoken(seconds)}\n")
                sys.stderr.flush()
                os._exit(70)
            before = now

    threading.Thread(target=watch, daemon=True).start()
    try:
        yield
    finally:
        over.set()


def judge_cell(cell: Cell) -> tuple[Verdict, Cost | None, float]:
    """Verdict, estimate and CPU time spent [s] of a cell."""
    cost = estimate(cell.scene)
    if cost is not None and cost.cpu > cell.limit:
        if cell.quick:
            return Verdict(LEFT, f"not in a quick look: it would take {cost.told()}"), cost, 0.0
        return refusal(f"too long: {cost.told()}, and {spoken(cell.limit)} are allowed"), cost, 0.0
    here = run_alone(cell.scene)
    if here.phase is None:
        return _without(here.row, cell), cost, 0.0
    spent = here.phase.cpu
    criteria = list(kind_of(_name(cell)).criteria(evidence_of(here.result, cell.scene.phases[0])))  # type: ignore[arg-type]
    main = cell.scene.phases[0].main
    wider = build.within(main.model, main.values, main.terms) if main.fmu is None else {}
    instead = build.instead(main.model, main.terms)
    if here.phase.error is not None:
        return _stopped(cell, here.phase, suited(criteria, instead, wider)), cost, spent
    for one, more in _compared(cell, here, criteria, spent):
        criteria.append(one)
        spent += more
    criteria = suited(criteria, instead, wider)
    return verdict(criteria, cell.asked), cost, spent


def _name(cell: Cell) -> str:
    return cell.scene.phases[0].name


def _without(row: Row, cell: Cell) -> Verdict:
    """Of a case that did not begin."""
    lines = [line.strip() for line in row.message.splitlines() if line.strip()]
    if row.status == REFUSED:
        return refusal(_reason(lines), cell.asked)
    return Verdict(FAILED, lines[-1] if row.status == FAULT and lines else " ".join(lines) or row.status)


def _stopped(cell: Cell, phase: PhaseResult, criteria: Sequence[Criterion]) -> Verdict:
    """Of a run that an FMU stopped: refused where the FMU is ours, names its bound, and all was well until then."""
    lines = [line.strip() for line in str(phase.error).splitlines() if line.strip()]
    told = _reason(lines)
    broken = [one.label for one in criteria if not one.value <= one.stable]
    if cell.scene.phases[0].main.fmu is None and len(lines) > 1 and names_bound(told) and not broken:
        return Verdict(judge.REFUSED, told, criteria)
    before = f", after {' and '.join(broken)} was broken" if broken else ""
    return Verdict(FAILED, f"stopped at {phase.end:.6g} s{before}: {phase.error}", criteria)


def _reason(lines: Sequence[str]) -> str:
    """What an FMU said of the values it refuses: not who could not begin, nor by which call."""
    told = [line for line in lines[1:] if not (line.startswith("(") and line.endswith(")"))]
    return " ".join(told or lines)


def _compared(cell: Cell, here: Kept, criteria: Sequence[Criterion], spent: float) -> Iterator[tuple[Criterion, float]]:
    """The criteria that other runs are needed for, with the CPU time of these [s]."""
    if cell.scatters:
        yield unlike(cell.scatters), 0.0
        return
    if cell.finer is None:
        return
    if not cell.same and FINER * spent > 4.0 * cell.limit:
        yield unlike(f"it would take about {spoken(FINER * spent)}"), 0.0
        return
    other = run_alone(cell.finer)
    if other.phase is None or other.phase.error is not None:
        yield unlike(f"that stops: {other.row.message}"), 0.0
        return
    more = other.phase.cpu
    if cell.asked == ORDER:
        assert other.result is not None
        kind, phase = kind_of(_name(cell)), cell.finer.phases[0]
        rounding = kind.rounding(phase)
        assert rounding is not None, "no such cell is planned"
        yield falls(criteria, list(kind.criteria(evidence_of(other.result, phase))), rounding), 0.0
    mine, others = _quantities(cell, here), _quantities(cell, other)
    if cell.same:
        yield sameness(mine, others), more
        return
    chaotic = kind_of(_name(cell)).chaotic
    found = agreement(mine, others, None)
    if cell.jittered is None or (not chaotic and found.value <= found.stable):
        yield found, more
        return
    twin = run_alone(cell.jittered)
    if twin.phase is None or twin.phase.error is not None:
        yield unlike(f"its twin stops: {twin.row.message}"), more
        return
    count = len(cell.instants) if chaotic else 0
    yield agreement(mine, others, _quantities(cell, twin), count), more + twin.phase.cpu


def _quantities(cell: Cell, ran: Kept) -> list[Quantity]:
    assert ran.result is not None
    assert ran.phase is not None
    return list(kind_of(_name(cell)).quantities(ran.result, ran.phase, cell.instants))
