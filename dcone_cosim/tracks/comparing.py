"""Measured tracks beside simulated ones: how far each marker is off, and when."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dcone_cosim.errors import InputError
from dcone_cosim.tracks.reading import Array, Track
from dcone_cosim.tracks.simulated import Flown, at_instants


@dataclass(frozen=True)
class Compared:
    """One marker.

    simulated    where it was at the track's instants, NaN where the run does not tell, (n, 3) [m]
    """

    track: Track
    simulated: Array

    @property
    def known(self) -> Any:
        """Which instants can be compared."""
        return np.isfinite(self.simulated).all(axis=1)

    @property
    def errors(self) -> Array:
        """Distance of simulated from measured at each instant [m]."""
        return np.asarray(np.linalg.norm(self.simulated - self.track.positions, axis=1))

    @property
    def rms(self) -> float:
        """Root of the mean squared distance [m]; NaN where nothing can be compared."""
        errors = self.errors[self.known]
        return float(np.sqrt(np.mean(errors**2))) if len(errors) else float("nan")

    def told(self) -> dict[str, Any]:
        """Its row of the table."""
        errors, known = self.errors, self.known
        row: dict[str, Any] = {
            "marker": self.track.marker,
            "compared": int(known.sum()),
            "left_out": int((~known).sum()),
        }
        if known.any():
            worst = int(np.nanargmax(errors))
            mean = (self.simulated - self.track.positions)[known].mean(axis=0)
            row |= {"rms": self.rms, "largest": float(errors[worst]), "largest_at": float(self.track.times[worst])}
            row |= {f"mean_{axis}": float(value) for axis, value in zip("xyz", mean, strict=True)}
        return row


def compare(flown: Flown, tracks: Sequence[Track]) -> list[Compared]:
    """Every marker; `InputError` if none can be compared at any instant."""
    found = [Compared(track, at_instants(flown, track)) for track in tracks]
    if not any(one.known.any() for one in found):
        last = float(flown.columns["time"][-1])
        raise InputError(
            f"no instant of the tracks can be compared: the capture lasts to {last:g} s, and nodes are known at its "
            f"{len(flown.shots)} snapshots alone (capture.snapshots sets their instants)"
        )
    return found


def overall(found: Sequence[Compared]) -> float:
    """Root of the mean squared distance of all markers at all instants [m]."""
    errors = np.concatenate([one.errors[one.known] for one in found])
    return float(np.sqrt(np.mean(errors**2)))
