"""Tables of a part: the kernels read what was given, all instances one copy; whole or refused; data, not code."""

from __future__ import annotations

import re
import shutil
import struct
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fmu_src import tables
from fmu_src.catalogue import MODELS
from fmu_src.instance import Instance
from fmu_src.interface import Variable
from fmu_src.packaging import start_values, table_file
from fmu_src.tables import Table
from tests.packaging import lookup
from tests.packaging.hosts import NO_VALGRIND, VALGRIND, compile_host
from tests.packaging.lookup import BOTH, BOX, CURVE_ALONE, KNOTS, MODEL, OTHER_KNOTS
from tests.packaging.raw import ERROR, OK, Library, Raw

REFERENCES = MODEL.interface(BOTH).references
OUTPUTS = ("y", "sum", "corner", "total")
INPUTS = (-1.5, -1.0, -0.3, 0.0, 0.1, 0.7, 1.2, 1.5, 3.0)


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """The library of the lookup with both parts."""
    return lookup.build(tmp_path_factory.mktemp("lookup"), BOTH)


@pytest.fixture(scope="module")
def loaded(built):
    return Library(built)


@pytest.fixture
def folder(tmp_path):
    """An unpacked FMU of the lookup, all but its library."""
    lookup.furnish(tmp_path / "one", lookup.given(BOTH))
    return tmp_path / "one"


@pytest.fixture
def make(loaded):
    """Make instances whose FMU is unpacked in a folder; freed at the end."""
    made = []

    def new(folder):
        made.append(Raw(loaded, lookup.GUID, REFERENCES, resources=str(folder / "resources").encode()))
        return made[-1]

    yield new
    for raw in made:
        raw.free()


def walked(raw):
    """The outputs at the start and after a step with each input."""
    assert raw.start({"u": 0.25}) == OK, raw.last
    rows = [raw.get(*OUTPUTS)]
    for k, u in enumerate(INPUTS):
        raw.set({"u": u})
        assert raw.step(0.5 * k, 0.5) == OK
        rows.append(raw.get(*OUTPUTS))
    return rows


def twin(**other):
    """The lookup in this process."""
    return Instance(MODEL, BOTH, {"u": 0.25}, lookup.named(**other)).initialise()


def walked_here(instance):
    rows = [[instance[name] for name in OUTPUTS]]
    for u in INPUTS:
        instance["u"] = u
        instance.step(0.5)
        rows.append([instance[name] for name in OUTPUTS])
    return rows


def test_the_kernel_reads_what_was_given_in_its_order():
    instance = twin()
    for u in INPUTS[1:-1]:
        instance["u"] = u
        instance.refresh()
        assert instance["y"] == pytest.approx(np.interp(u, *KNOTS.T), rel=1e-15)
    i, j, k = np.indices(BOX.shape)
    assert instance["corner"] == BOX[-1, -1, -1]
    assert instance["total"] == pytest.approx(np.sum(BOX / (1.0 + i + 10.0 * j + 100.0 * k)), rel=1e-14)
    for wrong in (np.swapaxes(BOX, 0, 1), BOX[::-1], BOX.ravel(order="F").reshape(BOX.shape)):
        assert twin(grid=wrong)["total"] != instance["total"]
    assert twin(grid=np.asfortranarray(BOX))["total"] == instance["total"], "whatever its layout in memory"


def test_the_fmu_gives_the_same_bits(make, folder, tmp_path):
    assert walked(make(folder)) == walked_here(twin())
    other = {"curve": OTHER_KNOTS, "grid": np.full((1, 5, 2), 0.1)}
    lookup.furnish(tmp_path / "two", lookup.given(BOTH, **other))
    rows = walked(make(tmp_path / "two"))  # other numbers and extents, with the same library
    assert rows == walked_here(twin(**other))
    assert rows != walked(make(folder))


def test_a_kernel_can_not_write_to_a_table():
    from numba import from_dtype, njit
    from numba.core.errors import TypingError

    interface = MODEL.interface(BOTH)
    curve = tables.make_reader(interface.tables, "curve.knots")

    @njit
    def read(record):
        return curve(record[0])[0, 1]

    @njit
    def write(record):
        curve(record[0])[0, 1] = 2.0

    record = from_dtype(interface.dtype)[::1]
    read.compile((record,))
    with pytest.raises(TypingError, match="readonly"):
        write.compile((record,))
    with pytest.raises(ValueError, match="no part of this model brings a table 'curse'"):
        tables.make_reader(interface.tables, "curse")


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"curve.knots": KNOTS}, "this lookup needs the table box.numbers (numbers of a box), and was given none"),
        ({}, "this lookup needs the table curve.knots"),
        (
            {"curve.knots": KNOTS, "box.numbers": BOX, "box.nubmers": BOX},
            "table box.nubmers: this lookup has no table of that name",
        ),
        ({"curve.knots": KNOTS, "box.numbers": BOX[0]}, "table box.numbers: 2 dimensions given, expected 3"),
        ({"curve.knots": KNOTS, "box.numbers": BOX[:0]}, "table box.numbers: it is empty"),
        (
            {"curve.knots": KNOTS, "box.numbers": np.where(BOX[1, 0, 1] < BOX, np.nan, BOX)},
            "number 2, 1, 3 is nan, expected a fin",
        ),
        (
            {"curve.knots": KNOTS, "box.numbers": -np.inf * np.ones((1, 1, 1))},
            "number 1, 1, 1 is -inf, expected a finite one",
        ),
    ],
)
def test_what_can_be_no_table_is_told(given, words):
    with pytest.raises(ValueError, match=re.escape(words)):
        MODEL.interface(BOTH).with_tables(given)


def test_tables_of_two_parts_must_not_share_a_name():
    other = replace(MODEL.groups["box"].terms["grid"], tables=(Table("curve.knots", "m", "another"),))
    box = replace(MODEL.groups["box"], terms={"grid": other})
    clashing = replace(MODEL, groups={**MODEL.groups, "box": box})
    with pytest.raises(ValueError, match=r"lookup: two parts bring a table curve\.knots, and they differ"):
        _ = clashing.interface(BOTH).tables
    with pytest.raises(ValueError, match="table deep: 4 dimensions, expected 1 to 3"):
        Table("deep", "1", "too deep", dimensions=4)


def test_a_table_beside_a_term_of_another_part_is_there_with_it_alone():
    twice = Table("curve.twice", "1", "twice", 2, made=lambda n: 2.0 * n["curve.knots"], beside=("box", "grid"))
    part = MODEL.groups["curve"].terms["linear"]
    curve = replace(MODEL.groups["curve"], terms={"linear": replace(part, tables=(*part.tables, twice))})
    made = replace(MODEL, groups={**MODEL.groups, "curve": curve})
    both, alone = made.interface(BOTH), made.interface(CURVE_ALONE)
    assert [table.name for table in both.tables] == ["curve.knots", "curve.twice", "box.numbers"]
    given = both.with_tables({"curve.knots": KNOTS, "box.numbers": BOX}).given
    np.testing.assert_array_equal(given["curve.twice"], 2.0 * KNOTS)
    knots, plain = {"curve.knots": KNOTS}, MODEL.interface(CURVE_ALONE)
    assert table_file.content(alone.with_tables(knots)) == table_file.content(plain.with_tables(knots))
    with pytest.raises(ValueError, match=r"table spans: a scene gives it, it cannot hang on the choice of box"):
        Table("spans", "1", "given", beside=("box", "grid"))


def test_a_row_beside_a_term_of_another_part_is_there_with_it_alone():
    twice = Variable("curve_twice[#]", "1", "state", "room", shape=(4,), beside=("box", "grid"))
    part = MODEL.groups["curve"].terms["linear"]
    curve = replace(MODEL.groups["curve"], terms={"linear": replace(part, variables=(*part.variables, twice))})
    made = replace(MODEL, groups={**MODEL.groups, "curve": curve})
    assert twice in made.interface(BOTH).variables
    assert made.interface(CURVE_ALONE).variables == MODEL.interface(CURVE_ALONE).variables
    with pytest.raises(ValueError, match=r"curve\.knot: a tool sees it, it cannot hang on the choice of box"):
        Variable("curve.knot", "1", "output", "seen", beside=("box", "grid"))


def test_what_is_given_is_kept_as_it_was():
    mine = KNOTS.copy()
    interface = MODEL.interface(CURVE_ALONE).with_tables({"curve.knots": mine})
    before = table_file.content(interface)
    mine[0] = 99.0
    assert table_file.content(interface) == before
    with pytest.raises(ValueError, match="read-only"):
        interface.given["curve.knots"][0] = 99.0
    assert interface.starting({"grain": 2.0}).table_block is not None, "values leave them"


def test_a_model_without_tables_has_none():
    plain = MODELS["reel_control"].interface({})
    assert plain.with_tables({}) is plain
    assert (plain.tables, plain.tables_identity, plain.table_block.size) == ((), 0, 0)
    with pytest.raises(ValueError, match="table curve: this reel_control has no table of that name"):
        plain.with_tables({"curve": KNOTS})


def mappings(path):
    """Of each mapping of a file in this process: how it may be used, and sizes in kB by name (Linux)."""
    found, current = [], None
    for line in Path("/proc/self/smaps").read_text().splitlines():
        if re.match(r"[0-9a-f]+-[0-9a-f]+ ", line):
            current = {"use": line.split()[1]} if line.endswith(str(path)) else None
            found += [current] if current is not None else []
        elif current is not None and line.endswith(" kB"):
            name, size = line.split(":")
            current[name] = int(size.split()[0])
    return found


def test_instances_share_one_copy_that_nobody_can_write_to(make, tmp_path):
    """By what the system says: each has looked at all of it, and together they hold it once. The twin: another FMU."""
    grid = np.random.default_rng(1).random((64, 64, 256))
    size = grid.nbytes / 1024
    for name in ("one", "two"):
        lookup.furnish(tmp_path / name, lookup.given(BOTH, grid=grid))
    many = [make(tmp_path / "one") for _ in range(12)]
    for raw in many:
        assert raw.start() == OK
    assert len({raw.get("total") for raw in many}) == 1
    own = mappings(tmp_path / "one" / table_file.PATH)
    assert len(own) == len(many)
    assert {m["use"] for m in own} == {"r--p"}
    assert sum(m["Rss"] for m in own) > 0.99 * len(many) * size
    assert sum(m["Pss"] for m in own) < 1.01 * size + 4
    assert {m["Anonymous"] for m in own} == {0}
    make(tmp_path / "two")
    (other,) = mappings(tmp_path / "two" / table_file.PATH)
    assert other["Pss"] > 0.99 * size
    for raw in many:
        raw.call("FreeInstance")
        raw.component = raw.component.__class__()
    assert mappings(tmp_path / "one" / table_file.PATH) == []
    assert len(mappings(tmp_path / "two" / table_file.PATH)) == 1


def test_it_goes_on_and_resets_when_the_file_is_gone(make, folder):
    raw = make(folder)
    assert raw.start({"u": 0.25}) == OK
    y = raw.get("y")
    shutil.rmtree(folder)
    assert raw.step(0.0, 0.5) == OK
    assert raw.call("Reset") == OK
    assert raw.start({"u": 0.25}) == OK
    assert raw.get("y") == y


def test_a_host_in_c_leaks_nothing(built, tmp_path):
    if not shutil.which("valgrind"):
        pytest.skip(NO_VALGRIND)
    lookup.furnish(built.parents[2], lookup.given(BOTH))
    host = compile_host("host.c", tmp_path)
    outputs = ",".join(str(REFERENCES[name]) for name in OUTPUTS)
    command = [*VALGRIND, host, built, lookup.GUID, "0.5", outputs, f"r:{REFERENCES['u']}=0.4"]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert " 0 failed" in done.stderr
    assert float.fromhex(done.stdout.split()[0]) == twin_at(0.4)


def twin_at(u):
    instance = twin()
    instance["u"] = u
    instance.refresh()
    return instance["y"]


def test_no_length_and_no_flipped_bit_is_taken_for_them(make, folder):
    file = folder / table_file.PATH
    whole = file.read_bytes()
    assert len(whole) == 64 + 64 + 8 * (8 + 24)
    damaged = [whole[:size] for size in range(len(whole))] + [whole + b"\0", whole + bytes(64)]
    damaged += [whole[:k] + bytes([whole[k] ^ 1 << n]) + whole[k + 1 :] for k in range(len(whole)) for n in range(8)]
    for data in damaged:
        file.write_bytes(data)
        raw = make(folder)
        assert not raw.component.value
        assert len(raw.said) == 1
        assert file.name in raw.last
    file.write_bytes(whole)
    assert walked(make(folder)) == walked_here(twin())


def forged(at, word):
    """The file with another word, and the check word that goes with it."""

    def harm(file, whole):
        body = whole[16:at] + struct.pack("<q", word) + whole[at + 8 :]
        file.write_bytes(whole[:8] + struct.pack("<Q", start_values.check_word(body)) + body)

    return harm


OTHERS = lookup.given(BOTH, curve=KNOTS + 1e-16 * (KNOTS == 0.1))
"""One number is off by its last digit."""


@pytest.mark.parametrize(
    ("harm", "words"),
    [
        (lambda file, whole: file.unlink(), "No such file"),
        (lambda file, whole: (file.unlink(), file.mkdir()), "can not be read from"),
        (lambda file, whole: file.write_bytes(b""), "can not be read from"),
        (lambda file, whole: file.write_bytes(b"PK" + whole[2:]), "holds no tables"),
        (lambda file, whole: file.write_bytes(whole[:-8]), "cut short or too long: it has 376 bytes"),
        (lambda file, whole: file.write_bytes(whole[:200] + b"\1" + whole[201:]), "its check word does not fit"),
        (lambda file, whole: file.write_bytes(table_file.content(OTHERS)), "holds other tables than those of this FMU"),
        (
            lambda file, whole: file.write_bytes(table_file.content(lookup.given(CURVE_ALONE))),
            "does not hold 2 tables, as this library needs them",
        ),
        (forged(24, 2), "version 2, expected 1"),
        (forged(64, 0), "does not hold 2 tables"),
        (forged(64, 2**62), "does not hold 2 tables"),
        (forged(72, 5), "does not hold 2 tables"),
        (forged(72, -4), "does not hold 2 tables"),
        (forged(80, 0), "does not hold 2 tables"),
        (forged(104, 2**63 - 1), "does not hold 2 tables"),
        (forged(112, 3 + 2**61), "does not hold 2 tables"),  # whose product with the others is 24 in 64 bits
        (forged(120, 6), "does not hold 2 tables"),
        (forged(120, 9), "does not hold 2 tables"),
    ],
)
def test_what_is_wrong_with_them_is_told(make, folder, harm, words):
    assert OTHERS.given["curve.knots"].tolist() != KNOTS.tolist()
    file = folder / table_file.PATH
    harm(file, file.read_bytes())
    raw = make(folder)
    assert not raw.component.value
    (message,) = raw.said
    assert message[:2] == (ERROR, "logStatusError")
    assert words in message[2]
    assert file.name in message[2]


def test_the_layout_is_what_the_modules_say(folder):
    data = (folder / table_file.PATH).read_bytes()
    interface = lookup.given(BOTH)
    assert data[:8] == b"DCONETAB"
    assert struct.unpack_from("<qqqqqq", data, 16) == (interface.tables_identity, 1, 2, 40, 0, 0)
    assert struct.unpack_from("<8q", data, 64) == (8, 4, 2, 1, 16, 2, 3, 4)
    assert data[128 : 128 + 64] == KNOTS.tobytes()
    assert data[192:] == BOX.tobytes()
    held = (folder / start_values.PATH).read_bytes()
    assert struct.unpack_from("<q", held, 128 + 8 * 5) == (interface.tables_identity,)


def test_a_state_goes_with_its_tables_alone_and_holds_no_address(make, folder, tmp_path):
    for name, interface in (("copy", lookup.given(BOTH)), ("others", OTHERS)):
        lookup.furnish(tmp_path / name, interface)
    one, copy, others = make(folder), make(tmp_path / "copy"), make(tmp_path / "others")
    for raw in (one, copy, others):
        assert raw.start({"u": 0.25}) == OK
        assert raw.step(0.0, 0.5) == OK
    state = one.save()
    data = one.serialise(state)
    assert data == copy.serialise(copy.save()), "two instances, two addresses"
    assert struct.unpack_from("<2q", data, 152 + 8 * 5) == (lookup.given(BOTH).tables_identity, 0)
    status, taken = copy.deserialise(data)
    assert status == OK
    assert copy.restore(taken) == copy.restore(state) == OK
    for _ in range(2):
        status, refused = others.deserialise(data)
        assert (status, refused.value) == (ERROR, None)
        assert others.last == "the saved state belongs to other tables than those of this FMU"
        others.said.clear()
    assert others.restore(state) == ERROR
    assert "belongs to other tables" in others.last
    assert others.step(0.5, 0.5) == OK, "and it goes on where it was"
