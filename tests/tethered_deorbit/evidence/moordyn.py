"""MoorDyn beside the line of lumped nodes: a mass that swings on a line, and one that falls into it.

    python -m tests.tethered_deorbit.evidence.moordyn

writes `moordyn.json` again, in some ten seconds; it needs MoorDyn 2.7 (`pip install moordyn`), which the tests do not.
MoorDyn hangs the line from a fixed point in uniform gravity, without water, and lumps half a segment's mass onto either
end, which is taken off the mass there. Of each case are held: places of all nodes at the start, and then time, place of
the mass, and tension at the fixed end. A tow has uniform gravity where a chaser of 1e6 kg speeds up under its thrust.
"""

from __future__ import annotations

import json
import math
import tempfile
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

RESULT = Path(__file__).with_name("moordyn.json")
GRAVITY = 0.01
"""[m/s2]."""
LENGTH, DIAMETER, AXIAL, DENSITY, MASS, PIECES = 12.0, 1e-3, 2.0, 28800.0, 1.0, 5
"""Of line [m], [m], EA [N], [kg/m3], of the mass [kg]; segments."""
LINEAR = DENSITY * 0.25 * math.pi * DIAMETER**2
TOP = -100.0
CASES = {"swing": ((LENGTH * math.sin(1.0), -LENGTH * math.cos(1.0)), 120.0), "fall": ((1.0, -9.0), 40.0)}
"""Where the mass starts at rest, sideways and up from the fixed end [m], and for how long [s]."""
EVERY, STEP = 5.0, 1e-3
"""Between two rows, and of MoorDyn's RK4 [s]."""

DECK = """--------------------- MoorDyn Input File ------------------------------------
a mass on a line
----------------------- LINE TYPES ------------------------------------------
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
rope {diameter!r} {linear!r} {axial!r} 0 0 0 0 0 0
---------------------- POINTS --------------------------------
ID Attachment X Y Z Mass Volume CdA CA
(#) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Fixed 0 0 {top!r} 0 0 0 0
2 Free {x!r} 0 {z!r} {mass!r} 0 0 0
---------------------- LINES --------------------------------------
ID LineType AttachA AttachB UnstrLen NumSegs Outputs
(#) (name) (#) (#) (m) (-) (-)
1 rope 1 2 {length!r} {pieces} -
---------------------- OPTIONS -----------------------------------------
0 writeLog
{gravity!r} g
0 rho
300 WtrDpth
{step!r} dtM
rk4 tScheme
0 TmaxIC
------------------------- need this line --------------------------------------
"""


def run(name: str) -> dict[str, Any]:
    """One case by MoorDyn."""
    import moordyn

    (x, z), duration = CASES[name]
    values = {"diameter": DIAMETER, "linear": LINEAR, "axial": AXIAL, "length": LENGTH, "pieces": PIECES, "top": TOP}
    mass = MASS - 0.5 * LINEAR * LENGTH / PIECES
    text = DECK.format(**values, x=x, z=TOP + z, mass=mass, gravity=GRAVITY, step=STEP)
    with tempfile.TemporaryDirectory() as folder:
        deck = Path(folder, "deck.txt")
        deck.write_text(text, encoding="utf-8")
        system = moordyn.Create(str(deck))
        moordyn.Init(system, [], [])
        line = moordyn.GetLine(system, 1)
        start = [list(moordyn.GetLineNodePos(line, k)) for k in range(PIECES + 1)]
        rows = []
        for k in range(1, round(duration / EVERY) + 1):
            moordyn.Step(system, [], [], (k - 1) * EVERY, EVERY)
            place = moordyn.GetLineNodePos(line, PIECES)
            pull = float(np.linalg.norm(moordyn.GetLineNodeTen(line, 0)))
            rows.append([k * EVERY, place[0], place[2] - TOP, pull])
        moordyn.Close(system)
    return {"start": [[p[0], p[2] - TOP] for p in start], "rows": rows}


def main() -> None:
    found = {name: run(name) for name in CASES}
    stored = {"moordyn": version("moordyn"), **found}
    RESULT.write_text(json.dumps(stored, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
