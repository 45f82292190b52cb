"""Measured tracks over simulated ones: the frame of the shot, curves between samples, errors by hand, bad files."""

from __future__ import annotations

import math
import re
from io import StringIO
from types import SimpleNamespace

import numpy as np
import pytest
from rich.console import Console

from dcone_cosim.errors import InputError
from dcone_cosim.tracks.comparing import compare, overall
from dcone_cosim.tracks.fitting import Estimate
from dcone_cosim.tracks.plot import draw
from dcone_cosim.tracks.reading import Track, read_tracks
from dcone_cosim.tracks.show import show
from dcone_cosim.tracks.simulated import Flown, at_instants

HEAD = "time,marker,x,y,z\n"
MUZZLE = (1.0, -20.0, 2.0)


def values(axis=(0.0, 1.0, 0.0), roll=0.0):
    named = {"chaser.start_position": MUZZLE, "shot.axis": axis}
    return {f"{n}[{i}]": x for n, v in named.items() for i, x in enumerate(v, 1)} | {"shot.roll": roll}


def flown(shots=(), nodes=(), **more):
    """Bullet 1 on x = 0, y = -20 + 3 t, z = t^3, and the vertex at rest at the muzzle; four samples a second."""
    t = np.arange(0.0, 2.01, 0.25)
    zero = np.zeros_like(t)
    columns = {"time": t}
    for name, place, rate in (
        ("bullet[1]", (zero + 1.0, -20.0 + 3.0 * t, 2.0 + t**3), (zero, zero + 3.0, 3.0 * t**2)),
        ("vertex", (zero + 1.0, zero - 20.0, zero + 2.0), (zero, zero, zero)),
    ):
        for axis in range(3):
            columns[f"{name}.position[{axis + 1}]"] = place[axis]
            columns[f"{name}.velocity[{axis + 1}]"] = rate[axis]
    return Flown(columns, shots, nodes, values(**more))


def track(marker, times, positions=None):
    times = np.asarray(times, dtype=float)
    return Track(marker, times, np.zeros((len(times), 3)) if positions is None else np.asarray(positions, dtype=float))


def test_positions_are_in_the_frame_of_the_shot():
    """z along the shot from the muzzle; x the orbital axis least along it; y = z cross x."""
    times = [0.1, 0.6, 1.9]
    found = at_instants(flown(), track("bullet 1", times))
    t = np.array(times)
    assert found == pytest.approx(np.column_stack([0.0 * t, -(t**3), 3.0 * t]), abs=1e-12)
    turned = at_instants(flown(roll=math.pi / 2), track("bullet 1", times))
    assert turned == pytest.approx(np.column_stack([-(t**3), 0.0 * t, 3.0 * t]), abs=1e-12)
    assert at_instants(flown(), track("vertex", [0.3])) == pytest.approx(np.zeros((1, 3)), abs=1e-12)


def test_what_a_straight_line_between_samples_would_err_by_is_seen():
    found = at_instants(flown(), track("bullet 1", [1.875]))[0, 1]
    straight = -0.5 * (1.75**3 + 2.0**3)
    assert found == pytest.approx(-(1.875**3), abs=1e-12)
    assert abs(straight - found) > 0.05


def test_errors_are_those_by_hand():
    off = [[0.0, 0.0, 0.0], [0.3, -1.0, 3.0 - 0.4]]
    one, beyond = compare(flown(), [track("bullet 1", [0.0, 1.0], off), track("vertex", [5.0])])
    row = one.told()
    assert one.errors == pytest.approx([0.0, 0.5])
    assert (row["rms"], row["largest"], row["largest_at"]) == pytest.approx((math.sqrt(0.125), 0.5, 1.0))
    assert (row["mean_x"], row["mean_z"]) == pytest.approx((-0.15, 0.2))
    assert beyond.told() == {"marker": "vertex", "compared": 0, "left_out": 1}
    assert overall([one]) == pytest.approx(math.sqrt(0.125))


def test_nodes_are_compared_at_snapshots_alone():
    nodes = [np.array([[1.0, -20.0, 2.0], [1.0, -19.0, 2.0]])] * 2
    found = compare(
        flown([0.5, 1.5], nodes), [track("node 2", [0.5, 1.0, 1.6], [[0, 0, 1.0], [9, 9, 9], [0, 0, 1.1]])]
    )[0]
    assert found.known.tolist() == [True, False, True]
    assert found.errors[found.known] == pytest.approx([0.0, 0.1])
    with pytest.raises(InputError, match="the net has 2 nodes"):
        compare(flown([0.5], nodes[:1]), [track("node 3", [0.5])])
    with pytest.raises(InputError, match="kept no nodes"):
        compare(flown(), [track("node 2", [0.5])])
    with pytest.raises(InputError, match=r"no bullet\[5\]"):
        compare(flown(), [track("bullet 5", [0.5])])
    with pytest.raises(InputError, match="no instant of the tracks can be compared: the capture lasts to 2 s"):
        compare(flown(), [track("vertex", [5.0])])


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("t,marker,x,y,z\n", r"line 1: .* expected the head time,marker,x,y,z"),
        (HEAD, "has no rows"),
        (HEAD + "0,bullet 1,0,0\n", "line 2: 4 values; expected 5"),
        (HEAD + "0,bullet 0,0,0,0\n", "marker = 'bullet 0'; expected bullet 1, node 25 or vertex"),
        (HEAD + "0,vertex,0,none,0\n", "line 2: y = 'none'; expected a number"),
        (HEAD + "0,vertex,0,nan,0\n", "line 2: y = 'nan'; expected a number"),
        (HEAD + "-1,vertex,0,0,0\n", "expected one since the shot"),
        (HEAD + "1,vertex,0,0,0\n1,vertex,0,0,1\n", "vertex stands twice at 1 s"),
    ],
)
def test_a_file_that_is_none_is_told(tmp_path, text, told):
    file = tmp_path / "tracks.csv"
    file.write_text(text)
    with pytest.raises(InputError, match=told):
        read_tracks(file)
    with pytest.raises(InputError, match="does not exist"):
        read_tracks(tmp_path / "none.csv")


def test_a_file_is_read_whatever_its_order(tmp_path):
    file = tmp_path / "tracks.csv"
    file.write_text(HEAD + "0.2, bullet 1, 1, 2, 3\n# a comment\n\n0.1,bullet 1,4,5,6\n0,vertex,7,8,9\n")
    first, second = read_tracks(file)
    assert (first.marker, first.kind, first.number) == ("bullet 1", "bullet", 1)
    assert first.times.tolist() == [0.1, 0.2]
    assert first.positions.tolist() == [[4, 5, 6], [1, 2, 3]]
    assert (second.marker, second.number) == ("vertex", 0)


def test_the_picture_is_drawn(tmp_path):
    found = compare(flown(), [track("bullet 1", [0.0, 1.0]), track("vertex", [0.5])])
    draw(found, "tracks", tmp_path / "tracks.png")
    assert (tmp_path / "tracks.png").stat().st_size > 10_000


def test_a_table_keeps_its_units():
    """Brackets are no markup to be taken out; a value that was fitted has its unit beside it."""
    found = [compare(flown(), [track("vertex", [0.3])])[0]]
    estimate = Estimate("bullets.speed", 2.0, 3.0, 2.9, 3.1)
    fit = SimpleNamespace(estimates=[estimate], before=0.1, after=0.01, scatter=0.001)
    content = {"values": {"bullets.speed": {"unit": "m/s"}}}
    console = Console(file=StringIO(), width=120)
    show(SimpleNamespace(found=found, fit=fit, content=content), console)
    told = console.file.getvalue()
    assert "rms [m]" in told
    assert "at [s]" in told
    assert re.search(r"bullets.speed .* 3.1 +m/s", told)
