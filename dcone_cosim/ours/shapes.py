"""Geometry and masses of our nets and targets, from the values of a scene or of an FMU in a file."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from fmu_src.interface import Term
from fmu_src.net_capture import force_map
from fmu_src.net_capture.appendage.laying import corners_at, held_at, pieces_at, swung
from fmu_src.net_capture.hinge import numbers as hinge
from fmu_src.net_capture.interface import NETS, TARGETS, rigged_of
from fmu_src.net_capture.shapes.union import PIECES
from fmu_src.tethered_deorbit.surfaces import SURFACES
from fmu_src.tethered_deorbit.surfaces.hull import CORNERS
from orbital.corners import few_corners

Drawing = tuple[list[list[int]], list[int]]

Surface = tuple[list[Sequence[float]], list[list[int]]]


def target_distance(
    values: Mapping[str, float], terms: Mapping[str, str]
) -> Callable[[Mapping[str, float], Sequence[float]], float] | None:
    """Function of values and a point in body axes [m]: its distance from the target's surface, negative inside [m];
    None for a target that is none of ours."""
    part = _part(TARGETS, terms.get("target"), values)
    return None if part is None else part.checks.distance


def mouth_sides(values: Mapping[str, float], terms: Mapping[str, str]) -> list[float]:
    """Sides of the mouth as meant, each from a bullet to the next [m]; none for a net that is none of ours."""
    part = _net(values, terms)
    return [] if part is None else list(part.checks.sides(values))


def shot_frame(values: Mapping[str, float]) -> tuple[Any, Any]:
    """Muzzle [m] and axes as rows (two transverse, then the shot's own) of the frame that a shot is measured in."""
    from types import SimpleNamespace

    from fmu_src.implied import formula
    from fmu_src.net_capture.shot import aim

    given = {
        name.replace(".", "_"): np.array([values[f"{name}[{axis}]"] for axis in (1, 2, 3)])
        for name in ("chaser.start_position", "shot.axis")
    }
    record = SimpleNamespace(
        **given, shot_roll=values["shot.roll"], axes=np.zeros(9), muzzle=np.zeros(3), scratch=np.zeros(9)
    )
    formula(aim)(record)  # type: ignore[no-untyped-call]
    return record.muzzle, record.axes.reshape(3, 3)


def net_drawing(values: Mapping[str, float], terms: Mapping[str, str]) -> Drawing | None:
    """Lines of threads and leads, and the closed rim of the net with these values, as numbers of nodes; None for none
    of ours."""
    part = _net(values, terms)
    if part is None:
        return None
    lines, rim = part.checks.drawing(values)
    added = (line for rig in rigged_of(terms).values() for line in rig.checks.lines(values, part.checks))
    return [*lines, *added], rim


def target_surface(values: Mapping[str, float], terms: Mapping[str, str]) -> Surface | None:
    """Corners (n, 3) [m] and faces of the target with these values, body axes; None for none of ours."""
    part = _part(TARGETS, terms.get("target"), values)
    return None if part is None else part.checks.surface(values)


def target_swing(values: Mapping[str, Any], terms: Mapping[str, str]) -> Callable[[float], Any] | None:
    """Function of the angle of its hinge [rad]: corners of the target (n, 3) [m], body axes; None of one rigid body."""
    return partial(corners_at, values) if "hinge" in terms and hinge.BODY in values else None


def target_at(values: Mapping[str, Any], terms: Mapping[str, str], angle: float) -> Mapping[str, Any]:
    """Values of the target with its hinge at an angle [rad], for what asks of its surface then; of one rigid body the
    same.

    Checked  tests/cosim/test_hinged_panel.py
    """
    if "hinge" not in terms or hinge.BODY not in values:
        return values
    return {**values, PIECES: pieces_at(values, angle)}


def target_hinge(values: Mapping[str, Any], terms: Mapping[str, str]) -> dict[str, Any] | None:
    """Which corners of the target swing, a point of the hinge's axis [m], its direction, and `lag`, the way from that
    point to the appendage's centre of mass at angle 0 times its share of the mass [m], body axes; None of one rigid
    body.

    Checked  tests/report/test_swing.py
    """
    if "hinge" not in terms or hinge.BODY not in values:
        return None
    table = values[hinge.BODY]
    return {
        "corners": swung(values),
        "hinge": table[hinge.HINGE : hinge.AXIS],
        "axis": table[hinge.AXIS : hinge.ARM],
        "lag": table[hinge.SHARE] * table[hinge.ARM : hinge.REST],
    }


def appendage_held(values: Mapping[str, Any], terms: Mapping[str, str], angle: float, rate: float) -> dict[str, float]:
    """A capture's hinged appendage at an angle [rad] and rate [rad/s] of its hinge, by the removal's names, places from
    the centre of mass of target and appendage; empty where none is known.

    Checked  tests/cosim/test_hinge_handed_over.py
    """
    if "hinge" not in terms or hinge.BODY not in values:
        return {}
    found, order = held_at(values, angle), ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    told = {"appendage.mass": found["mass"][0], "appendage.rate": rate}
    told |= {f"appendage.inertia[{k + 1}]": found["inertia"][place] for k, place in enumerate(order)}
    told |= {f"appendage.{name}[{i + 1}]": found[name][i] for name in ("center", "hinge", "axis") for i in range(3)}
    return {name: float(value) for name, value in told.items()}


def towed_surface(term: str) -> str:
    """The surface that a target of ours with this shape has where it is towed: its own, or that of a hull."""
    return term if term not in TARGETS or term in SURFACES else "hull"


def hull_corners(
    values: Mapping[str, Any], terms: Mapping[str, str], angle: float = 0.0
) -> tuple[dict[str, float], float]:
    """Corners of the hull that a target of ours is towed as, by the removal's names, body axes [m], and how far the
    target reaches beyond that hull at most [m]; none for one that is towed with its own surface.

    angle    of its hinge, where it has one [rad]
    """
    surface = target_surface(values, terms) if towed_surface(terms.get("target", "")) == "hull" else None
    if surface is None:
        return {}, 0.0
    swing = target_swing(values, terms)
    drawn = np.array(surface[0], dtype=float) if swing is None else swing(angle)
    corners, short = few_corners(drawn, CORNERS)
    filled = np.vstack([corners, np.repeat(corners[-1:], CORNERS - len(corners), axis=0)])
    names = ((f"target.corner_{axis}[{k + 1}]", k, i) for i, axis in enumerate("xyz") for k in range(CORNERS))
    return {name: float(filled[k, i]) for name, k, i in names}, short


def force_cells(values: Mapping[str, float], terms: Mapping[str, str]) -> list[list[float]] | None:
    """Middles of the cells of a force map in body axes [m], in the order of its outputs; None for a target that is none
    of ours."""
    part = _part(TARGETS, terms.get("target"), values)
    if part is None:
        return None
    return [force_map.centre_of(number, part.checks.half(values)) for number in range(force_map.NUMBER)]


def _net(values: Mapping[str, float], terms: Mapping[str, str]) -> Term | None:
    """The net of a scene, or of an FMU in a file; None for one that is none of ours."""
    return _part(NETS, terms.get("net"), values) if "net" in terms or "net.mesh" in values else None


def _part(parts: Mapping[str, Term], term: str | None, values: Mapping[str, float]) -> Term | None:
    """The part that a scene names; of a capture FMU in a file, which names none, that with the most parameters of its
    own among those all of whose own it has. What a part's tables hold such a file does not tell."""
    if term is not None:
        return parts[term]
    names = {
        key: {n for v in part.variables if v.causality == "parameter" for n in v.element_names()}
        for key, part in parts.items()
        if not part.tables
    }
    shared = set.intersection(*names.values())
    known = [key for key, wanted in names.items() if wanted - shared <= values.keys() and parts[key].lay is None]
    return parts[max(known, key=lambda key: len(names[key]))] if known else None


def masses_after(capture: Mapping[str, float], terms: Mapping[str, str]) -> dict[str, float]:
    """Masses of the pair [kg] that a capture of ours with these values hands over, by the removal's names."""
    from fmu_src.net_capture.implied import catch_mass

    if "target.mass" not in capture:
        return {}
    return {"chaser.mass": capture["chaser.mass"], "target.mass": capture["target.mass"] + catch_mass(capture, terms)}


def line_mass(removal: Mapping[str, float], terms: Mapping[str, str]) -> float:
    """Mass of the nodes of a tow's line [kg]; 0 of a massless one."""
    from fmu_src.tethered_deorbit.nodes.cost import cost

    return cost({"reel.length_offset": 0.0, **removal}).mass if "lumped" in terms else 0.0
