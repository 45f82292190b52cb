"""Nets of one's own for tests: files of a net that is laid out, and one that no two threads of which are alike."""

from pathlib import Path

import numpy as np

from fmu_src.net_capture.nets.own_graph import NODES, THREADS
from fmu_src.net_capture.nets.written import ROLES, read_nodes, read_threads


def write(laid, folder: Path, count: int | None = None) -> dict[str, np.ndarray]:
    """Files of a net, with every bit: nodes in the order of the outputs, threads in that of their numbers, the first
    `count` of them. The tables that are read from them."""
    graph, number = laid.graph, laid.number
    ends = number[graph.ends[:count]] + 1
    last = int(ends.max())
    role = np.full(len(laid.slots), "", dtype="<U6")
    role[number[graph.rim]] = "mouth"
    role[number[graph.rim[graph.corners]]] = "corner"
    role[number[graph.apex]] = "vertex"
    rows = zip(laid.places[:last].tolist(), role[:last].tolist(), strict=True)
    nodes = [f"{k},{x!r},{y!r},{z!r},{its}" for k, ((x, y, z), its) in enumerate(rows, 1)]
    told = np.column_stack([graph.length, graph.stiffness, graph.mass, graph.damping])[:count].tolist()
    threads = [f"{a},{b},{','.join(map(repr, sizes))}" for (a, b), sizes in zip(ends.tolist(), told, strict=True)]
    return save(folder, nodes, threads, "length [m],stiffness [N/m],mass [kg],damping [N s/m]")


def save(folder: Path, nodes: list[str], threads: list[str], heads: str) -> dict[str, np.ndarray]:
    """Both files with their heads; the tables that are read from them."""
    paths = folder / "nodes.csv", folder / "threads.csv"
    paths[0].write_text("\n".join(["node,x [m],y [m],z [m],role", *nodes, ""]))
    paths[1].write_text("\n".join([f"from,to,{heads}", *threads, ""]))
    return {NODES: np.array(read_nodes(paths[0])), THREADS: np.array(read_threads(paths[1]))}


PLACES = ((-3, -2), (0, -2.4), (3, -2), (2.8, 0.3), (3, 2), (-0.2, 2.2), (-3, 2), (-2.9, 0.1), (0.1, 0.2), (1.2, -0.9))
ENDS = ((7, 0), (8, 1), (0, 1), (2, 1), (9, 8), (2, 3), (3, 4), (9, 2), (4, 5), (8, 5), (5, 6), (7, 6), (8, 7), (3, 9))
CORNERS, VERTEX = (0, 2, 4, 6), 8


def unlike(shuffle: int | None = None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Numbers of nodes and threads of ten knots in no order, and places (n, 3) [m]; no two threads are alike."""
    place = np.array([(x, y, -0.1 * (9 - x * x)) for x, y in PLACES])
    role = [ROLES.index("corner") if k in CORNERS else ROLES.index("mouth") * (k < 8) for k in range(len(PLACES))]
    role[VERTEX] = ROLES.index("vertex")
    nodes = [[k + 2, 10 + k, *at, its] for k, (at, its) in enumerate(zip(place.tolist(), role, strict=True))]
    threads = []
    for k, (a, b) in enumerate(ENDS):
        length = float(np.linalg.norm(place[a] - place[b])) * (1.0 + 0.01 * k)
        threads.append([k + 2, 10 + a, 10 + b, length, 0.0, 800.0 + 90.0 * k, 0.02 + 0.002 * k, 0.5 + 0.1 * k])
    order = np.arange(len(threads)) if shuffle is None else np.random.default_rng(shuffle).permutation(len(threads))
    return np.array(nodes), np.array(threads)[order], place
