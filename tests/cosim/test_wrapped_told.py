"""A tether that lay round the target is told in the summary: how much of it, and from when on."""

import numpy as np

from dcone_cosim.phases.removal_report import of_wrapping


def told(*wrapped: float) -> dict[str, object]:
    rows = np.array(wrapped)
    return {finding.key: finding.value for finding in of_wrapping("removal", 5.0 * np.arange(len(rows)), rows)}


def test_how_much_and_from_when_on() -> None:
    assert told(0.0, 0.0, 1.5, 2.25, 0.0, 0.5) == {"wrapped": 2.25, "wrapped_after": 10.0}
    assert told(0.75, 0.0) == {"wrapped": 0.75, "wrapped_after": 0.0}


def test_one_that_never_did() -> None:
    assert told(0.0, 0.0) == {"wrapped": 0.0}
