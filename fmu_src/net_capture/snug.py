"""A net too small to be drawn together behind its target: when it holds it all the same.

Once the cord still out is shorter than the target's smallest girth, no way of turning the target takes it out of the
mouth. A net of area N can come to that only if it covers what the mouth leaves of the target's surface S,

    N >= S - P^2 / 4 pi,   P the girth

A smaller one may still lie round the target like a lid round a box: its mouth is behind the target, and as the target
lies it would have to pass by its outline as seen along the shot. The perimeter of a box's is

    P = 4 sum a_i sqrt(1 - n_i^2),   a_i half its edges, n the shot's axis in the box's axes

In a net that lies close the target cannot turn to where its outline is less; that it does not, the share of it that is
inside and a test by pulling (`pull_off.py`) have to show.

Valid    boxes
Source   ours; a projection of a box is a zonogon of its three edges
Checked  tests/net_capture/test_snug.py
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from fmu_src.interface import Term
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.rows import output, state
from orbital.kernel import kernel
from orbital.rotations import rotate_inverse

SHAPE = "box"


@kernel
def outline(p):
    """Perimeter of the box's outline as seen along the shot [m].

    Checked  tests/net_capture/test_snug.py
    """
    rotate_inverse(p.snug_axis, p.target_pose, p.axes[6:9])
    total = 0.0
    for i in range(3):
        total += 4.0 * p.half_size[i] * math.sqrt(max(1.0 - p.snug_axis[i] * p.snug_axis[i], 0.0))
    p.snug_outline = total
    return total


def refuses(scene: Scene) -> Iterator[Refusal]:
    """A target whose outline is not known."""
    if scene.terms["target"] != SHAPE:
        expected = f'must be "{SHAPE}": [capture.snug] knows the outline of no other'
        yield Refusal("target.shape", f'"{scene.terms["target"]}"', expected)


def make(composition: Any) -> Any:
    """Kernel `outline(p)` of the composition's target; ValueError for one that is no box."""
    if composition.terms["target"] != SHAPE:
        raise ValueError(f"the outline of a {composition.terms['target']} is not known")
    return outline


PART = Term(
    "a target counts as caught once the cord is shorter than its outline along the shot, in place of its girth",
    (
        output("snug.outline", "m", "perimeter of the target's outline as seen along the shot, while it is not caught"),
        state("snug_axis[#]", "1", "axis of the shot, body axes", shape=(3,)),
    ),
    needs=("target", "contact", "closing"),
    make=make,
    refuses=refuses,
)
