"""Names and units of figures, held against what a phase can tell before anything is run, and against the scene's own
figures before any case counts.

A figure that is misspelt, or a bound in another unit, would have a probability told of it that means nothing.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fnmatch import fnmatchcase

from dcone_cosim.campaign.outcomes import unlike
from dcone_cosim.campaign.spec import Spec
from dcone_cosim.cases.rows import Row
from dcone_cosim.names import did_you_mean
from dcone_cosim.phases import kinds
from dcone_cosim.scene.data import Scene
from dcone_cosim.scene.mistakes import Mistake, SceneError, unknown
from dcone_cosim.scene.toml_lines import Path as KeyPath
from dcone_cosim.transaction import FIRST, HAND_OFF

OPTIONAL = "?"
"""Behind the name of a figure that a case may lack."""
TEXT = ""
"""In place of the unit of a figure that is a text."""

_OF_ALL = """
1    steps coupling_steps coupling_rejected coupling_forced
s    coupling_step_smallest coupling_step_largest ended_at
1    accuracy.asked accuracy.error accuracy.scatter accuracy.made
?    mean.* spread.*
     accuracy.setting ended_by
     *.material
Pa   *.stress *.strength
1    *.strain *.margin_of_safety
"""
_OF_CAPTURE = """
     outcome located_by lasted thread.tension_max_node pull_off pull_off.slip pull_off.threads
s    handed_over_at thread.tension_max_time contact.first_time mouth.t80 mouth.t_max closing.t_start t_capture
s    wall.emptied pull_off.t_start lost_after followed
m    approach mouth.cord_length mouth.girth mouth.margin_at_capture contact.depth tether.paid_out
m    quality.length quality.offset pull_off.drawn_max
rad  hinge.angle hinge.angle_max hinge.angle_min
m2   mouth.area_max mouth.area_at_touch quality.hull_surface
m3   net.volume_at_touch quality.hull_volume
N    thread.tension_max cord.tension_max pull_off.tension_max
J    contact.loss contact.friction_loss closing.work closing.spring_energy closing.braked thread.dissipated
J    cord.dissipated air.dissipated bending.dissipated wall.friction_loss gravity.work energy.remainder pull_off.work
J    table.friction_loss self_contact.loss hinge.loss
s    closing.timeout
N s  recoil
1    self_contact.touched self_contact.passed self_contact.at_start
1    net.nodes net.threads enclosure.at_capture enclosure.least quality.at_capture quality.index
"""
_OF_TOW = """
s    simulated broke_at settled_since tension_window approach_time if_*_at reel.calmed released_at return_time
s    wrapped_after first_tug first_tug_seen first_tug_without_recoil first_tug_seen_without_recoil *_lifetime
m/s  first_tug_speed first_tug_seen_speed first_tug_speed_without_recoil first_tug_seen_speed_without_recoil
N    first_tug_peak first_tug_seen_peak first_tug_peak_without_recoil first_tug_seen_peak_without_recoil
N    largest_tug_peak largest_tug_seen_peak largest_tug_peak_without_recoil largest_tug_seen_peak_without_recoil
N    tension_mean tension_least tension_largest electrodynamic_force
1    tugs tugs_without_recoil tugs_missed tugs_missed_without_recoil times_settled settled_share shadows shadow_share
1    level_* reel.limited
m    wrapped separation altitude approach lowered raised return_distance *_perigee *_apogee reel.paid_out
m/s  lowering_rate raising_rate
N m s  appendage_momentum
J    appendage_energy reel.work reel.heat tether.heat
W    electrodynamic_power
V    electrodynamic_emf
A    electrodynamic_current
kg   chaser.propellant
     taut_from_start taut_from_start_without_recoil if_*_meets
m    if_*
?    reel.*
"""
_OF_HANDOFF = """
s    time
kg   mass propellant propellant_spent chaser_mass
m/s  velocity_change target_speed
1    nets_left
m    distance released_axis beyond_hull line attachment_distance slack slack_after net_drawn net_stays
m/s  relative_speed attachment_speed tug_speed
N m s  spin spin_dropped appendage_momentum
J    appendage_energy spin_energy spin_energy_dropped energy_lost
rad/s  body_rate
1    point_bound_time point_bound_peak ledger_closure
N    tension_cut net_load
m/N  net_compliance
     target target_reason line_carried
"""


def _rows(*tables: str) -> dict[str, str | None]:
    """Units by name or pattern; None where the unit hangs on the figure."""
    found: dict[str, str | None] = {}
    for line in "\n".join(tables).strip("\n").splitlines():
        unit, _, names = line.partition("  ")
        found |= dict.fromkeys(names.split(), None if unit == "?" else unit)
    return found


BY_PHASE: Mapping[str, Mapping[str, str | None]] = {
    "capture": _rows(_OF_CAPTURE, _OF_ALL),
    "removal": _rows(_OF_TOW, _OF_ALL),
    "second_shot": _rows(_OF_CAPTURE, _OF_ALL),
    "third_shot": _rows(_OF_CAPTURE, _OF_ALL),
    "second_tow": _rows(_OF_TOW, _OF_ALL),
    "next_capture": _rows(_OF_CAPTURE, _OF_ALL),
    "next_removal": _rows(_OF_TOW, _OF_ALL),
    HAND_OFF: _rows(_OF_HANDOFF),
}
"""Figures of the phases that are known: SI units by name; `TEXT` for a text, None where it hangs on the scene."""


def tellable(base: Scene) -> dict[str, Mapping[str, str | None]] | None:
    """Figures that the phases of a scene can tell, by phase; None of a phase that is known by its outputs alone."""
    names = [phase.name for phase in base.phases]
    found: dict[str, Mapping[str, str | None]] = {}
    for place, name in enumerate(names):
        if name not in kinds() or name not in BY_PHASE:
            return None
        found[name] = BY_PHASE[name]
        if place:
            found[HAND_OFF if name == FIRST else f"{HAND_OFF} to {name}"] = BY_PHASE[HAND_OFF]
    return found


def unit_of(name: str, known: Mapping[str, Mapping[str, str | None]]) -> str | None:
    """Unit of a figure by its name, None where it is not settled yet; `KeyError` for none that there can be."""
    phase, _, key = name.partition(".")
    table = known[phase]
    if key in table:
        return table[key]
    return table[next(one for one in table if "*" in one and fnmatchcase(key, one))]


def check_names(spec: Spec, base: Scene) -> None:
    """`SceneError` for a figure that no run of such a scene tells, or that is in another unit than its bound.

    Checked  tests/campaign/test_figures.py
    """
    known = tellable(base)
    if known is None:
        return
    wrong: list[Mistake] = []
    for path, name in asked(spec):
        try:
            unit = unit_of(name.removesuffix(OPTIONAL), known)
        except (KeyError, StopIteration):
            names = [f"{phase}.{key}" for phase, table in known.items() for key in table if "*" not in key]
            wrong.append(unknown(path, name, f"is no figure that {spec.scene} can tell", name, names))
            continue
        if unit == TEXT and path[0] in ("indices", "success"):
            wrong.append(Mistake(path, name, "is a text; expected a figure that is a number"))
        elif path[0] == "success":
            wrong += misfit(spec, unit)
    wrong = wrong or list(lacking(spec))
    if wrong:
        raise SceneError(wrong, spec.places)


def check_figures(spec: Spec, nominal: Row) -> None:
    """`SceneError` for a figure that the scene as it is does not have, or has in another unit than its bound.

    Checked  tests/campaign/test_figures.py
    """
    known = list(nominal.figures)
    if not known:
        return
    wrong = []
    for path, name in asked(spec):
        if name in nominal.figures or name.endswith(OPTIONAL):
            continue
        said = f"is no figure of {spec.scene} as it is"
        if path[0] != "success":
            said += f'; where some cases alone have it, write "{name}?"'
        wrong.append(unknown(path, name, said, name, known))
    wrong += misfit(spec, nominal.units.get(spec.success.figure))
    wrong = wrong or list(lacking(spec))
    if wrong:
        raise SceneError(wrong, spec.places)


def asked(spec: Spec) -> Iterator[tuple[KeyPath, str]]:
    """Every figure that the campaign's file names, and where."""
    for key, figures in (("record", spec.record), ("indices", spec.indices)):
        yield from (((key, place), figure) for place, figure in enumerate(figures))
    if spec.success.figure:
        yield ("success", "figure"), spec.success.figure


def misfit(spec: Spec, unit: str | None) -> list[Mistake]:
    """What is wrong with the unit of the bound, of a figure in this one."""
    success = spec.success
    text = unlike(success, unit) if success.figure else ""
    return [Mistake(("success", "above" if success.above else "below"), success.given, text)] if text else []


def lacking(spec: Spec) -> Iterator[Mistake]:
    """Figures that are judged or explained and not kept."""
    if not spec.record:
        return
    kept = [one.removesuffix(OPTIONAL) for one in spec.record]
    for path, name in asked(spec):
        if name.removesuffix(OPTIONAL) not in kept:
            yield Mistake(path, name, f"is not kept{did_you_mean(name, kept)}; add it to record")
