"""From a scene to a run that can be looked at, compared and trusted.

    scene.toml -> scene (read, checked) -> build (FMUs) -> master (phase, hand-off, phase) -> run (folder) -> reports

The master drives FMUs through the FMI 2.0 interface alone, by the variable names of `contract` and `handoff`: it cannot
tell ours from a foreign one. Only `build` knows the models this project makes; from their tables of variables follows
what a scene may say. Nothing is imported here, so that the command line answers at once: what `api` offers to Python
comes with the first name that is asked for.

    import dcone_cosim as dc
    run = dc.run(dc.load_scene("mission"))
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dcone_cosim.api import (
        Comparison,
        Run,
        Scene,
        Sizing,
        compare,
        go_on,
        list_scenes,
        load_run,
        load_scene,
        run,
        size,
        sweep,
    )

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


def __getattr__(name: str) -> Any:
    """One of the names of `api`, which is imported now."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from dcone_cosim import api

    return getattr(api, name)


def __dir__() -> list[str]:
    """What it offers, without the modules that are behind it."""
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})
