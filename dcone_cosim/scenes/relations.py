"""Checks across the values of a scene: each is well formed, and yet they do not go together."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from dcone_cosim import build
from dcone_cosim.contract import CAPTURE_NEEDS, HAND_OVER, LINE, NEVER
from dcone_cosim.handoff import REMOVAL_SETS
from dcone_cosim.line import ATTACHMENT
from dcone_cosim.scenes.keys import MOST_STEPS, SHARED
from dcone_cosim.scenes.mistakes import Mistake, shown, unknown
from dcone_cosim.scenes.parts import Part
from dcone_cosim.scenes.scene import PHASES, Scene
from dcone_cosim.scenes.toml_lines import Path, given_at

NEEDED_TERM = {"settled": "settling", "tether_taut": "tether"}


def phases_to_run(document: dict[str, Any], present: list[str], mistakes: list[Mistake]) -> list[str]:
    """The phases in their order: those that `phases` names, or all that have a table."""
    given = document.get("phases")
    if given is None:
        return present
    path: Path = ("phases",)
    if not isinstance(given, list) or not given or not all(isinstance(name, str) for name in given):
        mistakes.append(Mistake(path, given, 'expected a list such as ["capture", "removal"]'))
        return present
    for name in dict.fromkeys(given):
        if name not in PHASES:
            mistakes.append(unknown(path, given, f"unknown phase {name!r}", name, PHASES))
        elif name not in document:
            mistakes.append(Mistake(path, given, f"the phase has no table; expected [{name}]"))
    known = [name for name in given if name in PHASES]
    in_order = [name for name in PHASES if name in given]
    if len(known) > len(in_order):
        mistakes.append(Mistake(path, given, f"names a phase twice; expected {shown(in_order)}"))
    elif known != in_order:
        mistakes.append(Mistake(path, given, f"the capture comes before the removal; expected {shown(in_order)}"))
    return [name for name in in_order if name in present]


def about_hand_over(document: dict[str, Any], mains: Mapping[str, Part], chosen: list[str]) -> list[Mistake]:
    """A condition for handing over that no term of the scene can ever report, or none although a removal follows."""
    if "capture" not in mains:
        return []
    part, given, path = mains["capture"], document["capture"].get("hand_over"), ("capture", "hand_over")
    found = []
    group = NEEDED_TERM.get(given) if isinstance(given, str) else None
    if part.fmu is None and group is not None and group not in part.terms:
        found.append(Mistake(path, given, f"needs the table [capture.{group}], which this scene lacks"))
    if len(chosen) == len(PHASES):
        if given == NEVER:
            found.append(Mistake(path, given, f"a removal follows: expected one of {', '.join(HAND_OVER[:-1])}"))
        text = "expected this table: a removal follows, and without it no capture is ever reported"
        missing = [name for name in CAPTURE_NEEDS if name not in part.terms] if part.fmu is None else []
        found += [Mistake(("capture", name), None, text) for name in missing]
    return found


def set_by_handoff(document: dict[str, Any], removal: Part) -> Iterator[Mistake]:
    """Keys of the removal that the hand-off sets, and orbits on which the two phases do not fit together."""
    owned = {name.partition("[")[0] for name in (*REMOVAL_SETS, ATTACHMENT, "start.condition")}
    text = "is set by the hand-off from the capture; leave it out, or run the removal alone"
    tables = document["removal"]
    for section, keys in tables.items():
        for key in keys if isinstance(keys, dict) else ():
            if f"{section}.{key}" in owned or section == "start":
                yield Mistake(("removal", section, key), keys[key], text)
    for variable, path in removal.given.items():
        if path[:2] == ("removal", "parameters") and variable.partition("[")[0] in owned:
            yield Mistake(path, given_at(document, path), text)
    orbit = document.get(SHARED)
    eccentricity = orbit.get("eccentricity", 0.0) if isinstance(orbit, dict) else 0.0
    if eccentricity and isinstance(eccentricity, int | float):
        text = "must be 0 when a capture hands over: its frame turns evenly, as on a circular orbit"
        yield Mistake((SHARED, "eccentricity"), eccentricity, text)


def about_steps(scene: Scene, document: dict[str, Any]) -> Iterator[Mistake]:
    """Macro steps that are too long or too many, and coupling steps that are longer than they."""
    for phase in scene.phases:
        path: Path = (phase.name, "macro_step")
        given, duration = given_at(document, path), shown(document[phase.name]["duration"])
        steps = phase.duration / phase.macro_step
        if phase.macro_step > phase.duration:
            yield Mistake(path, given, f"must be at most {phase.name}.duration, {duration}")
        elif steps > MOST_STEPS:
            text = f"with {phase.name}.duration = {duration} makes {steps:.4g} steps; at most {MOST_STEPS:,}"
            yield Mistake(path, given, text)
        if phase.coupling.step > phase.macro_step:
            at = (phase.name, "coupling", "step")
            yield Mistake(at, given_at(document, at), f"must be at most {phase.name}.macro_step, {shown(given)}")


def about_values(scene: Scene, document: dict[str, Any]) -> Iterator[Mistake]:
    """Values, each within its bounds, with which a phase of ours cannot work; of a foreign FMU nothing is known."""
    for phase in scene.phases:
        if phase.main.fmu is not None:
            continue
        values = {**phase.main.defaults, **phase.main.parameters}
        handed_over = phase is not scene.phases[0]
        must_arrive_in = math.inf if phase.options.get("hand_over") == NEVER else phase.duration
        for refusal in build.cannot_work(phase.name, values, must_arrive_in, phase.main.terms, handed_over):
            section, _, key = refusal.variable.partition(".")
            path = (section, key) if section == SHARED else (phase.name, section, key.partition("[")[0])
            yield Mistake(path, given_at(document, path), refusal.expected, refusal.given)


def about_line(scene: Scene, document: dict[str, Any]) -> Iterator[Mistake]:
    """The one line of two phases: the same length in both, and more than the least it has to span at the shot: from the
    chaser to the nearest point that a target of that size can have, however it lies."""
    if len(scene.phases) < len(PHASES):
        return
    capture, removal = ({**phase.main.defaults, **phase.main.parameters} for phase in scene.phases)
    paths: dict[str, Path] = {phase: (phase, *name.split(".")) for phase, name in LINE.items()}
    told = {phase: given_at(document, path) for phase, path in paths.items()}
    length = removal.get(LINE["removal"])
    if length is None:
        return
    at = "removal" if told["removal"] is not None or told["capture"] is None else "capture"
    other = capture.get(LINE["capture"], length)
    if not math.isclose(length, other, rel_tol=1e-9):
        if told["removal"] is None:
            yield Mistake(paths["removal"], None, "expected the length of the line, here or as capture.tether.length")
            return
        text = f"must equal capture.tether.length = {shown(told['capture'])}: both phases have the same line"
        yield Mistake(paths["removal"], told["removal"], text)
    start = [f"chaser.start_{what}[{i}]" for what in ("position", "velocity") for i in (1, 2, 3)]
    if not all(name in capture for name in start):
        return
    distance, speed = (math.hypot(*(capture[name] for name in names)) for names in (start[:3], start[3:]))
    corners, _ = build.target_surface(capture, scene.phases[0].main.terms) or ([], [])
    nearest = distance - max((math.hypot(*corner) for corner in corners), default=0.0)
    if length <= nearest - speed * scene.phases[0].duration:
        text = f"must exceed {nearest:.6g} m, the distance from the chaser to the target's nearest point at the shot: "
        yield Mistake(paths[at], told[at], text + "a locked line would start stretched", f"{length:g} m")
