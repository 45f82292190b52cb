"""Shapes of the target, by the name a scene gives them: each an entry in this table.

A shape is given in body axes, from the centre of mass. Inside a kernel it reads its sizes from the record; before any
build or run it says the same of a scene's values.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

Values = Mapping[str, Any]
Point = Sequence[float]


class Hulls(NamedTuple):
    """Convex bodies of which a shape with hollows is made: kernels that read tables, see `hulls`.

    bodies(p)     rows of `hulls.BODY`
    planes(p)     faces of all bodies (n, 5): way out and distance along it [1], [m], 1 where it lies in other bodies
    """

    bodies: Any
    planes: Any


class Shape(NamedTuple):
    """Kernels of one shape.

    samples                         how many sample points it has
    measure(p)                      its box and sphere, `half_size` and `envelope_radius`, and its smallest girth [m]
    inertia(p, out)                 principal moments of a uniform body [kg m2], (3,)
    distance(p, normal, point)      signed distance from its surface [m], negative inside; outward normal into `normal`
    sample(p, out, number, depth)   out = a sample point so far below the surface [m]
    axes(p, out)                    quaternion from the body axes, which are principal, to those in which its attitude
                                    and rate are given at the start; None: the same
    faces(p, out)                   the faces of a convex polyhedron that is the shape or lies close within it: way out
                                    and distance along it into the rows of `out` (n, 4) [1], [m]; how many. None: it
                                    has hollows
    hulls                           the convex bodies of which a shape with hollows is made, where threads bend;
                                    None: none
    swings(p)                       whether the point of the surface found last belongs to an appendage that swings
    close_round(half, rows)         half the edges of the box that holds pieces some of which swing, as they are now [m]
    """

    samples: int
    measure: Any
    inertia: Any
    distance: Any
    sample: Any
    axes: Any = None
    faces: Any = None
    hulls: Hulls | None = None
    swings: Any = None
    close_round: Any = None


class Checks(NamedTuple):
    """What a shape says of a scene's values, by FMI name [SI]; tables of its part are among them.

    half(values)              half the edges of the box around it [m], (3,)
    radius(values)            of the sphere around it [m]
    girth(values)             the shortest closed cord that can be passed over it [m]
    distance(values, point)   from its surface, negative inside [m]
    surface(values)           corners [m] (n, 3) and faces, as numbers of their corners, to draw it by
    turn(values)              `axes` of `Shape`; None: the same
    """

    half: Callable[[Values], list[float]]
    radius: Callable[[Values], float]
    girth: Callable[[Values], float]
    distance: Callable[[Values, Point], float]
    surface: Callable[[Values], tuple[list[Point], list[list[int]]]]
    turn: Callable[[Values], list[float]] | None = None


def shapes() -> dict[str, Any]:
    """The term of a free target of every shape, by name."""
    from fmu_src.net_capture.shapes import box, cylinder, frustum, mesh, sphere, union
    from fmu_src.net_capture.target import free_body

    parts = {
        "box": box.PART,
        "cylinder": cylinder.PART,
        "sphere": sphere.PART,
        "frustum": frustum.PART,
        "union": union.PART,
        "mesh": mesh.PART,
    }
    return {name: free_body(name, part) for name, part in parts.items()}
