"""The table of a hinged appendage: what kernels know of it besides the pieces of the target.

SI, in the body axes of the rest of the target, which are the principal axes of the whole at angle 0, from the centre of
mass of the whole at angle 0. Masses and moments are shares of the mass of the whole. Behind these numbers stand flags,
1 for what belongs to the appendage: from `PIECES` on of the pieces, from `SAMPLES` on of the sample points.
"""

from __future__ import annotations

BODY = "hinge.body"

SHARE, HINGE, AXIS, ARM, REST, REST_INERTIA, INERTIA = 0, 1, 4, 7, 10, 13, 22
"""Its share of the mass; a point of the axis, and its direction; from that point to its centre of mass; centre of mass
of the rest; inertia of the rest, and of the appendage at angle 0, each about its own centre of mass, by rows."""
LIMIT, YIELDS, REACH, HALF, RADIUS, GIRTH, GIRTH_ERROR = 31, 32, 33, 34, 37, 38, 39
"""Largest angle; what an impulse of 1 N s at a point of the surface gives it there at most, times the mass of the
whole; largest way of a point per radian of the hinge; half the edges of the box and radius of the sphere that hold the
target at any angle; least girth of any angle, and its error."""

MOST_PIECES = 24
"""Pieces of a target with a hinge: they are moved one by one at every substep."""
PIECES = 40
SAMPLES = PIECES + MOST_PIECES
