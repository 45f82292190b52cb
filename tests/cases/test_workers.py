"""Workers do things side by side; one that dies loses what it did and nothing else, and nobody is left behind."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from dcone_cosim.cases.case import Case
from dcone_cosim.cases.workers import WorkerDied, Workers, cores
from tests.cases import fakes

pytestmark = pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
Cases = Callable[[int], list[Case]]


def test_everything_comes_back_and_is_done_side_by_side(cases: Cases) -> None:
    with Workers(2) as workers:
        going = [workers.submit(fakes.process, case) for case in cases(8)]
        processes = {future.result() for future in going}
    assert len(processes) == 2
    assert os.getpid() not in processes
    assert not any(alive(process) for process in processes)


def alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return True


@pytest.mark.parametrize(("work", "how"), [(fakes.crashes, "was ended by SIGKILL; its last words: a bad pointer"),
                                           (fakes.leaves, "ended itself with exit code 0")])  # fmt: skip
def test_a_worker_that_dies_loses_one_case(cases: Cases, work: Callable[[Case], object], how: str) -> None:
    with Workers(1) as workers:
        going = [workers.submit(work, case) for case in cases(6)]
        with pytest.raises(WorkerDied) as caught:
            going[fakes.CRASHING].result()
        assert str(caught.value) == how
        others = [future.result() for number, future in enumerate(going) if number != fakes.CRASHING]
    assert [row.figures["removal.square"] for row in others] == [n**2 / 7.0 for n in (0, 1, 2, 4, 5)]


def test_an_error_of_the_work_is_told_and_the_worker_lives_on(cases: Cases) -> None:
    with Workers(1) as workers:
        going = [workers.submit(fakes.raises, case) for case in cases(5)]
        with pytest.raises(RuntimeError, match="ZeroDivisionError: of all things"):
            going[fakes.CRASHING].result()
        assert going[4].result().succeeded


def test_what_work_prints_is_not_taken_for_an_answer(cases: Cases) -> None:
    with Workers(1) as workers:
        assert all(workers.submit(fakes.prints, case).result().succeeded for case in cases(3))


def test_each_has_one_core(cases: Cases, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    with Workers(1) as workers:
        assert workers.submit(fakes.threads, cases(1)[0]).result() == "1"
    assert cores() >= 1


def test_an_exception_in_the_block_ends_them_at_once(cases: Cases) -> None:
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt), Workers(2) as workers:  # noqa: PT012
        going = [workers.submit(fakes.endless, case) for case in cases(5)]
        time.sleep(0.3)
        raise KeyboardInterrupt
    assert time.monotonic() - began < 20.0
    assert all(future.done() for future in going)
    with pytest.raises(RuntimeError, match="sent home"):
        workers.submit(fakes.row_of, cases(1)[0])


PARENT = """
    import os, sys
    sys.path.insert(0, {root!r})
    from dcone_cosim.cases.workers import Workers
    from tests.cases import fakes
    workers = Workers(2)
    [workers.submit(fakes.told, {folder!r}) for _ in range(2)]
    print("ready", flush=True)
    sys.stdin.read()
"""


def test_they_end_with_their_parent(tmp_path: Path) -> None:
    """Also when it is killed and can say nothing, and whatever they are doing."""
    program = textwrap.dedent(PARENT).format(root=str(Path(__file__).parents[2]), folder=str(tmp_path))
    pipe = subprocess.PIPE
    with subprocess.Popen([sys.executable, "-c", program], stdin=pipe, stdout=pipe) as parent:
        until(lambda: len(list(tmp_path.iterdir())) == 2)
        parent.send_signal(signal.SIGKILL)
    until(lambda: not any(alive(int(path.name)) for path in tmp_path.iterdir()))


def until(met: Callable[[], bool]) -> None:
    end = time.monotonic() + 30.0
    while not met():
        assert time.monotonic() < end
        time.sleep(0.05)
