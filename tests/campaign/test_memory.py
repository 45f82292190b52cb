"""A worker's memory over ten thousand cases."""

from __future__ import annotations

import resource
from pathlib import Path

import pytest

from dcone_cosim.campaign.shots import Shot, ground_of, run_shot
from dcone_cosim.loading import load
from tests.cases.conftest import put_scene

WARM, CASES = 500, 10_000


def resident() -> float:
    """Memory of this process that is in use [MB]."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize() / 1e6


@pytest.mark.evidence
def test_it_stays_flat(template: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """A kilobyte a case would be 10 MB."""
    ground = ground_of(load(str(put_scene(tmp_path / "scene", template))), None, ("removal.separation",))

    def run(number: int) -> None:
        velocity = f'removal.start.relative_velocity=["0 m/s", "{1e-3 + 1e-7 * number!r} m/s", "0 m/s"]'
        assert run_shot(Shot(str(number), number, (velocity,), ground)).succeeded

    for number in range(1, WARM):
        run(number)
    before = resident()
    for number in range(WARM, WARM + CASES):
        run(number)
    grown = resident() - before
    with capfd.disabled():
        print(f"\n{before:.0f} MB after {WARM} cases, {grown:+.2f} MB over {CASES} more")
    assert grown < 2.0
