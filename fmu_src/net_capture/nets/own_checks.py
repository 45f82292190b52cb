"""What a net of one's own says before any build or run, of the tables that stand among a scene's values."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from fmu_src.implied import formula
from fmu_src.net_capture.nets import LARGEST_MESH, USUAL_BULLETS, Checks, Hanging, Thread, Values
from fmu_src.net_capture.nets.own_graph import CLOSE, NODES, THREADS, NetError, own_graph
from fmu_src.net_capture.nets.own_tables import CORNER, EDGE, INSIDE, KIND, MASS_BY_AREA, OWN_MASS, kinds_of
from fmu_src.net_capture.nets.own_threads import of_kinds, plain_thread
from fmu_src.net_capture.refusal import Refusal, Scene

MOST_NODES = (LARGEST_MESH + 1) ** 2


def sound(values: Values) -> bool:
    """Whether the tables are there, and make a net."""
    if NODES not in values or THREADS not in values:
        return False
    try:
        own_graph(values)
    except NetError:
        return False
    return True


def _material(values: Values) -> tuple[float, float, float]:
    return values["net.youngs_modulus"], values["net.density"], values["net.damping_ratio"]


def _threads(values: Values) -> npt.NDArray[np.float64]:
    """Stiffness [N/m], dashpot [N s/m] and mass [kg] of every whole thread, (m, 3)."""
    graph = own_graph(values)
    rows = zip(graph.lengths.tolist(), graph.told.tolist(), strict=True)
    return np.array([plain_thread(length, *told, *_material(values)) for length, told in rows])


def _corner(values: Values) -> tuple[float, float]:
    """Of the bullet that is farthest from the axis."""
    graph = own_graph(values)
    at = np.abs(graph.places[graph.rim[graph.corners], :2])
    x, y = at[np.argmax(np.hypot(*at.T))].tolist()
    return x, y


def _knots(values: Values) -> int:
    graph = own_graph(values)
    return int(np.diff([*graph.corners, len(graph.rim)]).min()) - 1


def _thread(values: Values) -> Thread:
    graph, found = own_graph(values), _threads(values)
    diameters = graph.told[:, 0]
    stiffest, strengths = found[np.argmax(found[:, 0])], found[:, 0] * graph.lengths
    return Thread(
        0.25 * math.pi * float(diameters.min()) ** 2 if diameters.all() else None,
        float(strengths.min()),
        float(stiffest[0]),
        float(stiffest[1]),
        float(found[:, 2].min()),
        float(strengths.max()),
        float(found[:, 0].min()),
    )


def _hanging(values: Values) -> Hanging:
    kinds = kinds_of(own_graph(values))
    masses = kinds[:, OWN_MASS] + values["net.density"] * kinds[:, MASS_BY_AREA]
    at = {kind: masses[kinds[:, KIND] == kind] for kind in (INSIDE, EDGE, CORNER)}
    inside, edge, corner = (float(of.max(initial=0.0)) for of in at.values())
    return Hanging(inside, edge, corner, float(np.ptp(at[INSIDE])) <= CLOSE * inside if len(at[INSIDE]) else True)


def _nodes(values: Values) -> int:
    if not sound(values):
        return 1
    graph = own_graph(values)
    return len(graph.names) + (int(values["net.segments"]) - 1) * len(graph.ends)


def _piece(values: Values) -> tuple[float, float, float]:
    kinds = kinds_of(own_graph(values))
    found: tuple[float, float, float] = formula(of_kinds)(kinds, *_material(values), int(values["net.segments"]))
    return found


def _drawing(values: Values) -> tuple[list[list[int]], list[int]]:
    graph = own_graph(values)
    rim = graph.rim.tolist()
    return graph.ends.tolist(), [*rim, rim[0]]


def _uneven(values: Values) -> float:
    graph = own_graph(values)
    x, y, _ = graph.places[graph.rim[graph.corners]].T
    sector = 2.0 * math.pi / len(x)
    beside = np.unwrap(np.arctan2(y, x)) - sector * np.arange(len(x))
    return float(np.abs(beside - beside.mean()).max() / (0.5 * sector))


CHECKS = Checks(
    corner=_corner,
    widths=lambda values: (own_graph(values).width,) * 2,
    sides=lambda values: own_graph(values).sides,
    narrow=lambda values: NODES,
    knots=_knots,
    gap=lambda values: float(own_graph(values).gaps.min()),
    total=lambda values: float(own_graph(values).lengths.sum()),
    mass=lambda values: float(_threads(values)[:, 2].sum()),
    thread=_thread,
    piece=_piece,
    hanging=_hanging,
    finest=lambda values: (float(own_graph(values).lengths.min()), float(_threads(values)[:, 2].min())),
    nodes=_nodes,
    drawing=_drawing,
    turns=lambda values: [int(corner) for corner in own_graph(values).corners],
    bullets=lambda values: len(own_graph(values).corners) if sound(values) else USUAL_BULLETS,
    sound=sound,
    uneven=_uneven,
)


def refuses(scene: Scene) -> Iterator[Refusal]:
    """Files that make no net, and a net of more nodes than there may be."""
    try:
        own_graph(scene.values)
    except NetError as error:
        yield Refusal(error.table, "", error.text)
        return
    nodes = _nodes(scene.values)
    if nodes > MOST_NODES:
        segments = f"{scene.values['net.segments']:g}"
        yield Refusal("net.segments", segments, f"makes {nodes} nodes; at most {MOST_NODES}")
