"""An FMU in our process that calls exit(0) does not look like success; nothing else ends otherwise than before."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from tests.cosim.fmus.build import build

ROOT = Path(__file__).parents[2]
SCENE = '[removal]\nfmu = "my_removal.fmu"\nisolate = false\nmacro_step = "10 s"\nduration = "100 s"\n'
PROGRAM = """
    from dcone_cosim.scene_fmus import SceneFmus
    from dcone_cosim.progress import Progress
    from dcone_cosim.loading import load
    with SceneFmus(load({scene!r}), Progress()) as archives:
        component = archives.instantiate("removal", "it")
        component.enter_initialisation(0.0)
        component.exit_initialisation()
        for i in range(10):
            component.step(10.0 * i, 10.0)
        component.close()
    {last}
"""

pytestmark = pytest.mark.skipif(os.name == "nt", reason="there is no such signal")


def ended(folder: Path, *switches: str, last: str = "pass") -> int:
    (build(folder, "removal", *switches).parent / "mine.toml").write_text(SCENE)
    program = textwrap.dedent(PROGRAM).format(scene=str(folder / "mine.toml"), last=last)
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    return subprocess.run([sys.executable, "-c", program], env=environment, check=False).returncode


def test_exit_0_is_no_success(tmp_path: Path) -> None:
    assert ended(tmp_path, "EXIT=0") == -signal.SIGABRT


@pytest.mark.parametrize(
    ("last", "code"), [("pass", 0), ("raise SystemExit(3)", 3), ("import os; os._exit(4)", 4), ("1 / 0", 1)]
)
def test_our_own_end_is_what_it_was(tmp_path: Path, last: str, code: int) -> None:
    assert ended(tmp_path, last=last) == code
