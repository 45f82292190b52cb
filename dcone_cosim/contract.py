"""What the master expects of the FMU of each phase, by variable name; anything that offers it can be swapped in."""

from __future__ import annotations

OUTCOMES = ("flying", "captured", "settled", "missed", "slipped_off", "not_closed", "tether_taut")
"""Meaning of the capture's Integer output `outcome`."""

FAILED_OUTCOMES = frozenset({"missed", "slipped_off", "not_closed", "tether_taut"})
"""Outcomes after which the capture phase ends without a hand-off."""

HAND_OVER = ("captured", "settled", "tether_taut")
"""When the capture hands over: at capture, once the net is settled, or captured and the tether paid out."""

HANDED_OVER = "handed_over"
"""Name of the choice of `start.condition` under which the removal takes the state it is given."""

NODE_PREFIX = "node["
TUG_PREFIX = "tug["
TUG_FIELDS = ("time", "peak", "speed")
