"""Long macro steps of the compiled FMUs: the bits of short ones, and a word now and then of where they are."""

import itertools
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from fmu_src.tethered_deorbit.model import SLICE
from tests.packaging.driven import Driven, library_of

ROOT = Path(__file__).parents[2]
LAST_STEP = ("tension_peak", "tension_least")
"""Endings of names of what is said of the last macro step alone."""
PEAKS = ("thread.tension_peak", "cord.tension_peak")
STEPPING = """
import json, sys
from tests.packaging.raw import Library, Raw

path, guid = json.loads(sys.argv[1])
raw = Raw(Library(path), guid)
raw._hear = lambda status, category, form, text: print(status, category.decode(), text.decode(), flush=True)
raw.start()
raw.step(0.0, 1e9)
"""
"""A child that makes one step of thirty years."""


def driven(fmu, name, parameters):
    return Driven(*fmu(name), parameters)


def test_a_step_that_was_left_many_times_has_the_bits_of_short_ones(fmu):
    """Of the removal, at four of its instants."""
    parameters = {"tether.damping_ratio": 0.05, "thrust.level": -0.01}
    long, short = driven(fmu, "tethered_deorbit", parameters), driven(fmu, "tethered_deorbit", parameters)
    for _ in range(4):
        long.step(7200.0)
        for _ in range(120):
            short.step(60.0)
        ends = [{n: v for n, v in d.outputs().items() if not n.endswith(LAST_STEP)} for d in (long, short)]
        assert ends[0] == ends[1]
    assert long.outputs()["solver.steps"] > 4 * SLICE, "the steps were not left"


def test_a_long_step_of_the_net_has_the_bits_of_short_ones(fmu):
    """It is left at each look, every 0.01 s; a peak of the last macro step is the largest of those in it."""
    parameters = {"net.mesh": 6.0, "closing.time": 0.5, "net.youngs_modulus": 7e6, "closing.axial_stiffness": 9.0}
    long, short = driven(fmu, "net_capture", parameters), driven(fmu, "net_capture", parameters)
    long.step(2.0)
    peaks = []
    for _ in range(40):
        short.step(0.05)
        peaks.append([short.outputs()[name] for name in PEAKS])
    ends = [d.outputs() for d in (long, short)]
    assert [ends[0].pop(name) for name in PEAKS] == [max(column) for column in zip(*peaks, strict=True)]
    assert peaks[-1] != [max(column) for column in zip(*peaks, strict=True)] != [0.0, 0.0]
    assert ends[0] == {n: v for n, v in ends[1].items() if n not in PEAKS}


@pytest.mark.slow
@pytest.mark.parametrize("times", [1, pytest.param(2, marks=pytest.mark.evidence)])
def test_a_step_of_thirty_years_says_where_it_is(fmu, times):
    path, folder = fmu("tethered_deorbit")
    about = Driven(path, folder, None).description
    command = [sys.executable, "-c", STEPPING, json.dumps([library_of(folder), about.guid])]
    said = []
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=ROOT) as child:
        try:
            for line in child.stdout:
                found = re.fullmatch(r"0 logEvents at (\S+) s, in the step to 1e\+09 s\n", line)
                said += [float(found[1])] if found else []
                if len(said) == times:
                    break
        finally:
            child.kill()
    assert len(said) == times
    assert all(0.0 <= before < after < 1e9 for before, after in itertools.pairwise([0.0, *said]))
