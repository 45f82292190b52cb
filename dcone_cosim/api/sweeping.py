"""Many runs of a scene, as one table."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dcone_cosim.api.said import told
from dcone_cosim.api.scene import Scene, as_scene
from dcone_cosim.api.showing import shown
from dcone_cosim.cases import commands, vary
from dcone_cosim.cases.table import as_arrow
from dcone_cosim.errors import InputError
from dcone_cosim.scratch import Scratch

if TYPE_CHECKING:
    import pandas as pd


def sweep(
    scene: Scene | str | Path,
    values: Mapping[str, Sequence[Any]],
    folder: str | Path | None = None,
    *,
    jobs: int | None = None,
    progress: bool | None = None,
    isolate: bool | None = None,
) -> pd.DataFrame:
    """Run a scene with each value of a key, or every value of several keys with every other, on all cores.

    scene      a scene, or what `load_scene` takes
    values     by key: {"removal.tether.diameter": ["1 mm", "2 mm"]}; as in `Scene.with_`
    folder     where the rows are kept, as `dcone sweep -o` does: the same call goes on there with what is missing;
               None keeps nothing
    jobs       cases at a time; one per core for None
    progress   as for `run`

    A row for each case: the values, status, message, and every figure of the summary. Units are in
    `frame.attrs["units"]`. A case that fails is a row with its reason. Phases before all that is varied are run once.
    """
    given = as_scene(scene)
    keys = [vary.Varied(key, tuple(told(key, value) for value in _several(key, of))) for key, of in values.items()]
    settings = [setting for setting in given.settings if setting.partition("=")[0] not in values]
    with shown(progress) as progressing:
        if folder is None:
            with Scratch.temporary() as scratch:
                done = commands.sweep_over(
                    given.source, vary.checked(keys), scratch / "sweep", progressing, settings, jobs, False, isolate
                )
        else:
            done = commands.sweep_over(
                given.source, vary.checked(keys), Path(folder), progressing, settings, jobs, True, isolate
            )
    table = as_arrow(done.columns)
    frame: pd.DataFrame = table.to_pandas()
    frame.attrs = json.loads(table.schema.metadata[b"PANDAS_ATTRS"])
    frame.attrs["title"] = done.title
    return frame


def _several(key: str, values: Any) -> Sequence[Any]:
    if isinstance(values, str) or not hasattr(values, "__iter__") or isinstance(values, Mapping):
        raise InputError(f'{key} = {values!r}: expected several values, such as ["1 mm", "2 mm"]')
    return list(values)
