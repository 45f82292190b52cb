"""Aim and fold: the axes of the shot, where every node starts, and with which velocity.

The net is folded flat into a small square normal to the shot, so no thread is longer than its rest length. Bullets
leave along the diagonals, at an angle from the shot axis; the rest is at rest in the canister, which moves with the
chaser.
"""

import math

from fmu_src.net_capture.interface import NO_AXIS
from fmu_src.net_capture.topology import U, V, W, X, Y, Z, bullet_node, node_plane
from orbital.kernel import kernel
from orbital.vectors import dot


@kernel
def aim(p):
    """Shot axes as rows, and the muzzle; a fault code or 0."""
    axis = p.axes[6:9]
    for i in range(3):
        p.muzzle[i] = p.chaser_start_position[i]
        axis[i] = p.shot_axis[i]
    if dot(axis, axis) == 0.0:
        for i in range(3):
            axis[i] = -p.chaser_start_position[i]
    length = math.sqrt(dot(axis, axis))
    if length == 0.0:
        return NO_AXIS
    for i in range(3):
        axis[i] /= length
    # first transverse axis: the orbital axis least along the shot, made normal to it
    least = 0
    for i in range(3):
        if abs(axis[i]) < abs(axis[least]):
            least = i
    share = axis[least]
    first = p.scratch[0:3]
    for i in range(3):
        first[i] = (1.0 if i == least else 0.0) - share * axis[i]
    length = math.sqrt(dot(first, first))
    for i in range(3):
        first[i] /= length
    second = p.scratch[3:6]
    second[0] = axis[1] * first[2] - axis[2] * first[1]
    second[1] = axis[2] * first[0] - axis[0] * first[2]
    second[2] = axis[0] * first[1] - axis[1] * first[0]
    c = math.cos(p.shot_roll)
    s = math.sin(p.shot_roll)
    for i in range(3):
        p.axes[i] = c * first[i] + s * second[i]
        p.axes[3 + i] = c * second[i] - s * first[i]
    return 0


@kernel
def place(p, work, node, along_row, along_column):
    """Put a node into the folded square; coordinates from -1/2 to 1/2 of its side."""
    a = p.net_fold_side * along_column
    b = p.net_fold_side * along_row
    node_plane(p, work, X)[node] = p.muzzle[0] + a * p.axes[0] + b * p.axes[3]
    node_plane(p, work, Y)[node] = p.muzzle[1] + a * p.axes[1] + b * p.axes[4]
    node_plane(p, work, Z)[node] = p.muzzle[2] + a * p.axes[2] + b * p.axes[5]
    node_plane(p, work, U)[node] = p.chaser_start_velocity[0]
    node_plane(p, work, V)[node] = p.chaser_start_velocity[1]
    node_plane(p, work, W)[node] = p.chaser_start_velocity[2]


@kernel
def fold_flat(p, work):
    """Lay all nodes evenly into a square of side `net.fold_side`."""
    knots = p.knots
    segments = p.net_segments
    step = 1.0 / (knots - 1)
    square = knots * knots
    for i in range(knots):
        for j in range(knots):
            node = i * knots + j
            row = i * step - 0.5
            column = j * step - 0.5
            place(p, work, node, row, column)
            for s in range(1, segments):
                offset = s * step / segments
                inner = square + (s - 1) * square + node
                place(p, work, inner, row, column + offset if j < knots - 1 else column)
                if i < knots - 1:
                    inner = square + (segments - 1) * square + (s - 1) * (square - knots) + node
                    place(p, work, inner, row + offset, column)


@kernel
def jitter(p, work):
    """Move every node a little, by a small linear congruential generator: the same seed gives the same net.

    Source   multiplier and increment of Knuth's MMIX (The Art of Computer Programming, vol. 2, sec. 3.3.4, table 1),
             modulo 2^63 in signed arithmetic
    """
    state = p.solver_seed * 2 + 1
    for axis in range(3):
        positions = node_plane(p, work, X + axis)
        amplitude = p.solver_jitter[axis]
        if amplitude != 0.0:
            for i in range(positions.size):
                state = (state * 6364136223846793005 + 1442695040888963407) & 0x7FFFFFFFFFFFFFFF
                positions[i] += amplitude * (2.0 * ((state >> 10) / 9007199254740992.0) - 1.0)


@kernel
def shoot(p, work):
    """Give the bullets their velocity; return nothing, the recoil is the model's business."""
    forward = p.bullets_speed * math.cos(p.bullets_angle)
    outward = p.bullets_speed * math.sin(p.bullets_angle) * math.sqrt(0.5)
    for corner in range(4):
        node = bullet_node(p.knots, corner)
        along_row = -outward if corner < 2 else outward
        along_column = -outward if corner == 0 or corner == 3 else outward
        for axis in range(3):
            node_plane(p, work, U + axis)[node] += (
                forward * p.axes[6 + axis] + along_column * p.axes[axis] + along_row * p.axes[3 + axis]
            )
