"""The tether while the net is cast: slack, but a tension signal (a reel's) may be injected where it is made fast."""

import math

from fmu_src.net_capture.topology import FX, X, node_plane, vertex_node
from orbital.kernel import kernel
from orbital.vectors import dot


@kernel
def pull_vertex(p, work):
    """The tether's tension signal at the vertex, towards the chaser."""
    away = towards_chaser(p, work)
    if p.tether_vertex_tension != 0.0 and away > 0.0:
        for axis in range(3):
            share = 0.25 * p.tether_vertex_tension * p.scratch[axis] / away
            force = node_plane(p, work, FX + axis)
            for i in range(4):
                force[vertex_node(p.knots, i)] += share


@kernel
def towards_chaser(p, work):
    """Vector from the vertex to the chaser into scratch; returns its length [m]."""
    for axis in range(3):
        plane = node_plane(p, work, X + axis)
        at = 0.0
        for i in range(4):
            at += 0.25 * plane[vertex_node(p.knots, i)]
        p.scratch[axis] = p.chaser_place[axis] - at
    return math.sqrt(dot(p.scratch[0:3], p.scratch[0:3]))


@kernel
def change_of_speed(p, work, out, duration):
    """out = change [m/s] of the chaser's velocity under the tension signal over a duration [s]."""
    away = towards_chaser(p, work)
    for axis in range(3):
        pull = p.tether_vertex_tension * p.scratch[axis] / away if away > 0.0 else 0.0
        out[axis] = -duration * pull / p.chaser_mass


@kernel
def measure_tether(p):
    """Length paid out, from the measured positions."""
    squared = 0.0
    for axis in range(3):
        d = p.vertex_position[axis] - p.chaser_position[axis]
        squared += d * d
    p.tether_paid_out = math.sqrt(squared)
