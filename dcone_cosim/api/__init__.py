"""The program in Python, as in a notebook: `import dcone_cosim as dc`.

    scene       a scene, and others like it     said      Python's values as a scene's
    result      what a run found                summary   its figures by name; pictures: as a notebook shows them
    running     scenes run, runs read back      sweeping  many at once; showing: progress
    comparison  two runs side by side                 sizing    the hardware that a tow needs

`dcone_cosim` itself offers the names below and imports them when one is first asked for, so that the command line
answers at once.
"""

from __future__ import annotations

from dcone_cosim.api.comparison import Comparison, compare
from dcone_cosim.api.result import Run
from dcone_cosim.api.running import go_on, load_run, run
from dcone_cosim.api.scene import Scene, list_scenes, load_scene
from dcone_cosim.api.sizing import size
from dcone_cosim.api.sweeping import sweep
from dcone_cosim.sizing.result import Sizing

__all__ = [
    "Comparison",
    "Run",
    "Scene",
    "Sizing",
    "compare",
    "go_on",
    "list_scenes",
    "load_run",
    "load_scene",
    "run",
    "size",
    "sweep",
]
