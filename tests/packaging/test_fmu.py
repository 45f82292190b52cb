"""Both FMUs against their formulas and against fmpy: bits, state, refusals, archive."""

import json
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException

from fmu_src import instance
from fmu_src.catalogue import MODELS
from fmu_src.instance import Instance
from fmu_src.packaging import builds
from tests import kernels
from tests.conftest import CAPTURE
from tests.packaging.driven import CASES, REMOVAL, SHORT, Driven
from tests.plain import PlainInstance, plain
from tests.validating import validate_fmu

__all__ = ["plain"]


def test_description_is_valid(case):
    assert validate_fmu(str(case[1])) == []


def test_binary_gives_the_bits_of_the_library_that_the_tests_run(case):
    name, path, folder, terms, parameters, step, count = case
    driven = Driven(path, folder, parameters)
    shared = Instance(MODELS[name], terms, parameters).initialise()
    for _ in range(count):
        driven.step(step)
        shared.step(step)
    outputs = driven.outputs()
    assert len(outputs) > 20
    unequal = {
        n: (v, shared[n]) for n, v in outputs.items() if np.float64(v).tobytes() != np.float64(shared[n]).tobytes()
    }
    assert unequal == {}
    # the twin that must fail: one parameter moved by a millionth
    moved = next(name for name in parameters if name != "net.mesh")
    other = Instance(MODELS[name], terms, parameters | {moved: parameters[moved] * (1.0 + 1e-6)}).initialise()
    for _ in range(count):
        other.step(step)
    assert any(outputs[n] != other[n] for n in outputs)
    assert isinstance(shared.entry, kernels.Entry) != kernels.compiled_where_run()


def same_bits(one, other, step, count):
    """Whether two instances are the same in every number of record and work memory, after every step."""
    for _ in range(count):
        one.step(step)
        other.step(step)
        if (one.record.tobytes(), one.work.tobytes()) != (other.record.tobytes(), other.work.tobytes()):
            return False
    return True


@pytest.mark.parametrize("name", sorted(SHORT))
@pytest.mark.filterwarnings("ignore:divide by zero:RuntimeWarning")  # as code without tests of each division has it
def test_the_library_gives_the_bits_of_the_formulas_as_they_are_written(name, request):
    """Run as plain Python, where no compiler is that could change them: a whole capture, and a tow with a tug."""
    terms, parameters, step, count, happened = SHORT[name]
    model, moved = MODELS[name], next(iter(parameters))
    library, other = (
        Instance(model, terms, given).initialise()
        for given in (parameters, parameters | {moved: parameters[moved] * (1.0 + 1e-12)})
    )
    request.getfixturevalue("plain")
    assert same_bits(library, PlainInstance(model, terms, parameters), step, count)
    assert all(library[output] > least for output, least in happened.items())
    assert not same_bits(other, PlainInstance(model, terms, parameters), step, count)


@pytest.mark.evidence
def test_the_library_gives_the_bits_of_the_entry_compiled_in_the_process(case, monkeypatch):
    """By another compiler, for this processor, over a longer time."""
    name, _, _, terms, parameters, step, count = case
    shared = Instance(MODELS[name], terms, parameters).initialise()
    monkeypatch.setattr(instance, "entry_of", instance.compiled)
    twin = Instance(MODELS[name], terms, parameters).initialise()
    assert not isinstance(twin.entry, kernels.Entry)
    assert same_bits(shared, twin, step, count)
    shared.step(step)
    assert shared.record.tobytes() != twin.record.tobytes()


def test_fmpy_simulates_it_alike(case):
    _, path, folder, _, parameters, step, count = case
    driven = Driven(path, folder, parameters)
    names = [n for n, v in driven.variables.items() if v.causality == "output" and v.type == "Real"]
    result = simulate_fmu(
        str(path), stop_time=step * count, output_interval=step, start_values=parameters, output=names
    )
    for _ in range(count):
        driven.step(step)
    outputs = driven.outputs()
    assert result["time"][-1] == pytest.approx(step * count)
    last = {n: result[n][-1] for n in names}
    assert last == {n: outputs[n] for n in names}


def test_state_replays_in_process_and_in_another_one(case, tmp_path):
    """Saved in the middle (closing, or a tug), replayed here twice and in a fresh process: the same bits."""
    _, path, folder, _, parameters, step, count = case
    driven = Driven(path, folder, parameters)
    for _ in range(count // 2):
        driven.step(step)
    state = driven.slave.getFMUstate()
    middle = driven.time
    data = driven.slave.serializeFMUstate(state)
    ends = []
    for _ in range(2):
        driven.slave.setFMUstate(state)
        driven.time = middle
        for _ in range(count - count // 2):
            driven.step(step)
        ends.append(driven.outputs())
    assert ends[0] == ends[1]
    (tmp_path / "state").write_bytes(data)
    program = tmp_path / "replay.py"
    program.write_text(
        "import json, sys\n"
        "from tests.packaging.driven import Driven\n"
        "path, folder, state, time, step, count = json.loads(sys.argv[1])\n"
        "driven = Driven(path, folder, {})\n"  # default parameters: another mesh, so another size of memory
        "saved = driven.slave.deSerializeFMUstate(open(state, 'rb').read())\n"
        "driven.slave.setFMUstate(saved)\n"
        "driven.time = time\n"
        "for _ in range(count):\n"
        "    driven.step(step)\n"
        "print(json.dumps({n: float(v).hex() for n, v in driven.outputs().items()}))\n"
    )
    argument = json.dumps([str(path), folder, str(tmp_path / "state"), middle, step, count - count // 2])
    root = str(Path(__file__).parents[2])
    done = subprocess.run(
        [sys.executable, str(program), argument], capture_output=True, text=True, check=True, cwd=root,
        env={"PYTHONPATH": root, "PATH": ""},
    )  # fmt: skip
    assert json.loads(done.stdout) == {n: float(v).hex() for n, v in ends[0].items()}


def test_reset_equals_fresh(case):
    _, path, folder, _, parameters, step, _ = case
    driven = Driven(path, folder, parameters)
    for _ in range(3):
        driven.step(step)
    first = driven.outputs()
    driven.slave.reset()
    driven.time = 0.0
    driven.set(parameters)
    driven.slave.setupExperiment(startTime=0.0)
    driven.slave.enterInitializationMode()
    driven.slave.exitInitializationMode()
    for _ in range(3):
        driven.step(step)
    assert driven.outputs() == first


def test_step_of_zero_length_changes_nothing(case):
    _, path, folder, _, parameters, step, _ = case
    driven = Driven(path, folder, parameters)
    driven.step(step)
    before = driven.outputs()
    driven.slave.doStep(driven.time, 0.0)
    assert driven.outputs() == before


def test_communication_points_may_drift_a_little(case):
    _, path, folder, _, parameters, step, count = case
    ends = []
    for drift in (0.0, 1e-9):
        driven = Driven(path, folder, parameters)
        for i in range(count):
            driven.slave.doStep(i * step * (1.0 + drift), step)
        ends.append(driven.outputs())
    keys = [k for k in ends[0] if k.startswith(("solver.steps", "tether.tug_count", "thread.taut"))]
    assert keys
    assert all(ends[0][k] == ends[1][k] for k in keys)


def test_misuse_is_an_error_not_a_crash(case):
    _, path, folder, _, parameters, step, _ = case
    driven = Driven(path, folder, parameters)
    slave = driven.slave
    with pytest.raises(FMICallException):
        slave.getReal([10**6])
    with pytest.raises(FMICallException):
        slave.setReal([driven.variables["chaser.mass"].valueReference], [1.0])  # fixed after initialisation
    with pytest.raises(FMICallException):
        slave.doStep(5.0 * step, step)  # not where the FMU stands
    with pytest.raises(FMICallException):
        slave.doStep(0.0, -step)
    with pytest.raises(FMICallException):
        slave.deSerializeFMUstate(b"nonsense" * 40)
    driven.step(step)  # still alive


def test_parameter_out_of_bounds_is_refused_with_its_name(case):
    _, path, folder, _, _, _, _ = case
    with pytest.raises(FMICallException):
        Driven(path, folder, {"chaser.mass": -1.0})


def test_archive_depends_on_its_content_alone(tmp_path):
    files = {"modelDescription.xml": b"<x/>", "binaries/linux64/a.so": b"\0\1"}
    builds.pack(files, tmp_path / "a.zip")
    builds.pack(dict(reversed(files.items())), tmp_path / "b.zip")
    assert (tmp_path / "a.zip").read_bytes() == (tmp_path / "b.zip").read_bytes()
    builds.pack(files | {"modelDescription.xml": b"<y/>"}, tmp_path / "b.zip")
    assert (tmp_path / "a.zip").read_bytes() != (tmp_path / "b.zip").read_bytes()


def test_term_left_out_is_not_in_the_fmu(fmu):
    path, _ = fmu("net_capture")
    names = {v.name for v in read_model_description(str(path)).modelVariables}
    assert "close.command" in names
    assert not any(n.startswith(("node[", "orbit.")) for n in names)
    with zipfile.ZipFile(path) as content:
        assert {"modelDescription.xml", "documentation/index.html", "model.png"} < set(content.namelist())
        library = content.read("binaries/linux64/net_capture.so")
    assert b"Py_" not in library
    assert b"fmi2SetContinuousStates" in library


def test_fingerprint_follows_terms_and_tools(monkeypatch):
    model = MODELS["net_capture"]
    first = builds.fingerprint(model.interface(CAPTURE))
    assert first == builds.fingerprint(model.interface(dict(reversed(CAPTURE.items()))))
    assert first != builds.fingerprint(model.interface(CAPTURE | {"gravity": "hill"}))
    monkeypatch.setattr(builds, "version", lambda name: "0")
    assert first != builds.fingerprint(model.interface(CAPTURE))


def test_fingerprint_follows_the_packages_own_version(monkeypatch):
    """The description tells it, so an FMU of another version is another FMU."""
    interface = MODELS["net_capture"].interface(CAPTURE)
    first = builds.fingerprint(interface)
    found = builds.version
    monkeypatch.setattr(builds, "version", lambda name: "9.9" if name == "dcone-cosim" else found(name))
    assert builds.fingerprint(interface) != first
    monkeypatch.setattr(builds, "version", lambda name: "9.9" if name == "pytest" else found(name))
    assert builds.fingerprint(interface) == first


def test_damaged_fmu_in_the_cache_is_built_again(fmu, tmp_path, monkeypatch):
    path, _ = fmu("tethered_deorbit")
    interface = MODELS["tethered_deorbit"].interface(CASES["tethered_deorbit"][0])
    copy = tmp_path / path.name
    copy.write_bytes(path.read_bytes()[:5000])
    asked = []
    monkeypatch.setattr(builds.compile, "emit", lambda *_: asked.append(True) or (_ for _ in ()).throw(KeyError))
    with pytest.raises(KeyError):
        builds.build(interface, tmp_path)
    assert asked
    assert [p.name for p in tmp_path.iterdir()] == [path.name]  # the half-built one is gone
    copy.write_bytes(path.read_bytes())
    assert builds.build(interface, tmp_path) == copy


def test_a_cache_that_can_not_be_written_says_so(tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(OSError, match="can not be written"):
        builds.build(MODELS["tethered_deorbit"].interface(REMOVAL), tmp_path / "file" / "cache")
