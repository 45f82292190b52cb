"""What the master expects of the FMU of each phase, by variable name; anything that offers it can be swapped in."""

from __future__ import annotations

OUTCOMES = ("flying", "captured", "settled", "missed", "slipped_off", "not_closed", "tether_taut")
"""Meaning of the capture's Integer output `outcome`."""

FAILED_OUTCOMES = frozenset({"missed", "slipped_off", "not_closed", "tether_taut"})
"""Outcomes after which the capture phase ends without a hand-off."""

HAND_OVER = ("captured", "settled", "tether_taut", "none")
"""When the capture hands over: at capture, once the net is settled, or captured and the tether paid out; never."""

NEVER = "none"
"""Choice of `HAND_OVER` for a capture phase that is flown to its end, whatever becomes of the net."""

FLOWN = "flown"
"""Outcome of such a phase when its FMU has none to tell."""

CAPTURE_NEEDS = ("target", "closing")
"""Tables of a scene without which no capture can ever be reported."""

LINE = {"capture": "tether.length", "removal": "tether.rest_length"}
"""Length of the line in each phase: one and the same line."""

HANDED_OVER = "handed_over"
"""Name of the choice of `start.condition` under which the removal takes the state it is given."""

NODE_PREFIX = "node["
TUG_PREFIX = "tug["
TUG_FIELDS = ("time", "peak", "speed")
