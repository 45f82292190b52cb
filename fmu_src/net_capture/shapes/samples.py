"""A body of any shape from its tables: kernels of what `solids` has worked out, and of its sample points."""

from __future__ import annotations

from typing import Any

from fmu_src.net_capture.shapes import Shape
from fmu_src.rows import state
from fmu_src.tables import Table
from orbital.kernel import kernel

SAMPLES = 27
CUTS = 40
"""Halvings of the way that a sample point is led inward."""

TABLES = (
    Table("target.solid", "1", "moments per kg, turn, centre of mass, box, sphere, girth and least thickness"),
    Table("target.samples", "m", "points of the surface, and where each is led inward", dimensions=2),
)
ROWS = (
    state("sample_place[#][#]", "m", "sample points, so deep as they were last asked for", shape=(SAMPLES, 3)),
    state("sample_depth", "m", "that depth"),
    state("sample_normal[#]", "1", "outward normal at one of them", shape=(3,)),
)


def make_solid(composition: Any, distance: Any) -> Shape:
    """Kernels of a body of any shape.

    distance     kernel of `Shape`
    """
    solid_of, samples_of = composition.table("target.solid"), composition.table("target.samples")

    @kernel
    def measure(p):
        """The box and the sphere around it, its smallest girth and least thickness [m].

        Checked  tests/net_capture/test_pieces.py
        """
        solid = solid_of(p)
        for i in range(3):
            p.half_size[i] = solid[10 + i]
        p.envelope_radius = solid[13]
        p.girth = solid[14]
        p.sample_depth = -1.0
        p.target_thickness = solid[16]
        p.target_edge = solid[17]

    @kernel
    def inertia(p, out):
        """out = principal moments [kg m2], of the masses of its parts in proportion.

        Checked  tests/net_capture/test_pieces.py
        """
        solid = solid_of(p)
        for i in range(3):
            out[i] = p.target_mass * solid[i]

    @kernel
    def axes(p, out):
        """out = quaternion from body to design axes.

        Checked  tests/net_capture/test_pieces.py
        """
        solid = solid_of(p)
        for i in range(4):
            out[i] = solid[3 + i]

    @kernel
    def lead(p, out, number, depth):
        """out = the point on the way of a sample point that first lies so deep [m], its end where none does.

        Checked  tests/net_capture/test_pieces.py
        """
        rows = samples_of(p)
        low, high = 0.0, 1.0
        for i in range(3):
            out[i] = rows[number, 3 + i]
        if distance(p, p.sample_normal, out) <= -depth:
            for _ in range(CUTS):
                middle = 0.5 * (low + high)
                for i in range(3):
                    out[i] = rows[number, i] + middle * (rows[number, 3 + i] - rows[number, i])
                if distance(p, p.sample_normal, out) <= -depth:
                    high = middle
                else:
                    low = middle
            for i in range(3):
                out[i] = rows[number, i] + high * (rows[number, 3 + i] - rows[number, i])

    @kernel
    def sample(p, out, number, depth):
        """out = sample point [m], led inward from the surface; all of them are kept while the depth is the same.

        Checked  tests/net_capture/test_pieces.py
        """
        if p.sample_depth != depth:
            for k in range(SAMPLES):
                lead(p, out, k, depth)
                for i in range(3):
                    p.sample_place[k, i] = out[i]
            p.sample_depth = depth
        for i in range(3):
            out[i] = p.sample_place[number, i]

    return Shape(SAMPLES, measure, inertia, distance, sample, axes)
