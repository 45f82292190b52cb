"""Saved states replayed in this process and in others, in the middle of contact and of a tug, and reset."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.packaging.driven import CASES, Driven

ROOT = str(Path(__file__).parents[2])
REPLAY = """
import json, sys
from fmpy import read_model_description
from fmpy.fmi2 import FMU2Slave

path, folder, state, time, step, count, references = json.loads(sys.argv[1])
about = read_model_description(path)
slave = FMU2Slave(guid=about.guid, unzipDirectory=folder, modelIdentifier=about.coSimulation.modelIdentifier)
slave.instantiate()
slave.setupExperiment()
slave.setFMUstate(slave.deSerializeFMUstate(open(state, "rb").read()))
for _ in range(count):
    slave.doStep(time, step)
    time += step
print(json.dumps([v.hex() for v in slave.getReal(references)]))
"""
"""A child that loads the FMU and knows nothing else of this project."""


def in_contact(outputs):
    return outputs["contact.nodes"] > 0 and outputs["mouth.cord_length"] < 90.0 and outputs["closing.t_start"] > 0.0


def in_a_tug(outputs):
    return outputs["tether.taut"] and outputs["tether.tension"] > 0.0 and outputs["tug[1].peak"] > 0.0


MIDDLES = {
    # the mouth is being drawn, and nodes lie on the target
    "net_capture": (CASES["net_capture"][1], 0.25, 46, 12, in_contact),
    # the line has just gone taut; it slackens, and goes taut once more in what follows
    "tethered_deorbit": (
        {"thrust.level": -0.5, "start.separation": 11.9, "tether.damping_ratio": 0.0},
        1.0,
        60,
        60,
        in_a_tug,
    ),
}


@pytest.fixture(params=list(MIDDLES))
def middle(request, fmu):
    """A driven FMU in the middle of what matters, with path, folder, macro step and steps to come."""
    parameters, step, most, rest, reached = MIDDLES[request.param]
    path, folder = fmu(request.param)
    driven = Driven(path, folder, parameters)
    for _ in range(most):
        driven.step(step)
        if reached(driven.outputs()):
            break
    assert reached(driven.outputs()), driven.outputs()
    return driven, path, folder, step, rest


def forward(driven, step, count):
    for _ in range(count):
        driven.step(step)
    return driven.outputs()


def test_replay_in_the_process_is_bit_equal(middle):
    driven, _, _, step, rest = middle
    here, state, time = driven.outputs(), driven.slave.getFMUstate(), driven.time
    ends = []
    for _ in range(2):
        ends.append(forward(driven, step, rest))
        driven.slave.setFMUstate(state)
        driven.time = time
        assert driven.outputs() == here
    assert ends[0] == ends[1]
    # the twin that must fail: one step more or less is another end
    assert forward(driven, step, rest - 1) != ends[0]


def test_replay_in_another_process_is_bit_equal(middle, tmp_path):
    driven, path, folder, step, rest = middle
    state = driven.slave.getFMUstate()
    (tmp_path / "state").write_bytes(driven.slave.serializeFMUstate(state))
    time = driven.time
    real = [v for v in driven.variables.values() if v.causality == "output" and v.type == "Real"]
    argument = [str(path), folder, str(tmp_path / "state"), time, step, rest, [v.valueReference for v in real]]
    command = [sys.executable, "-c", REPLAY, json.dumps(argument)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=tmp_path)
    end = forward(driven, step, rest)
    assert json.loads(done.stdout) == [end[v.name].hex() for v in real]


def test_state_can_be_taken_back_many_times_into_the_past(middle):
    """Several states kept at a time, gone back to in any order."""
    driven, _, _, step, _ = middle
    kept = []
    for _ in range(4):
        kept.append((driven.slave.getFMUstate(), driven.time, driven.outputs()))
        driven.step(step)
    for k in (2, 0, 3, 1):
        state, time, outputs = kept[k]
        driven.slave.setFMUstate(state)
        driven.time = time
        assert driven.outputs() == outputs
        if k < 3:
            driven.step(step)
            assert driven.outputs() == kept[k + 1][2]
    for state, _, _ in kept:
        driven.slave.freeFMUstate(state)


def test_reset_in_the_middle_is_a_fresh_instance_bit_for_bit(middle):
    driven, path, folder, _, _ = middle
    driven.slave.reset()
    fresh = Driven(path, folder, None)

    def bits(one):
        return one.slave.serializeFMUstate(one.slave.getFMUstate())

    assert bits(driven) == bits(fresh)
    fresh.set({"chaser.mass": 2001.0})
    assert bits(driven) != bits(fresh)


def test_a_state_of_another_library_is_refused_by_its_key(fmu):
    from fmpy.fmi1 import FMICallException

    net, tug = (Driven(*fmu(name), {}) for name in MIDDLES)
    with pytest.raises(FMICallException):
        tug.slave.deSerializeFMUstate(net.slave.serializeFMUstate(net.slave.getFMUstate()))
    assert any("belongs to another library" in text for text in tug.messages)
