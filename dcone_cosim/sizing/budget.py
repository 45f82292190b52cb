"""The paper's mass budgets, Tables 3 and 4, rebuilt from scalings, each line beside the paper's figure.

    derived    follows from the debris and from figures that stand elsewhere in the paper; only these count
    fitted     a law whose parameters were found from the very figures it is held against: n of them on m figures
    taken      as the paper has it: nothing is known from which it would follow

Source   Benvenuto and Lavagna, section 4, Tables 1, 3 and 4; all masses with a margin of 20 %
Checked  tests/sizing/test_budget.py
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from orbital import netting
from orbital.materials import MATERIALS

DERIVED, FITTED, TAKEN = "derived", "fitted", "taken"
MARGIN = 0.2
"""Share that every mass of the tables has on top [1]."""
MESH, THREAD = 0.5, 1e-3
"""The paper's mesh, section 4, and the thread of Fig. 9's nets [m]."""
ARAMID = MATERIALS["Kevlar 29"]
SIDE_OVER_LENGTH = 3.126
"""Side of the net over the debris's greatest length [1]: of the net that weighs 0.3 kg for 2.3 m. The 1000 kg column
has no part in it."""
BULLETS_OVER_NET = 6.0
"""Mass of the four bullets over that of the net [1]: of Table 1, 4 x 0.5 kg on 0.33 kg, as a whole number."""


@dataclass(frozen=True)
class Column:
    """One debris of the paper and its budget, kg.

    length     its greatest [m]
    net, bullet, shooting, tether, sensors, total   `bullet` is one of four
    """

    table: str
    debris: float
    length: float
    net: float
    bullet: float
    shooting: float
    tether: float
    sensors: float
    total: float

    @property
    def name(self) -> str:
        return f"{self.table}, {self.debris:g} kg, {self.length:g} m"


PAPER = (
    Column("Table 3", 200.0, 2.3, 0.3, 0.45, 12.83, 2.4, 4.8, 22.13),
    Column("Table 3", 1000.0, 3.9, 0.84, 1.27, 13.09, 2.4, 4.8, 26.21),
    Column("Table 4", 8000.0, 25.0, 6.67, 10.0, 16.58, 2.7, 4.8, 70.75),
)
LARGE = (("36 x 36 m", 36.0, 36.0), ("30 x 26 m", 30.0, 26.0), ("18 x 18 m", 18.0, 18.0))
"""The configurations of Fig. 9 for the 8 t debris: name and sides [m]."""


@dataclass(frozen=True)
class Line:
    """One line of a budget.

    found, paper   mass here and in the paper [kg]
    kind           `DERIVED`, `FITTED` or `TAKEN`
    how            from what it follows
    """

    column: str
    name: str
    found: float
    paper: float
    kind: str
    how: str

    @property
    def difference(self) -> float:
        """Share by which it is more than the paper's [1]."""
        return self.found / self.paper - 1.0


def side_of(length: float) -> float:
    """Side of a square net for a debris of that greatest length [m]."""
    return SIDE_OVER_LENGTH * length


def net_of(length: float) -> float:
    """Mass of that net with its margin [kg]."""
    side = side_of(length)
    return netting.net_mass(side, side, MESH, ARAMID.density, THREAD, MARGIN)


def bullet_of(net: float) -> float:
    """Mass of one of four bullets for a net [kg]."""
    return BULLETS_OVER_NET * net / 4.0


def shooting_law() -> tuple[float, float]:
    """Intercept [kg] and slope [1] of the shooting mechanism's mass over that of all bullets, fitted to the paper's."""
    bullets = np.array([4.0 * column.bullet for column in PAPER])
    slope, intercept = np.polyfit(bullets, [column.shooting for column in PAPER], 1)
    return float(intercept), float(slope)


def lines(columns: Sequence[Column] = PAPER) -> list[Line]:
    """All lines of all columns, and under each column its sum."""
    return [line for column in columns for line in _column(column)]


def _column(column: Column) -> list[Line]:
    net, kind, how = _net(column)
    bullets = 4.0 * bullet_of(net)
    intercept, slope = shooting_law()
    law = f"{intercept:.2f} kg + {slope:.4f} x bullets; 2 parameters on {len(PAPER)} values"
    bullets_kind, bullets_how = DERIVED, f"{BULLETS_OVER_NET:g} x net, the ratio of Table 1"
    if column.table == "Table 4":
        bullets, bullets_kind, bullets_how = 4.0 * column.bullet, TAKEN, 'the paper sets it: "10 kg at 20 m/s"'
    found = [
        Line(column.name, "net", net, column.net, kind, how),
        Line(column.name, "bullets", bullets, 4.0 * column.bullet, bullets_kind, bullets_how),
        Line(column.name, "shooting and structure", intercept + slope * bullets, column.shooting, FITTED, law),
        Line(column.name, "tether 100 m, reel, control", column.tether, column.tether, TAKEN, "no scaling is known"),
        Line(column.name, "sensors and data", column.sensors, column.sensors, TAKEN, "the same for every debris"),
    ]
    kinds = ", ".join(f"{sum(line.kind == kind for line in found)} {kind}" for kind in (DERIVED, FITTED, TAKEN))
    total = Line(column.name, "total", sum(line.found for line in found), column.total, "sum", f"of {kinds}")
    return [*found, total]


def _net(column: Column) -> tuple[float, str, str]:
    """Mass of the net, and how it is known."""
    if column.table == "Table 4":
        how = f"bullets / {BULLETS_OVER_NET:g}: the paper sets the bullets, and the ratio of Table 1 gives the net"
        return 4.0 * column.bullet / BULLETS_OVER_NET, DERIVED, how
    of = f"{SIDE_OVER_LENGTH:g} x length, mesh {MESH:g} m, {1e3 * THREAD:g} mm of aramid, +{100 * MARGIN:g} %"
    if column is PAPER[0]:
        return net_of(column.length), FITTED, f"{of}; the factor is this value's: 1 parameter on 1 value"
    return net_of(column.length), DERIVED, f"{of}; the factor is that of 200 kg"


@dataclass(frozen=True)
class Allowed:
    """The mesh that Table 4's mass of the net allows one of Fig. 9's configurations [m], with and without margin."""

    name: str
    along: float
    across: float
    margined: float
    bare: float


def allowed(mass: float = PAPER[2].net) -> list[Allowed]:
    """The mesh of each configuration of Fig. 9 at that mass of the net [kg]."""
    found = []
    for name, along, across in LARGE:
        meshes = [netting.mesh_of_mass(along, across, mass, ARAMID.density, THREAD, g) for g in (MARGIN, 0.0)]
        found.append(Allowed(name, along, across, *meshes))
    return found
