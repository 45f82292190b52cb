"""The tow of the next debris of a mission, as the first one's."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from dcone_cosim.phases.phase import Main
from dcone_cosim.phases.removal import Removal, TowOptions
from dcone_cosim.scene.expected import TEXT, Expected


class NextRemoval(Removal):
    name = "next_removal"
    follows = ("next_capture",)
    alone = False
    keys: Mapping[str, Expected] = {**Removal.keys, "like": Expected("1", TEXT)}
    tugs_file = "next_removal_tugs"
    figure_names = ("next_removal_orbital_radius.png", "next_removal_tether_tension.png")

    def options(self, found: Mapping[str, Any], main: Main | None) -> TowOptions:
        return super().options({key: value for key, value in found.items() if key != "like"}, main)


PHASE = NextRemoval()
