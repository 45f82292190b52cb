"""Where the net pressed on the target, of a run whose folder has a table of it.

force_map.parquet    cell, position in body axes [m], impulse [N s], peak [N]; force_map.png is its picture
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from dcone_cosim.report import packing
from dcone_cosim.scenery import Array

TABLE, PICTURE = "force_map.parquet", "force_map.png"
TOLD = 6
"""Cells that are told in words."""
SHARE = 0.8
"""Of the distance to the nearest other cell, the edge of what is drawn of one [1]."""


@dataclass(frozen=True)
class ForceMap:
    """Cells of the target that bore anything.

    places    in body axes (n, 3) [m]
    impulse   in all (n,) [N s];  peak   largest force (n,) [N]
    size      edge of what is drawn of one [m]
    """

    places: Array
    impulse: Array
    peak: Array
    size: float

    @classmethod
    def read(cls, folder: Path) -> ForceMap | None:
        """Of the folder of a run; None where it has none, or nothing was borne.

        Checked  tests/report/test_forces.py
        """
        if not (folder / TABLE).is_file():
            return None
        import pyarrow.parquet

        table = pyarrow.parquet.read_table(folder / TABLE)
        places = np.column_stack([table[f"position[{i}]"].to_numpy() for i in (1, 2, 3)])
        impulse, peak = table["impulse"].to_numpy(), table["peak"].to_numpy()
        borne = peak > 0.0
        if not borne.any():
            return None
        apart = np.linalg.norm(places[None, :] - places[:1, None], axis=2)[0, 1:]
        return cls(places[borne], impulse[borne], peak[borne], SHARE * float(apart.min(initial=np.inf)))

    def packed(self) -> dict[str, Any]:
        """For `bodies.js`."""
        most = float(self.peak.max())
        return {"places": packing.singles(self.places), "peaks": packing.tensions(self.peak, most), "size": self.size}

    def hardest(self) -> list[dict[str, str]]:
        """Cells by their largest force."""
        return [
            {
                "place": ", ".join(f"{one:.3g}" for one in self.places[n]),
                "peak": f"{self.peak[n]:.4g}",
                "impulse": f"{self.impulse[n]:.4g}",
            }
            for n in np.argsort(-self.peak)[:TOLD]
        ]
