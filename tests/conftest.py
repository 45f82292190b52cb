"""Models shared by the tests: compiled once per process."""

from collections.abc import Callable, Mapping

import pytest

from fmu_src.instance import Instance
from fmu_src.interface import Value
from fmu_src.net_capture.interface import MODEL as NET

FREE = {"net": "square", "gravity": "none"}
CAPTURE = {
    "net": "square",
    "gravity": "none",
    "target": "box",
    "contact": "inelastic",
    "closing": "winches",
    "tether": "slack",
    "settling": "speed",
}
CAPTURE_HILL = {**CAPTURE, "gravity": "hill"}


@pytest.fixture
def shoot() -> Callable[..., Instance]:
    """Make and initialise a net: `shoot({"net.mesh": 2.0}, terms=FREE)`."""

    def make(parameters: Mapping[str, Value] | None = None, terms: Mapping[str, str] = FREE) -> Instance:
        return Instance(NET, terms, parameters).initialise()

    return make
