"""What the parts of a net cost that a scene may leave out: `pytest -m bench -n 0 -s tests/benchmarks/test_left_out.py`.

Size of the FMU's binary, its variables, and CPU time per substep of an 8 s opening of 25 x 25
knots, over those of the bare net: all fly side by side in this process, a second each in turn. A net without a part has
the bare net's figures: it is the same binary. PARTS=edge,leads names some of them.
"""

import os
import zipfile

import numpy as np
import pytest

from fmu_src.net_capture.interface import MODEL
from tests.benchmarks.test_net_speed import Make, hangar, head, race, row, spread
from tests.conftest import FREE

pytestmark = pytest.mark.bench
__all__ = ["hangar"]
DEPLOYMENT = {"net.mesh": 1.0, "net.damping_ratio": 0.05}
LEFT_OUT = {
    "edge": {"edge": "plain"},
    "leads": {"leads": "plain"},
    "knots": {"knots": "plain"},
    "accordion": {"folding": "accordion"},
    "rolled": {"folding": "rolled"},
    "star": {"folding": "star"},
    "ejection": {"ejection": "4"},
    "spin": {"spin": "turning"},
    "gravity uniform": {"gravity": "uniform"},
    "air": {"air": "quadratic"},
    "break": {"break": "breaks"},
    "volume": {"volume": "plain"},
    "tensions": {"tensions": "plain"},
    "threads": {"threads": "1200"},
    "nodes": {"nodes": "625"},
}
SECONDS = [1.0] * 8


def test_what_is_left_out_costs_nothing(hangar):
    named = [name for name in os.environ.get("PARTS", "").split(",") if name] or list(LEFT_OUT)
    choices = {"bare": FREE, **{name: FREE | LEFT_OUT[name] for name in named}}
    paths = {name: hangar.fmus(f"part {name}", terms)[""] for name, terms in choices.items()}
    makes: dict[str, Make] = {n: lambda path=path: hangar.drive(path, DEPLOYMENT) for n, path in paths.items()}
    taken, flown = race(makes, SECONDS)
    steps = {name: fmu.outputs()["solver.steps"] for name, fmu in flown.items()}
    each = {name: seconds.sum(1) / steps[name] for name, seconds in taken.items()}
    head("part", "binary [kB]", "variables", "ns per substep", "over the bare net's")
    for name, terms in choices.items():
        with zipfile.ZipFile(paths[name]) as archive:
            binary = sum(one.file_size for one in archive.infolist() if one.filename.startswith("binaries/"))
        shown = sum(v.size for v in MODEL.interface(terms).variables if v.at_interface)
        cells = (f"{binary / 1e3:.0f}", shown, f"{1e9 * np.median(each[name]):.0f}")
        row(name, *cells, spread(each[name] / each["bare"]))
        assert (name == "bare") == (len(terms) == len(FREE) and terms == FREE)
