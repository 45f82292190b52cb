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
def pull_chaser(p, work, out):
    """out = acceleration [m/s2] of the chaser under the tension signal."""
    away = towards_chaser(p, work)
    for axis in range(3):
        pull = p.tether_vertex_tension * p.scratch[axis] / away if away > 0.0 else 0.0
        out[axis] = -pull / p.chaser_mass


@kernel
def reel_in(p, work):
    """Book the work of the reel over the substep just taken: the tension times what the line has come in."""
    away = towards_chaser(p, work)
    p.tether_work += p.tether_vertex_tension * (p.tether_reach - away)
    p.tether_reach = away


@kernel
def measure_tether(p):
    """Length paid out, from the measured positions."""
    squared = 0.0
    for axis in range(3):
        d = p.vertex_position[axis] - p.chaser_position[axis]
        squared += d * d
    p.tether_paid_out = math.sqrt(squared)
