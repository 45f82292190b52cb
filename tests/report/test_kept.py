"""What a run keeps for a replay: nothing unless it is asked, then every node and thread at an even rate."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from dcone_cosim.commands import run_and_write
from dcone_cosim.errors import InputError
from dcone_cosim.frames import Frames, suits
from dcone_cosim.loading import find, named
from dcone_cosim.progress import Progress
from dcone_cosim.replaying import replay_settings
from dcone_cosim.run_folder import tables_of
from dcone_cosim.run_reading import read_run
from dcone_cosim.scenes.reading import parse
from tests.runs import put, tables

SIDE = 7
"""Knots along a side of the coarse net."""
LENGTH, EA = 2.0, 70e9 * 0.84 / (1440.0 * 84 * 2.0)
"""Of a thread [m]; E A [N] of a net of 0.84 kg in 84 threads."""


def test_frames_are_where_the_snapshots_are(kept: Path) -> None:
    """Both read the same outputs, the snapshots in double precision."""
    frames, shots = (pd.read_parquet(kept / f"{name}.parquet") for name in ("replay_nodes", "nodes"))
    both = frames.merge(shots, on=["time", "node"], suffixes=("", "_shot"))
    assert len(both) > 30 * SIDE**2
    for i in (1, 2, 3):
        np.testing.assert_allclose(both[f"position[{i}]"], both[f"position[{i}]_shot"], rtol=6e-8, atol=1e-9)
    assert frames["position[1]"].dtype == np.float32


def test_they_come_at_an_even_rate_and_end_with_the_hand_over(kept: Path) -> None:
    times = pd.read_parquet(kept / "replay_nodes.parquet")["time"].unique()
    assert np.diff(times)[:-1] == pytest.approx(0.05)
    located = json.loads((kept / "provenance.json").read_text())["phases"]["capture"]["came_out"]["located"]["value"]
    assert times[-1] == located
    threads = pd.read_parquet(kept / "replay_threads.parquet")
    assert (threads["time"].unique() == times).all()


def test_threads_run_between_neighbours_and_pull_where_they_are_stretched(kept: Path) -> None:
    """A thread that is stretched bears k (L - L0), more or less by its dashpot; a slack one bears nothing."""
    threads = pd.read_parquet(kept / "replay_threads.parquet")
    nodes = pd.read_parquet(kept / "replay_nodes.parquet").set_index(["time", "node"])
    first = threads[threads["time"] == 0.0]
    a, b = first["node[1]"] - 1, first["node[2]"] - 1
    steps = set(zip((b // SIDE - a // SIDE).tolist(), (b % SIDE - a % SIDE).tolist(), strict=True))
    assert steps == {(0, 1), (1, 0)}
    assert len(first) == 2 * SIDE * (SIDE - 1)
    columns = [f"position[{i}]" for i in (1, 2, 3)]
    ends = [
        nodes.loc[pd.MultiIndex.from_frame(threads[["time", f"node[{i}]"]]), columns].to_numpy(float) for i in (1, 2)
    ]
    length = np.linalg.norm(ends[1] - ends[0], axis=1)
    tension = threads["tension"].to_numpy(float)
    assert not tension[length < LENGTH - 1e-5].any()
    assert (tension[length > LENGTH + 1e-5] > 0.0).mean() > 0.9, "a shortening one may be held at zero by its dashpot"
    taut = tension > 1.0
    elastic = EA / LENGTH * (length[taut] - LENGTH)
    assert np.median(tension[taut] / elastic) == pytest.approx(1.0, abs=0.15)
    peak = json.loads((kept / "summary.json").read_text())["capture"]["thread.tension_max"]["value"]
    assert 0.3 * peak < tension.max() <= peak * (1.0 + 1e-6)


def test_it_is_read_back_and_gone_on_from_with_the_same_bits(kept: Path, tmp_path: Path) -> None:
    again = dict(tables_of(read_run(kept)))
    written = tables(kept)
    assert {"replay_nodes", "replay_threads"} <= again.keys()
    on = put(kept, tmp_path / "on", go_on="capture:4 s")
    assert tables(on) == written


def test_nothing_of_it_is_there_unasked(bare: Path, kept: Path) -> None:
    assert not list(bare.glob("replay_*"))
    terms = [json.loads((run / "provenance.json").read_text())["phases"]["capture"]["terms"] for run in (bare, kept)]
    assert terms[1].pop("threads") == "84"
    assert terms[0] == terms[1]
    before, after = (pd.read_parquet(run / "removal.parquet") for run in (bare, kept))
    pd.testing.assert_frame_equal(before, after, check_exact=True)


def test_the_title_tells_no_change_where_none_was_made(bare: Path, kept: Path) -> None:
    assert read_run(kept).scene.title == read_run(bare).scene.title


def test_what_is_asked_follows_the_scene() -> None:
    scene = named("mission", ("capture.duration=9 s", "capture.macro_step=1 ms"))
    assert list(replay_settings(scene)) == ["capture.threads={}", "capture.replay_every=0.03 s"]
    assert list(replay_settings(named("table2-deorbit"))) == []
    bending = named("mission", ("capture.wrap={}",))
    assert list(replay_settings(bending)) == ["capture.replay_every=0.04 s"], "the tension of a bent thread is not told"
    with pytest.raises(InputError, match=r"capture\.wrap"):
        named("mission", ("capture.wrap={}", "capture.threads={}"))
    mine = named("mission", ("capture.threads.capacity=3000", "capture.replay_every=0.1 s"))
    assert list(replay_settings(mine)) == []
    assert (suits(30.0, 0.02), suits(1.5, 1e-3), suits(30.0, 0.5)) == (0.04, 0.005, 0.5)


def test_frames_keep_their_rhythm_whatever_the_steps() -> None:
    frames = Frames(0.1)
    taken = [time for time in np.arange(0, 1.0, 0.03) if frames.due(time)]
    assert taken == pytest.approx([0.0, 0.12, 0.21, 0.3, 0.42, 0.51, 0.6, 0.72, 0.81, 0.9])


def test_what_can_not_be_kept_is_refused(kept: Path) -> None:
    text = find("mission").read_text()
    without = text.replace("[capture.nodes]\ncapacity = 625\n", "")
    assert without != text
    with pytest.raises(InputError, match=r"capture\.replay_every.*needs the table \[capture\.nodes\]"):
        parse(without, "mine", "mine", settings=["capture.replay_every=0.1 s"])
    with pytest.raises(InputError, match=r"--replay: what a run goes on from"):
        run_and_write(str(kept), None, Progress(), go_on="removal", replay=True)
