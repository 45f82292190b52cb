"""Nets by mesh and mass: held against threads that are counted one by one, and against the paper's figures."""

from __future__ import annotations

import math

import pytest

from orbital import netting

ARAMID = 1440.0


def counted(along: float, across: float, mesh: float) -> float:
    """Length of all threads of a net, laid one by one [m]."""
    columns, rows = round(along / mesh), round(across / mesh)
    pieces = [mesh for _ in range(rows + 1) for _ in range(columns)]
    pieces += [mesh for _ in range(columns + 1) for _ in range(rows)]
    return sum(pieces)


@pytest.mark.parametrize(("along", "across", "mesh"), [(24.0, 24.0, 1.0), (30.0, 26.0, 0.5), (36.0, 36.0, 0.25)])
def test_length_is_that_of_the_threads(along: float, across: float, mesh: float) -> None:
    assert netting.grid_length(along, across, mesh) == pytest.approx(counted(along, across, mesh), rel=1e-12)
    assert netting.grid_length(along, across, 1.01 * mesh) != pytest.approx(counted(along, across, mesh), rel=5e-3)


FIG_9 = {
    (36.0, 36.0): {0.1: 29.4, 0.25: 11.8, 0.5: 5.94, 1.0: 3.01},
    (30.0, 26.0): {0.1: 17.7, 0.25: 7.12, 0.5: 3.59, 1.0: 1.83},
    (18.0, 18.0): {0.1: 7.37, 0.25: 2.97, 0.5: 1.51, 1.0: 0.77},
}
"""Mass [kg] of the nets of Fig. 9 by mesh [m], 1 mm of aramid; computed apart from this program, to the digits told."""


@pytest.mark.parametrize("sides", FIG_9)
def test_fig_9(sides: tuple[float, float]) -> None:
    for mesh, mass in FIG_9[sides].items():
        found = netting.net_mass(*sides, mesh, ARAMID, 1e-3)
        assert found == pytest.approx(mass, rel=5e-3)
        assert found == pytest.approx(math.pi / 4.0 * 1e-6 * ARAMID * counted(*sides, mesh), rel=1e-3)


@pytest.mark.parametrize(
    ("sides", "bare", "margined"),
    [((36.0, 36.0), 0.445, 0.535), ((30.0, 26.0), 0.267, 0.321), ((18.0, 18.0), 0.111, 0.133)],
)  # fmt: skip
def test_mesh_that_table_4_allows(sides: tuple[float, float], bare: float, margined: float) -> None:
    for mesh, margin in ((bare, 0.0), (margined, 0.2)):
        found = netting.mesh_of_mass(*sides, 6.67, ARAMID, 1e-3, margin)
        assert found == pytest.approx(mesh, abs=6e-4)
        assert netting.net_mass(*sides, found, ARAMID, 1e-3, margin) == pytest.approx(6.67, rel=1e-12)


def test_a_mass_below_the_edge_is_no_net() -> None:
    with pytest.raises(ValueError, match="less than the edge"):
        netting.mesh_of_mass(36.0, 36.0, 0.08, ARAMID, 1e-3)
