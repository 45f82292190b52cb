"""Without its bookkeeping numba makes the same text."""

import json
import os
import subprocess
import sys
from pathlib import Path

from fmu_src.catalogue import MODELS
from fmu_src.packaging import compile
from tests import kernels

WITH_ALL = """
import json
import sys
from pathlib import Path

from fmu_src.packaging import compile
from numba.core import event, postproc
from orbital import bare

run, trigger = postproc.PostProcessor.run, event.trigger_event
bare.leave_out = lambda: None
text = compile._lower(sys.argv[1], json.loads(sys.argv[2]), Path(sys.argv[3]))
assert (postproc.PostProcessor.run, event.trigger_event) == (run, trigger)
print(text, end="")
"""


def test_the_text_is_that_of_numba_with_all(tmp_path: Path) -> None:
    model = MODELS["reel_control"]
    terms = model.interface({}).terms
    kernels.emit_quickly(model, terms, tmp_path / "bare.ll", tmp_path / "bare")
    told = [sys.executable, "-c", WITH_ALL, model.module, json.dumps(dict(terms)), str(tmp_path / "all")]
    environment = {**os.environ, **compile.ENVIRONMENT, "PYTHONPATH": str(Path(__file__).parents[2])}
    text = subprocess.run(told, env=environment, check=True, capture_output=True, text=True).stdout
    assert text == (tmp_path / "bare.ll").read_text()
    assert len(text) > 20_000
