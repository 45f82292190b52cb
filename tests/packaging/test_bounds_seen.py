"""What compiles our kernels with numba's check of every index sees what lies beyond a row, however it is reached."""

from __future__ import annotations

import json

import pytest

from tests.packaging import checked

CODE = """
import json
import sys

import numpy as np

from fmu_src.lanes import of, peek, poke, whole
from orbital.kernel import entry, kernel, view

DTYPE = np.dtype([("row", "<f8", (3,)), ("grid", "<f8", (2, 3)), ("behind", "<f8")])
double, single = of("double"), of("single")
load, store, splat, lane, singles = double.load, double.store, double.splat, double.lane, single.reals
load_single, store_single, splat_single, lane_single = single.load, single.store, single.splat, single.lane


@view
def middle(work):
    return work[2:10]


@kernel
def fill(row, count):
    for k in range(count):
        row[k] = 1.0


@entry(DTYPE)
def reach(command, records, work, time, step):
    p, last = records[0], int(time)
    if command == 0:  # a row of the record, handed to a kernel
        fill(p.row, last + 1)
    elif command == 1:  # two indices
        p.grid[1, last] = 1.0
    elif command == 2:  # a row of a grid
        fill(p.grid[0], last + 1)
    elif command == 3:  # a slice of the work memory, behind which it goes on
        middle(work)[last + 5] = 1.0
    elif command == 4:  # the same as whole numbers
        whole(middle(work))[last + 5] = 1
    elif command == 5:  # without the test for an index that counts from the end
        poke(middle(work), last + 5, 1.0)
    elif command == 6:
        p.behind = peek(middle(work), last + 5)
    elif command == 7:  # four numbers at once
        store(middle(work), last + 2, splat(1.0))
    elif command == 8:
        p.behind = lane(load(middle(work), last + 2), 0)
    elif command == 9:  # eight of single precision
        store_single(singles(middle(work)), last + 6, splat_single(1.0))
    elif command == 10:
        p.behind = lane_single(load_single(singles(middle(work)), last + 6), 0)
    elif command == 11:  # from the end
        p.row[2 - last] = 1.0
    elif command == 12:
        p.behind = p.grid[1, 2 - last]
    return 0


seen = []
for command in range(13):
    for last in (2.0, 3.0):
        try:
            reach(command, np.zeros(1, DTYPE), np.zeros(16), last, 0.0)
            seen.append(False)
        except IndexError:
            seen.append(True)
print(json.dumps(seen))
"""
"""Every way in which a kernel reaches memory: up to the last number there is, and one beyond."""


@pytest.fixture(scope="module")
def seen(tmp_path_factory: pytest.TempPathFactory) -> list[bool]:
    done = checked.run(tmp_path_factory.mktemp("kept"), CODE)
    assert done.returncode == 0, done.stderr
    found: list[bool] = json.loads(done.stdout)
    return found


def test_up_to_the_last_number_nothing_is_said(seen: list[bool]) -> None:
    assert not any(seen[::2])


def test_one_beyond_is_told(seen: list[bool]) -> None:
    assert [way for way, told in enumerate(seen[1::2]) if not told] == []
