"""How the net lies in its canister, by the name a scene gives it."""

from __future__ import annotations

from typing import Any, NamedTuple


class Folding(NamedTuple):
    """Kernels of one folding.

    fold(p, work)     positions of all nodes at the start, from their places in the net as meant, which stand in the
                      planes shown
    """

    fold: Any


def foldings() -> dict[str, Any]:
    """Every folding's term, by name."""
    from fmu_src.net_capture.folding import flat

    return {"flat": flat.PART}
