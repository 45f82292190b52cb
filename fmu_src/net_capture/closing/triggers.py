"""What starts the reels, and the distance that one of the triggers goes by."""

from __future__ import annotations

from typing import Any

from fmu_src.net_capture.planes import SHOWN
from orbital.kernel import kernel

TRIGGERS = ("time", "first_contact", "distance", "command")
TRIGGER_TIME, TRIGGER_CONTACT, TRIGGER_DISTANCE = range(3)
WAYS = ("bullets_beyond_target", "vertex_to_target", "mouth_to_muzzle", "vertex_to_muzzle")
BEYOND_TARGET, VERTEX_TO_TARGET, MOUTH_TO_MUZZLE = range(3)


def make_reached(composition: Any, quality: Any) -> Any:
    """Kernel `reached(p, work)`: whether the distance of the trigger has been reached, of the nodes as shown.

        bullets_beyond_target   the rearmost bullet has come so far beyond the target's centre of mass, along the shot
        vertex_to_target        the vertex has come as near as this to the target's centre of mass
        mouth_to_muzzle         the bullets' mean has come so far from the muzzle, along the shot
        vertex_to_muzzle        the vertex has come so far from where the muzzle was at the shot

    Without a target the first two never are.

    Checked  tests/net_capture/test_triggers.py
    """
    has_target = composition.target is not None
    node_plane, apex = composition.memory.node_plane, composition.memory.apex
    beyond, mouth_depth = quality.beyond, quality.mouth_depth

    @kernel
    def vertex_squared(p, work, place):
        """Square of the vertex's distance from a point [m2].

        Checked  tests/net_capture/test_triggers.py
        """
        squared = 0.0
        for axis in range(3):
            at = -place[axis]
            for i in range(p.apex_nodes):
                at += node_plane(p, work, SHOWN + axis)[apex(p, work)[i]] / p.apex_nodes
            squared += at * at
        return squared

    @kernel
    def reached(p, work):
        """Whether the distance of the trigger has been reached.

        Checked  tests/net_capture/test_triggers.py
        """
        far = p.closing_distance
        if p.closing_measured == MOUTH_TO_MUZZLE:
            return mouth_depth(p, work) >= far
        if p.closing_measured > MOUTH_TO_MUZZLE:
            return vertex_squared(p, work, p.muzzle) >= far * far
        if has_target:
            if p.closing_measured == BEYOND_TARGET:
                return beyond(p, work, p.target_place) >= far
            return vertex_squared(p, work, p.target_place) <= far * far
        return False

    return reached
