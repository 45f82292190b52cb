"""The hardware that a tow needs, from its scene."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dcone_cosim.api.said import told
from dcone_cosim.api.scene import Scene, as_scene
from dcone_cosim.api.showing import shown
from dcone_cosim.sizing import commands
from dcone_cosim.sizing.options import options_of
from dcone_cosim.sizing.result import Sizing


def size(
    scene: Scene | str | Path,
    folder: str | Path | None = None,
    *,
    quick: bool = False,
    factor_of_safety: float | None = None,
    samples: int | None = None,
    ranges: Mapping[str, tuple[Any, Any]] | None = None,
    materials: Sequence[str] = (),
    phase: str | None = None,
    jobs: int | None = None,
    progress: bool | None = None,
    isolate: bool | None = None,
) -> Sizing:
    """Size the line of a tow, and what it pulls on, as `dcone size` does.

    scene              a scene, or what `load_scene` takes
    folder             where report, tables and pictures go, as `dcone size -o`; None keeps nothing
    quick              fewer runs, for a first look
    factor_of_safety   on the highest tension; None: what the scene says, else 2                     [1]
    samples            runs with the uncertain values at random
    ranges             what is uncertain, by key: {"removal.thrust.level": ("-20 mN", "-5 mN")}
    materials          names of those the line is sized of; empty: all that are known
    phase              the tow, where the scene has two; None: removal
    jobs, progress, isolate   as for `sweep`

    `sizing.said` is the answer in sentences, `sizing["required"]` a part of the report as a pandas table in SI with its
    units in `attrs["units"]`, `sizing.keys()` the names of the parts.
    """
    given = as_scene(scene)
    spans = [f"{key}={_end(key, least)}..{_end(key, most)}" for key, (least, most) in (ranges or {}).items()]
    with shown(progress) as showing:
        if folder is not None:
            asked = (quick, factor_of_safety, samples, spans, materials)
            return commands.size(given.source, Path(folder), showing, given.settings, *asked, jobs, isolate, phase)
        options = options_of(given.checked, quick, factor_of_safety, samples, spans, materials, phase)
        return commands.of_scene(given.source, options, showing, given.settings, jobs, isolate)


def _end(key: str, value: Any) -> str:
    """An end of a range as `--range` says it: without the quotes of a text."""
    return told(key, value).strip('"')
