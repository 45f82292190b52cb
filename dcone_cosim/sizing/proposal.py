"""Net, bullets, tether and shot for a debris, by the paper's scalings, and the scene that tests them.

The scene is `mission` made larger or smaller: lengths go with the net's side `a`, speeds with the shot's `v`, so times
with a/v, forces with m v^2/a. Each figure says from what it follows.

Checked  tests/sizing/test_proposal.py
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from dcone_cosim.sizing import budget
from dcone_cosim.sizing.debris import Debris
from orbital import netting, tethers
from orbital.materials import MATERIALS

SIDE, SPEED, ANGLE = 12.0, 3.0, math.radians(40.0)
"""Of `mission`: the net's side [m]; the bullets' speed [m/s] and angle [rad], of Table 1."""
KNOWN = 3.9
"""Greatest length up to which the paper has nets by length [m], Table 3; beyond, net and mesh grow together, so that
the shot stays similar and its threads bear the same. The paper's own net for 25 m is of 36 m, and leaves part of it
outside."""
CHASER = 2000.0
"""Mass of the chaser [kg], Table 2."""
LATER = 2.5
"""Speed of the hardest tug over that of the first [1]: tide and thrust bring the pair back faster than it parted. 1.6
in `mission` over six hours, 2.3 for 8 t on 93 m of line; the scene shows what it is."""
SAFETY = 2.0
"""On the highest tension [1], as by default in `dcone size SCENE`."""
LOCK_LENGTH = 0.25
"""Of a locked cord between two bullets [m], the model's default."""
STOCK = (1e-3, 1.5e-3, 2e-3, 2.5e-3, 3e-3, 4e-3, 5e-3, 6e-3, 8e-3, 10e-3, 12e-3, 16e-3, 20e-3)
"""Diameters of line that are proposed [m]; the least is Table 2's."""
LINE = MATERIALS["Kevlar 29"].braided()
THREAD = MATERIALS["Kevlar 29"]


@dataclass(frozen=True)
class Figure:
    """One figure of a proposal: SI value with its unit, shown in another, and from what it follows."""

    key: str
    name: str
    value: float
    unit: str
    shown_in: str
    why: str


@dataclass(frozen=True)
class Proposal:
    """What is proposed.

    side, mesh        of the net [m];  net, bullet   masses with the budget's margin, one of four bullets [kg]
    speed, angle      of the bullets [m/s], [rad];  distance   from muzzle to the debris's centre [m]
    line, diameter    length and diameter of the tether [m]
    tug               at which it comes taut, by its estimate [m/s];  peak   of that tug's tension [N]
    safety            factor of safety on that tension [1]
    """

    debris: Debris
    side: float
    mesh: float
    net: float
    bullet: float
    speed: float
    distance: float
    line: float
    diameter: float
    tug: float
    peak: float
    safety: float
    side_why: str

    @property
    def pace(self) -> float:
        """Times of its shot over those of `mission` [1]."""
        return self.side / SIDE * SPEED / self.speed

    @property
    def cells(self) -> int:
        return round(self.side / self.mesh)

    @property
    def rings(self) -> int:
        """On the mouth's edge between two bullets: so many that no loop lets the debris pass."""
        girth = 2.0 * (self.debris.size[1] + self.debris.size[2])
        return max(1, math.ceil((self.side + LOCK_LENGTH) / girth) - 1)

    def figures(self) -> list[Figure]:
        """All of it with reasons."""
        whole = f"the next whole number of {self.mesh:g} m meshes"
        margin = f"with the budget's margin of {100 * budget.MARGIN:g} %"
        mesh = (
            "the paper's, section 4"
            if self.mesh == budget.MESH
            else f"0.5 m x length / {KNOWN:g} m: similar to Table 3"
        )
        need = f"FoS {self.safety:g} on a tug of {LATER:g} x the first's speed, Kevlar 29 braid, at the fixed point; "
        return [
            Figure("net.side", "net, side", self.side, "m", "", f"{self.side_why}; {whole}"),
            Figure("net.mesh", "net, mesh", self.mesh, "m", "", mesh),
            Figure("net.mass", "net, mass", self.net, "kg", "", f"1 mm of aramid, {margin}"),
            Figure("bullets.mass", "bullets, each of four", self.bullet, "kg", "", "6:1 to the net, as in Table 1"),
            Figure("bullets.speed", "shot, speed", self.speed, "m/s", "", "Table 1"),
            Figure("bullets.angle", "shot, angle", ANGLE, "rad", "deg", "Table 1"),
            Figure("shot.distance", "shot, distance", self.distance, "m", "", "the net's side: it is open by then"),
            Figure(
                "closing.rings", "rings between two bullets", float(self.rings), "1", "", "loops less than the girth"
            ),
            Figure("tether.length", "tether, length", self.line, "m", "", "14/12 of the distance, as in `mission`"),
            Figure("tether.diameter", "tether, diameter", self.diameter, "m", "mm", f"{need}next in stock from 1 mm"),
            Figure(
                "tug.speed", "first tug, speed", self.tug, "m/s", "mm/s", "recoil of the shot, tide and thrust left out"
            ),
            Figure(
                "tug.peak", "hardest tug expected", self.peak, "N", "", f"{LATER:g} x that speed on this line, undamped"
            ),
        ]


def propose(debris: Debris, safety: float = SAFETY) -> Proposal:
    """Net, bullets, tether and shot for a debris; the tether with a factor of safety on the highest tension."""
    wanted, why = budget.side_of(debris.length), f"{budget.SIDE_OVER_LENGTH:g} x length, Table 3"
    mesh = round(budget.MESH * max(1.0, debris.length / KNOWN), 2)
    side = round(mesh * math.ceil(wanted / mesh - 1e-9), 2)
    net = netting.net_mass(side, side, mesh, THREAD.density, budget.THREAD, budget.MARGIN)
    bullet = budget.bullet_of(net)
    speed = SPEED
    line = 14.0 / 12.0 * side
    momentum = 4.0 * bullet * speed * math.cos(ANGLE)
    caught = debris.mass + net + 4.0 * bullet
    reduced = CHASER * caught / (CHASER + caught)
    tug = momentum / CHASER + momentum / caught
    assert LINE.strength is not None
    section = tethers.snap_section(LATER * tug, reduced, line, LINE.youngs_modulus, LINE.strength, safety)
    needed = tethers.diameter_of(section)
    diameter = next((size for size in STOCK if size >= needed), 1e-3 * math.ceil(1e3 * needed))
    peak = LATER * tug * math.sqrt(LINE.axial_stiffness(diameter) / line * reduced)
    return Proposal(debris, side, mesh, net, bullet, speed, side, line, diameter, tug, peak, safety, why)


def scene_text(proposal: Proposal) -> str:
    """The scene that tests a proposal."""
    p = proposal
    depth, width = p.debris.size[2], p.debris.size[1]
    scale, force = p.side / SIDE, (p.bullet / 1.27) * (p.speed / SPEED) ** 2 / (p.side / SIDE)
    drop = 0.006 * p.pace
    factor = "" if p.safety == SAFETY else f" --fos {p.safety:g}"
    return f'''# Proposed by `dcone size --debris "{p.debris.text}"{factor}`: the scene `mission` for this debris.
# Its own sizing: `dcone size` with this file. Change what you know better.
title = "Proposal: {p.debris.text} of debris is netted, handed over and towed"
phases = ["capture", "removal"]

[orbit]
altitude = "800 km"
inclination = "98 deg"

[capture]
macro_step = "{_time(0.02 * p.pace)}"
duration = "{_time(30.0 * p.pace)}"
hand_over = "captured"

[capture.net]
shape = "square"
side = "{p.side:.9g} m"
mesh = "{p.mesh:.9g} m"
mass = "{p.net:.4g} kg"
material = "{THREAD.name}"
damping_ratio = 0.106
fold_side = "{0.4 * scale:.3g} m"

[capture.gravity]
law = "hill"

[capture.bullets]
mass = "{p.bullet:.4g} kg"
speed = "{p.speed:.3g} m/s"
angle = "40 deg"

[capture.vertex]
mass = "{0.15 * p.net / 0.84:.3g} kg"

[capture.chaser]
mass = "{CHASER:g} kg"
start_position = ["0 m", "{-p.distance:.6g} m", "0 m"]

[capture.shot]
axis = [{-drop:.2g}, 1.0, 0.0] # a little low: on its way the Coriolis acceleration lifts the net

[capture.target]
shape = "box"
size = ["{p.debris.length:g} m", "{depth:g} m", "{width:g} m"] # its shortest side along the shot, its face to the net
mass = "{p.debris.mass:g} kg"

[capture.contact]
law = "inelastic"

[capture.closing]
drive = "winches"
trigger = "time"
time = "{6.4 * p.pace:.3g} s"
speed = "{5.0 * p.speed / SPEED:.3g} m/s"
stall_force = "{6.0 * force:.3g} N"
rings = {p.rings}
material = "nylon 66"
diameter = "0.5 mm"

[capture.tether]
state = "slack"
length = "{p.line:.4g} m"

[capture.nodes]
capacity = {(p.cells + 1) ** 2}

[removal]
macro_step = "10 s"
duration = "6 h"

[removal.reel]
law = "locked"

[removal.tether]
rest_length = "{p.line:.4g} m"
diameter = "{1e3 * p.diameter:g} mm"
material = "{LINE.name}"
form = "{LINE.form}"
damping_ratio = 0.05

[removal.thrust]
direction = "along_track"
level = "-0.01 N"
specific_impulse = "3000 s" # an ion engine

[sizing]
factor_of_safety = {p.safety:g}
'''


def _time(value: float) -> str:
    return f"{value:.3g} s"
