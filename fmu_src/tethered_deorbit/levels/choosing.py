"""The level of detail that a scene names, and what it holds a line by."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from fmu_src.integrators.scheme import AdaptiveScheme
from fmu_src.tethered_deorbit.bodies import Bodies
from fmu_src.tethered_deorbit.idle import never
from fmu_src.tethered_deorbit.law import Reel
from fmu_src.tethered_deorbit.layout import Places, StateLayout
from fmu_src.tethered_deorbit.level import RESOLVED, UNHELD, Held, Level
from fmu_src.tethered_deorbit.levels.averaged import make_averaged, make_leap
from fmu_src.tethered_deorbit.levels.counted import counted
from fmu_src.tethered_deorbit.levels.course import course, make_held
from fmu_src.tethered_deorbit.levels.event_map import make_event_map, mapping
from fmu_src.tethered_deorbit.levels.quintic import quintic_course
from fmu_src.tethered_deorbit.levels.settled import make_settled
from fmu_src.tethered_deorbit.optional_rows import POINTS_ONLY, SETTLING_LAWS, SETTLING_SCHEMES, not_mapped


def check_level(model: str, terms: Mapping[str, str]) -> None:
    """ValueError where a level of detail cannot carry what else is named."""
    if "level" not in terms:
        return
    if terms["reel"] not in SETTLING_LAWS:
        raise ValueError(f"{model}: no line settles with reel = {terms['reel']!r}")
    if terms["level"] in POINTS_ONLY:
        for group, term in not_mapped(terms).items():
            raise ValueError(f"{model}: level = {terms['level']!r} does not go with {group} = {term!r}")


def _settles(terms: Mapping[str, str]) -> bool:
    return "level" in terms and terms["solver"] in SETTLING_SCHEMES


def _sways(terms: Mapping[str, str]) -> bool:
    return any(terms[role] != "point" for role in ("target", "chaser"))


def make_held_of(terms: Mapping[str, str], reel: Reel, bodies: Bodies) -> Held:
    """What a line is held by."""
    if not _settles(terms):
        return UNHELD
    sways = _sways(terms)
    held = make_held(reel, bodies, quintic_course if sways else course, sways)
    return mapping(held) if terms["level"] in POINTS_ONLY else held


def make_level(
    terms: Mapping[str, str],
    derivative: Callable[..., Any],
    scheme: AdaptiveScheme,
    reel: Reel,
    bodies: Bodies,
    held: Held,
    layout: StateLayout,
    places: Places,
) -> tuple[Level, Callable[..., Any]]:
    """The level, and what carries a pair over many revolutions, `never` where nothing does."""
    named = terms.get("level", "")
    if not _settles(terms):
        return (counted(RESOLVED) if named in POINTS_ONLY else RESOLVED), never
    if named not in POINTS_ONLY:
        return make_settled(derivative, scheme, reel, bodies, held, places, _sways(terms)), never
    level = make_event_map(derivative, scheme, reel, bodies, held, places)
    if named != "averaged":
        return level, never
    return make_averaged(level), make_leap(derivative, "engine" in terms, layout)
