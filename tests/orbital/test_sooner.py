"""numba with less to do over and over makes the same code, and tells those who listen."""

import json
import os
import subprocess
import sys

import pytest
from numba.core import event, types

from fmu_src.catalogue import MODELS
from fmu_src.packaging import compile
from orbital.kernel import kernel
from tests import emitting
from tests.conftest import CAPTURE

pytestmark = pytest.mark.usefixtures("compiled")
AS_IT_COMES = """
import json, sys
from pathlib import Path
from orbital import sooner
sooner.hasten = lambda: None
from fmu_src.packaging import compile
module, terms, out, kept = sys.argv[1:5]
Path(out).write_text(compile._lower(module, json.loads(terms), Path(kept)))
"""


@pytest.mark.parametrize(
    ("name", "terms"),
    [
        ("reel_control", {}),
        pytest.param("net_capture", CAPTURE, marks=pytest.mark.evidence),
        pytest.param("tethered_deorbit", {"reel": "locked", "thrust": "along_track"}, marks=pytest.mark.evidence),
    ],
)
def test_the_text_is_that_of_numba_as_it_comes(name, terms, tmp_path):
    model = MODELS[name]
    terms = dict(model.interface(terms).terms)
    arguments = [model.module, json.dumps(terms), str(tmp_path / "later.ll"), str(tmp_path / "later")]
    settings = {**os.environ, **compile.ENVIRONMENT}
    subprocess.run([sys.executable, "-c", AS_IT_COMES, *arguments], env=settings, check=True)
    emitting.emit(model, terms, tmp_path / "sooner.ll", tmp_path / "sooner")
    assert (tmp_path / "sooner.ll").read_bytes() == (tmp_path / "later.ll").read_bytes()


def test_who_listens_is_told():
    @kernel
    def twice(x):
        return 2.0 * x

    with event.install_recorder("numba:compile") as heard:
        assert twice(1.5) == 3.0
    assert [told.is_start for _, told in heard.buffer] == [True, False]


def test_a_type_is_of_the_classes_that_it_is_derived_from_alone():
    assert isinstance(types.float64, types.Float)
    assert isinstance(types.float64, types.Number)
    assert not isinstance(types.float64, types.Integer)
    assert not isinstance(1.0, types.Number)
    assert issubclass(types.Float, types.Number)
    assert not issubclass(types.Float, types.Integer)
