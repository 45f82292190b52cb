"""Models shared by the tests, whose kernels are compiled once in a run: see `tests.kernels`."""

import gc
import importlib
import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path

import pytest

from fmu_src.instance import Instance
from fmu_src.interface import Value
from fmu_src.net_capture.interface import MODEL as NET
from fmu_src.packaging import compile
from fmu_src.tethered_deorbit.interface import MODEL as TOW
from tests import kernels, validation

FREE = {"net": "square", "gravity": "none"}
CAPTURE = {
    "net": "square",
    "gravity": "none",
    "target": "box",
    "contact": "inelastic",
    "closing": "winches",
    "tether": "slack",
    "settling": "speed",
}
CAPTURE_HILL = {**{k: v for k, v in CAPTURE.items() if k != "settling"}, "gravity": "hill", "nodes": "625"}
"""The mission's, whose kernels a run of the tests has anyway."""
FLOWN_MOST = (
    *((NET, terms) for terms in (FREE, FREE | {"solver": "rk4"}, CAPTURE, CAPTURE_HILL)),
    (TOW, {"reel": "locked", "thrust": "along_track"}),
)
"""What makes it worth while to optimise a library."""

DEAREST = (
    "tests/consistency/test_readme.py",
    "tests/net_capture/test_union_wrapping.py",
    "tests/net_capture/test_shell_wrapping.py",
    "tests/interop/test_tools.py",
    "tests/campaign/test_commands.py",
    "tests/net_capture/test_hinged_contact.py",
    "tests/net_capture/test_free_flight.py",
    "tests/net_capture/test_contact.py",
    "tests/cosim/test_isolation.py",
    "tests/packaging/test_platforms.py",
    "tests/report/test_live.py",
    "tests/net_capture/test_schemes.py",
    "tests/cases/test_commands.py",
    "tests/tethered_deorbit/test_way.py",
    "tests/cosim/test_swapped_in.py",
    "tests/net_capture/test_hooked_threads.py",
    "tests/cosim/test_kills.py",
    "tests/net_capture/test_capstan.py",
    "tests/cosim/test_built_fmus.py",
    "tests/net_capture/test_wrapping.py",
    "tests/net_capture/test_visits.py",
    "tests/net_capture/test_led_net.py",
    "tests/cosim/test_digits.py",
    "tests/tethered_deorbit/test_sky.py",
    "tests/interop/test_ssp_tools.py",
    "tests/cosim/test_ssp_export.py",
    "tests/net_capture/test_rigging.py",
    "tests/net_capture/test_near_pairs.py",
    "tests/cases/test_beginnings.py",
    "tests/tethered_deorbit/test_averaged.py",
    "tests/tethered_deorbit/test_rigid.py",
    "tests/resume/test_same_bits.py",
    "tests/net_capture/test_slip_loss.py",
    "tests/stability/test_command.py",
    "tests/net_capture/test_following.py",
    "tests/net_capture/test_own_net.py",
    "tests/net_capture/test_shapes.py",
    "tests/net_capture/test_bending.py",
    "tests/packaging/test_fmu.py",
    "tests/benchmarks/test_plain_net.py",
)
"""Files that take longest, the longest first, so that no worker is left with one when the others are done. Of two that
want one build, as READMEs and pages want the C library of a page, one comes later, which would else wait."""


def pytest_addoption(parser: pytest.Parser) -> None:
    told = "run the tests that compare with independent sources alone, and write their rows here (see tests.validation)"
    parser.addoption(validation.OPTION, metavar="FOLDER", type=Path, default=None, help=told)


def pytest_configure(config: pytest.Config) -> None:
    """What is compiled in a process that runs tests is kept, and found by the others; the one that only deals them out
    has no need of numba."""
    if hasattr(config, "workerinput") or not config.getoption("numprocesses", None):
        kernels.keep()
        gc.disable()


@pytest.hookimpl(wrapper=True)
def pytest_collection(session: pytest.Session) -> Iterator[None]:
    """Of two workers one reads the tests from their end: in a fresh checkout each compiles half of them, and finds the
    bytecode of the others."""
    if getattr(session.config, "workerinput", {}).get("workerid") == "gw1" and session.config.args == ["tests"]:
        for path in sorted(Path(__file__).parent.rglob("test_*.py"), reverse=True):
            with suppress(Exception, pytest.skip.Exception):  # told where the tests are collected
                importlib.import_module(".".join(path.relative_to(session.config.rootpath).with_suffix("").parts))
    return (yield)


def pytest_collection_finish(session: pytest.Session) -> None:
    """Tests and modules live to the end: garbage is not looked for among them, and seldom else, since what compiles
    makes millions of objects that stay."""
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)
    gc.enable()


def pytest_sessionfinish(session: pytest.Session) -> None:
    """Libraries that count what is left of them find it gone."""
    gc.unfreeze()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    validation.keep_validating(config, items)
    place = {name: k for k, name in enumerate(DEAREST)}
    items.sort(key=lambda item: place.get(item.nodeid.partition("::")[0], len(place)))


@pytest.fixture(autouse=True)
def begins_and_ends_at_the_root(pytestconfig: pytest.Config) -> Iterator[None]:
    """Whatever a test or a library leaves the working directory at: fmpy stays beside a binary that does not load, and
    builds of later tests find no module of `tests` from there."""
    os.chdir(pytestconfig.rootpath)
    yield
    os.chdir(pytestconfig.rootpath)


@pytest.fixture(scope="session", autouse=True)
def shared_kernels(tmp_path_factory: pytest.TempPathFactory) -> None:
    """One folder for all processes of a run, and for the runs of a single process."""
    long = [model.interface(terms).terms for model, terms in FLOWN_MOST]
    kernels.share(tmp_path_factory.getbasetemp().parent / "kernels", long)


@pytest.fixture
def validated(request: pytest.FixtureRequest) -> validation.Validated:
    """Compare a number with that of an independent source, as the validation page tells it: see `tests.validation`."""
    return validation.Validated(
        request.node.nodeid, validation.stored_rows(), request.config.getoption(validation.OPTION)
    )


@pytest.fixture
def numba_as_it_comes(monkeypatch: pytest.MonkeyPatch) -> None:
    """For a test that judges a build: processes begin without the settings of builds, which this one has."""
    for name in compile.ENVIRONMENT:
        monkeypatch.delenv(name, raising=False)


@pytest.fixture
def compiled_anew(monkeypatch: pytest.MonkeyPatch, numba_as_it_comes: None) -> None:
    """The same, and its kernels are compiled, whether or not the run has them."""
    monkeypatch.setattr(compile, "emit", kernels.emit)


@pytest.fixture
def shoot() -> Callable[..., Instance]:
    """Make and initialise a net: `shoot({"net.mesh": 2.0}, terms=FREE)`."""

    def make(parameters: Mapping[str, Value] | None = None, terms: Mapping[str, str] = FREE) -> Instance:
        return Instance(NET, terms, parameters).initialise()

    return make
