"""An FMU that changes how its thread computes is remarked on, and nothing that is computed elsewhere notices."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from dcone_cosim.fmu import floating
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.fmu.component import Component, output_names
from dcone_cosim.fmu.isolation import IsolatedComponent
from tests.cosim.conftest import Dcone
from tests.cosim.fmus.build import build

pytestmark = pytest.mark.skipif(not floating.IS_KNOWN, reason="watched on Linux on x86-64")
SCENE = '[removal]\nfmu = "my_removal.fmu"\nisolate = {}\nmacro_step = "10 s"\nduration = "100 s"\n'
TINY, LEAST = 2.0**-60, 5e-324


@pytest.fixture(autouse=True)
def as_before() -> Iterator[None]:
    """No test leaves the next one another way of computing."""
    control = floating.Control()
    yield
    assert control.changed() == ""


def is_plain() -> bool:
    """Whether this thread rounds to nearest and knows numbers below the normal ones, by what it computes."""
    one = np.array([1.0])
    rounds = (one + TINY)[0] == 1.0 and (one - TINY)[0] == 1.0
    return bool(rounds and (np.array([LEAST]) * one)[0] != 0.0 and (np.array([2.3e-308]) * 0.5)[0] != 0.0)


WAYS = [
    ("ROUNDS=FE_UPWARD", "rounding", "fmi2DoStep"),
    ("ROUNDS=FE_TOWARDZERO", "rounding", "fmi2DoStep"),
    ("FLUSHES_TINY", "flushing of tiny results to zero and taking of tiny operands for zero", "fmi2DoStep"),
    ("FLUSHES_TINY_WHEN_LOADED", "flushing of tiny results to zero and taking", "being loaded"),
    ("TRAPS", "traps", "fmi2DoStep"),
    ("PRECISION", "the precision of x87", "fmi2DoStep"),
]


@pytest.mark.parametrize("isolate", [False, True], ids=["here", "isolated"])
@pytest.mark.parametrize(("switch", "what", "call"), WAYS)
def test_it_is_taken_back_and_remarked_on(tmp_path: Path, switch: str, what: str, call: str, isolate: bool) -> None:
    with Archive(build(tmp_path, "removal", switch)) as archive:
        with IsolatedComponent(archive, "tow") if isolate else Component(archive, "tow") as tow:
            tow.initialise(0.0)
            for i in range(10):
                tow.step(10.0 * i, 10.0)
                assert is_plain()
            tow.get(["separation"])
        (remark,) = archive.remarks
    assert remark.startswith("tow: my_removal.fmu changed " + what)
    assert f" in {call};" in remark


def test_one_that_does_not_is_not(tmp_path: Path) -> None:
    """The twin."""
    with Archive(build(tmp_path)) as archive:
        with Component(archive, "tow") as tow:
            tow.initialise(0.0)
            tow.step(0.0, 10.0)
        assert not archive.remarks


@pytest.mark.parametrize("switch", ["ROUNDS=FE_UPWARD", "FLUSHES_TINY_WHEN_LOADED"])
def test_what_is_computed_beside_it_keeps_its_bits(tmp_path: Path, switch: str) -> None:
    """A sound FMU beside it gives the numbers it gives alone; were nothing taken back, they would differ."""

    def steps(*switches: str) -> list[list[float]]:
        with (
            Archive(build(tmp_path / "sound")) as sound,
            Archive(build(tmp_path / "other", "removal", *switches)) as it,
            Component(sound, "sound") as one,
            Component(it, "other") as other,
        ):
            for component in (one, other):
                component.set({f"start.relative_velocity[{i}]": 0.1 / i for i in (1, 2, 3)})
                component.initialise(0.0)
            read, rows = one.reader(output_names(one.variables)), []
            for i in range(10):
                other.step(10.0 * i, 10.0)
                one.step(10.0 * i, 10.0)
                rows.append(read().tolist())
            return rows

    assert steps() == steps(switch)


@pytest.mark.parametrize("isolate", ["false", "true"])
def test_the_run_says_so(dcone: Dcone, tmp_path: Path, isolate: str) -> None:
    build(tmp_path, "removal", "ROUNDS=FE_DOWNWARD")
    (tmp_path / "mine.toml").write_text(SCENE.format(isolate))
    code, _, err = dcone("run", "mine.toml", "-o", "out", "--no-figures")
    assert code == 0
    assert err.count("note: removal: my_removal.fmu changed rounding in fmi2DoStep") == 1
