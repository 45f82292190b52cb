"""What `dcone run --replay` adds to a scene: that the net is kept in full, for a replay."""

from __future__ import annotations

import math
from collections.abc import Iterator

from dcone_cosim import build
from dcone_cosim.frames import suits
from dcone_cosim.phases import kind_of
from dcone_cosim.scene.data import Scene

GROUPS = ("nodes", "threads")
"""Tables that bring the net into the outputs of a model of ours."""


def replay_settings(scene: Scene) -> Iterator[str]:
    """Settings, as `--set` takes them, that the scene lacks: positions, tensions where they can be told, and a rate of
    frames that suits.

    Checked  tests/report/test_kept.py
    """
    for phase in scene.phases:
        if not kind_of(phase.name).keeps_nodes:
            continue
        if phase.main.fmu is None:
            terms = phase.main.terms
            wanted = (one for one in GROUPS if one not in terms and not set(build.FAMILIES[one].excludes) & set(terms))
            yield from (f"{phase.name}.{group}={{}}" for group in wanted)
        if not math.isfinite(phase.options.replay_every):
            yield f"{phase.name}.replay_every={suits(phase.duration, phase.macro_step):.6g} s"
