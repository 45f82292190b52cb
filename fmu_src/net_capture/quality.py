"""Measures of a shot, of the nodes as shown: mouth, energies and momenta."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from fmu_src.net_capture.planes import MASS, SHOWN, SHOWN_BACK, SHOWN_RATE
from orbital.kernel import kernel

OPEN_ENOUGH = 0.8
"""Share of the flat net's area above which a mouth counts as open (t80, T80)."""


class Quality(NamedTuple):
    """Kernels of the measures.

    start_mouth(p)                     nothing measured yet
    mouth_area(p, work)                area of the polygon of the mouth's corners, on the plane normal to the shot [m2]
    watch_mouth(p, work, now, span)    follow the opening: largest area and when, first time above 80 %, time above
    mouth_depth(p, work)               mean distance of the corners from the muzzle along the shot [m]
    measure_mouth(p, work)             present area and depth
    measure_net(p, work)               mass properties, kinetic energy and momenta of net, bullets and vertex
    show_points(p, work)               bullets and vertex
    carry(p, work, ahead)              the positions shown by a time on, less than a substep [s]
    beyond(p, work, place)             how far the rearmost corner is beyond a point, along the shot [m]
    """

    start_mouth: Any
    mouth_area: Any
    watch_mouth: Any
    mouth_depth: Any
    measure_mouth: Any
    measure_net: Any
    show_points: Any
    carry: Any
    beyond: Any


@kernel
def start_mouth(p):
    """Nothing measured yet.

    Checked  tests/net_capture/test_quality.py
    """
    p.mouth_t80 = -1.0
    p.mouth_t_max = 0.0
    p.mouth_area_max = 0.0
    p.mouth_time_above_80 = 0.0


@kernel
def add_body_momenta(p, mass, place, velocity):
    """Add a body's linear and orbital angular momentum to the scene's.

    Checked  tests/net_capture/test_quality.py
    """
    p.momentum[0] += mass * velocity[0]
    p.momentum[1] += mass * velocity[1]
    p.momentum[2] += mass * velocity[2]
    p.angular_momentum[0] += mass * (place[1] * velocity[2] - place[2] * velocity[1])
    p.angular_momentum[1] += mass * (place[2] * velocity[0] - place[0] * velocity[2])
    p.angular_momentum[2] += mass * (place[0] * velocity[1] - place[1] * velocity[0])


def make_quality(composition: Any) -> Quality:
    """Kernels of the measures of the composition's net."""
    memory = composition.memory
    node_plane, rim, corners, apex = memory.node_plane, memory.rim, memory.corners, memory.apex
    bullets = memory.bullets

    @kernel
    def corner_node(p, work, corner):
        """Node of a corner of the mouth.

        Checked  tests/net_capture/test_quality.py
        """
        return rim(p, work)[corners(p, work)[corner]]

    @kernel
    def across(p, work, corner, axis):
        """Coordinate of a corner of the mouth along one of the shot's axes, from the frame's origin [m].

        Checked  tests/net_capture/test_quality.py
        """
        node = corner_node(p, work, corner)
        at = 0.0
        for i in range(3):
            at += node_plane(p, work, SHOWN + i)[node] * p.axes[3 * axis + i]
        return at

    @kernel
    def mouth_area(p, work):
        """By the shoelace formula.

        Checked  tests/net_capture/test_quality.py
        """
        twice = 0.0
        for i in range(p.net_corners):
            j = i + 1 if i + 1 < p.net_corners else 0
            twice += across(p, work, i, 0) * across(p, work, j, 1) - across(p, work, j, 0) * across(p, work, i, 1)
        return 0.5 * abs(twice)

    @kernel
    def corner_depth(p, work, corner):
        """How far a corner of the mouth is from the muzzle along the shot [m].

        Checked  tests/net_capture/test_quality.py
        """
        node = corner_node(p, work, corner)
        depth = 0.0
        for axis in range(3):
            depth += (node_plane(p, work, SHOWN + axis)[node] - p.muzzle[axis]) * p.axes[6 + axis]
        return depth

    @kernel
    def beyond(p, work, place):
        """How far the rearmost corner of the mouth is beyond a point, along the shot [m].

        Checked  tests/net_capture/test_quality.py
        """
        at = 0.0
        for axis in range(3):
            at += (place[axis] - p.muzzle[axis]) * p.axes[6 + axis]
        least = math.inf
        for corner in range(p.net_corners):
            least = min(least, corner_depth(p, work, corner))
        return least - at

    @kernel
    def watch_mouth(p, work, now, span):
        """Follow the opening: largest area [m2] and when [s], first time above 80 % and time above it [s].

        Checked  tests/net_capture/test_quality.py
        """
        area = mouth_area(p, work)
        if area > p.mouth_area_max:
            p.mouth_area_max = area
            p.mouth_t_max = now
        if area > OPEN_ENOUGH * p.mouth_flat_area:
            if p.mouth_t80 < 0.0:
                p.mouth_t80 = now
            p.mouth_time_above_80 += span

    @kernel
    def mouth_depth(p, work):
        """Mean distance of the corners from the muzzle along the shot [m].

        Checked  tests/net_capture/test_quality.py
        """
        depth = 0.0
        for corner in range(p.net_corners):
            depth += corner_depth(p, work, corner) / p.net_corners
        return depth

    @kernel
    def measure_mouth(p, work):
        """Present area [m2], its share of the flat mouth [1], and depth [m].

        Checked  tests/net_capture/test_quality.py
        """
        p.mouth_area = mouth_area(p, work)
        p.mouth_area_ratio = p.mouth_area / p.mouth_flat_area
        p.mouth_depth = mouth_depth(p, work)

    @kernel
    def measure_net(p, work):
        """Fills `momentum` and `angular_momentum` with the net's share.

        Checked  tests/net_capture/test_quality.py
        """
        mass = node_plane(p, work, MASS)
        total = 0.0
        kinetic = 0.0
        for i in range(3):
            p.catch_position[i] = 0.0
            p.catch_velocity[i] = 0.0
            p.catch_spin[i] = 0.0
        for i in range(6):
            p.catch_inertia[i] = 0.0
        for n in range(p.node_slots):
            m = 1.0 * mass[n]
            if m > 0.0:
                x = 1.0 * node_plane(p, work, SHOWN)[n]
                y = 1.0 * node_plane(p, work, SHOWN + 1)[n]
                z = 1.0 * node_plane(p, work, SHOWN + 2)[n]
                u = 1.0 * node_plane(p, work, SHOWN_RATE)[n]
                v = 1.0 * node_plane(p, work, SHOWN_RATE + 1)[n]
                w = 1.0 * node_plane(p, work, SHOWN_RATE + 2)[n]
                total += m
                kinetic += 0.5 * m * (u * u + v * v + w * w)
                p.catch_position[0] += m * x
                p.catch_position[1] += m * y
                p.catch_position[2] += m * z
                p.catch_velocity[0] += m * u
                p.catch_velocity[1] += m * v
                p.catch_velocity[2] += m * w
                p.catch_spin[0] += m * (y * w - z * v)
                p.catch_spin[1] += m * (z * u - x * w)
                p.catch_spin[2] += m * (x * v - y * u)
                p.catch_inertia[0] += m * (y * y + z * z)
                p.catch_inertia[1] += m * (z * z + x * x)
                p.catch_inertia[2] += m * (x * x + y * y)
                p.catch_inertia[3] -= m * x * y
                p.catch_inertia[4] -= m * x * z
                p.catch_inertia[5] -= m * y * z
        p.catch_mass = total
        p.energy_kinetic = kinetic
        for i in range(3):
            p.momentum[i] = p.catch_velocity[i]
            p.angular_momentum[i] = p.catch_spin[i]
            p.catch_position[i] /= total
            p.catch_velocity[i] /= total
        x = p.catch_position[0]
        y = p.catch_position[1]
        z = p.catch_position[2]
        p.catch_spin[0] -= y * p.momentum[2] - z * p.momentum[1]
        p.catch_spin[1] -= z * p.momentum[0] - x * p.momentum[2]
        p.catch_spin[2] -= x * p.momentum[1] - y * p.momentum[0]
        p.catch_inertia[0] -= total * (y * y + z * z)
        p.catch_inertia[1] -= total * (z * z + x * x)
        p.catch_inertia[2] -= total * (x * x + y * y)
        p.catch_inertia[3] += total * x * y
        p.catch_inertia[4] += total * x * z
        p.catch_inertia[5] += total * y * z

    @kernel
    def show_points(p, work):
        """Positions [m] and velocities [m/s] of bullets and vertex.

        Checked  tests/net_capture/test_quality.py
        """
        for corner in range(p.net_corners):
            node = bullets(p, work)[corner]
            for axis in range(3):
                p.bullet_position[corner, axis] = node_plane(p, work, SHOWN + axis)[node]
                p.bullet_velocity[corner, axis] = node_plane(p, work, SHOWN_RATE + axis)[node]
        for axis in range(3):
            p.vertex_position[axis] = 0.0
            p.vertex_velocity[axis] = 0.0
            for i in range(p.apex_nodes):
                node = apex(p, work)[i]
                p.vertex_position[axis] += node_plane(p, work, SHOWN + axis)[node] / p.apex_nodes
                p.vertex_velocity[axis] += node_plane(p, work, SHOWN_RATE + axis)[node] / p.apex_nodes

    @kernel
    def carry(p, work, ahead):
        """On the straight line that the next substep follows.

        Checked  tests/net_capture/test_quality.py
        """
        for axis in range(3):
            at = node_plane(p, work, SHOWN + axis)
            onward = node_plane(p, work, SHOWN_BACK + axis)
            for i in range(p.node_slots):
                at[i] += ahead * onward[i]

    return Quality(
        start_mouth, mouth_area, watch_mouth, mouth_depth, measure_mouth, measure_net, show_points, carry, beyond
    )
