"""FMUs for other platforms than this machine's, and an importer in C that runs them."""

import subprocess
import sys
import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from fmpy import read_model_description

from fmu_src.catalogue import MODELS
from fmu_src.packaging import builds, link
from tests.conftest import CAPTURE

HOST = Path(__file__).parent / "platform_host.c"


@dataclass(frozen=True)
class Case:
    """One experiment: a model with its terms, parameters that differ from their defaults, macro step [s] and count."""

    terms: dict
    parameters: dict
    step: float
    count: int


CASES = {
    # a coarse net that meets the target, wraps it and is drawn shut
    "net_capture": Case(CAPTURE, {"net.mesh": 2.0, "closing.time": 9.0, "target.start_rate[1]": 0.02}, 0.25, 60),
    # a pushing chaser and a tether with little damping: tugs
    "tethered_deorbit": Case(
        {"reel": "locked", "thrust": "along_track"}, {"tether.damping_ratio": 0.05, "thrust.level": -0.01}, 60.0, 70
    ),
}


def build(model, platform, cache):
    """Path of the case's FMU for a platform."""
    return builds.build(MODELS[model].interface(CASES[model].terms), cache, platform=platform)


def unpack(fmu, folder, place="*"):
    """Folder with an FMU's content, and the path of its one library, or that of one place."""
    with zipfile.ZipFile(fmu) as content:
        content.extractall(folder)
    (library,) = Path(folder).glob(f"binaries/{place}/*")
    return Path(folder), library


def real_outputs(fmu):
    """Names and value references of the Real outputs, peaks and counts of time among them."""
    variables = read_model_description(str(fmu)).modelVariables
    return {v.name: v.valueReference for v in variables if v.causality == "output" and v.type == "Real"}


def compile_host(target, folder):
    """The importer for a target of clang."""
    path = Path(folder) / ("host.exe" if "windows" in target else "host")
    system = ["-ldl"] if "linux" in target else []
    command = [sys.executable, "-m", "ziglang", "cc", "-target", target, "-O3", "-s", "-std=c99", "-Wall"]
    done = subprocess.run(
        [*command, "-I", str(link.HEADERS), str(HOST), "-o", str(path), *system], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return path


def run_case(model, fmu, folder, launcher=(), target="x86_64-linux-gnu.2.17", environment=None, more=(), place="*"):
    """Outputs after every step, rows of (count, smooth outputs), from the importer in a process of its own."""
    case = CASES[model]
    _, library = unpack(fmu, Path(folder) / "fmu", place)
    description = read_model_description(str(fmu))
    references = {v.name: (v.valueReference, "i" if v.type == "Integer" else "") for v in description.modelVariables}
    given = [f"={references[n][0]}{references[n][1]}:{v!r}" for n, v in case.parameters.items()]
    asked = [f"?{reference}" for reference in real_outputs(fmu).values()]
    host = compile_host(target, folder)
    done = subprocess.run(
        [*launcher, str(host), str(library), description.guid, repr(case.step), str(case.count), *given, *asked, *more],
        capture_output=True,
        text=True,
        env=environment,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    rows = np.array([[float(x) for x in line.split()] for line in done.stdout.splitlines()])
    assert rows.shape == (case.count, len(asked))
    assert np.all(np.isfinite(rows))
    return rows
