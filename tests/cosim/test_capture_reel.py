"""A reel's controller that pulls at the net's vertex during the capture: two FMUs, coupled by a scene."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from dcone_cosim.loading import find, load
from dcone_cosim.master import run_scene
from dcone_cosim.progress import Progress
from dcone_cosim.scene_fmus import SceneFmus

CONNECTED = """
connections = [
    "capture.tether.paid_out -> controller.length",
    "capture.tether.rate -> controller.length_rate",
    "controller.tension -> capture.tether.vertex_tension",
]

[capture.components.controller]
model = "reel_control"

[capture.components.controller.reel]
length = "2 m"

[capture.components.controller.gain]
proportional = "0.05 N/m"
derivative = "0.1 N s/m"

[capture.components.controller.parameters]
feed_forward = "0 N"
"""


def test_a_reel_control_brakes_the_net_from_a_scene(tmp_path: Path) -> None:
    """The mission's net, held back from 2 m on: tension is the law's, and net and chaser share its momentum."""
    text = find("mission").read_text()
    head, _, _ = text.partition("[removal]")
    begin = head.index("[capture.net]")
    connections, components = CONNECTED.split("\n\n", 1)
    scene = tmp_path / "held-back.toml"
    scene.write_text(head[:begin] + connections.strip() + "\n\n" + head[begin:] + components)
    settings = ['phases=["capture"]', "capture.duration=6 s", "capture.hand_over=none"]
    loaded = load(str(scene), settings)
    with SceneFmus(loaded, Progress()) as fmus:
        run = run_scene(loaded, fmus.instantiate, Progress())

    recorder = run.phases["capture"].recorder
    assert recorder["tether.work"][-1] < -0.3
    out, rate = recorder["tether.paid_out"], recorder["tether.rate"]
    assert np.trapezoid(rate, recorder["time"]) == pytest.approx(out[-1] - out[0], rel=5e-3)
    asked = np.maximum(0.0, 0.05 * (out - 2.0) + 0.1 * rate)
    gained = np.cumsum(asked) * (recorder["time"][1] - recorder["time"][0])
    # the reel's impulse: what the chaser has beyond its recoil, along the shot
    pulled = 2000.0 * (recorder["chaser.velocity[2]"] - recorder["chaser.velocity[2]"][0])
    assert pulled[-1] == pytest.approx(gained[-1], rel=0.03)
