"""The kinds of phase there are: every module here with a `PHASE`, those that hand over before those that take over."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Mapping
from functools import cache
from graphlib import TopologicalSorter

from dcone_cosim.phases.phase import Phase

PLAIN = Phase()
"""Any system by its own name."""


@cache
def kinds() -> Mapping[str, Phase]:
    """Every kind by its name, in the order in which a scene can have them."""
    modules = (importlib.import_module(f"{__name__}.{found.name}") for found in pkgutil.iter_modules(__path__))
    found = {module.PHASE.name: module.PHASE for module in modules if hasattr(module, "PHASE")}
    order = TopologicalSorter({name: kind.follows for name, kind in found.items()}).static_order()
    return {name: found[name] for name in order}


def kind_of(phase: str) -> Phase:
    """The kind of phase that a scene calls so; one that no kind is called is plain."""
    return kinds().get(phase, PLAIN)
