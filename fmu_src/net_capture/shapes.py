"""Surfaces a net can touch: signed distance and outward normal at a point given in body axes."""

import math

from orbital.kernel import kernel


@kernel
def box_distance(normal, point, half):
    """Signed distance [m] of a point from the surface of a box, negative inside; its outward normal goes into `normal`.

    Outside, the nearest point of the box is found by clamping each coordinate; inside, the nearest face.

    point        in body axes, from the centre   [m]  (3,)
    half         half the edges                  [m]  (3,)
    normal       unit vector, body axes          [1]  (3,)

    Valid    any point; on an edge seen from inside the first of the nearest faces is taken
    Checked  tests/net_capture/test_contact.py
    """
    outside = 0.0
    deepest = -math.inf
    face = 0
    for i in range(3):
        beyond = abs(point[i]) - half[i]
        if beyond > deepest:
            deepest = beyond
            face = i
        reach = beyond if beyond > 0.0 else 0.0
        normal[i] = reach if point[i] >= 0.0 else -reach
        outside += reach * reach
    if outside > 0.0:
        distance = math.sqrt(outside)
        for i in range(3):
            normal[i] /= distance
        return distance
    for i in range(3):
        normal[i] = 0.0
    normal[face] = 1.0 if point[face] >= 0.0 else -1.0
    return deepest


@kernel
def box_radius(half):
    """Radius [m] of the sphere that encloses a box: the envelope of the contact search."""
    return math.sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2])


@kernel
def box_girth(size):
    """Smallest girth [m] of a box: the shortest closed cord that can be passed over it.

        2 (a + b)  with a, b the two shorter edges

    Checked  tests/net_capture/test_contact.py (16 m for 4 x 8 x 4 m)
    """
    longest = max(size[0], max(size[1], size[2]))
    return 2.0 * (size[0] + size[1] + size[2] - longest)


BOX_SAMPLES = 27
"""Sample points of a box: its centre, the middles of its faces and edges, and its corners."""


@kernel
def box_sample(point, half, number):
    """point = sample point `number` of a box, of the grid of three by three by three points, the first axis fastest.

    point        in body axes, from the centre   [m]  (3,)
    half         half the edges                  [m]  (3,)
    number       0 to 26; 13 is the centre       [1]

    Checked  tests/net_capture/test_enclosure.py
    """
    for i in range(3):
        point[i] = (number % 3 - 1) * half[i]
        number //= 3
