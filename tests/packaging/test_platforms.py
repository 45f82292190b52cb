"""Libraries for every platform: what they need and show, both x86-64 code paths, archives that come out the same."""

import ctypes
import itertools
import re
import struct
import subprocess
import sys
import zipfile
from pathlib import Path

import lief
import llvmlite.binding as llvm
import numpy as np
import pytest

from dcone_cosim import build as door
from dcone_cosim import cli
from dcone_cosim.build import cache_folder
from dcone_cosim.errors import InputError
from fmu_src.catalogue import MODELS
from fmu_src.interface import GO_ON, INITIALISE, SIZE, STEP, UNDER_WAY
from fmu_src.packaging import builds, compile, link, platforms, tools, universal
from tests.packaging import platform_cases
from tests.packaging.platform_cases import CASES

SMALL, SMALLEST = "tethered_deorbit", "reel_control"
EITHER = pytest.mark.parametrize("model", [SMALLEST, pytest.param(SMALL, marks=pytest.mark.evidence)])
"""Shim and linking are the same for all models: the smallest shows what a library for another machine is."""
FUNCTIONS = set(re.findall(r"FMI2_Export fmi2\w+TYPE\s+(fmi2\w+);", (link.HEADERS / "fmi2Functions.h").read_text()))
FAST = ("-O3", "-s", "-shared", "-fPIC")
"""As the FMUs are linked: with other options zig would first build its own run-time library once more."""
OLDEST = (2, 17)
"""glibc of the systems an FMU for Linux must load on (RHEL 7 and what came after)."""


@pytest.fixture(scope="session")
def cache():
    """Where runs find FMUs too."""
    return cache_folder()


@pytest.fixture(scope="session")
def library(cache, tmp_path_factory):
    """Library of a model for a platform, in one of its places, unpacked."""

    def make(model, platform, place=0):
        terms = CASES[model].terms if model in CASES else {}
        fmu = builds.build(MODELS[model].interface(terms), cache, platform=platform)
        folder = platform.places[place].folder
        return platform_cases.unpack(fmu, tmp_path_factory.mktemp(platform.name), folder)[1]

    return make


def glibc_versions(binary):
    versions = (s.symbol_version for s in binary.imported_symbols if s.symbol_version)
    names = {v.symbol_version_auxiliary.name for v in versions if v.symbol_version_auxiliary}
    assert all(n.startswith("GLIBC_") for n in names)
    return {tuple(int(x) for x in n.removeprefix("GLIBC_").split(".")) for n in names}


def test_the_standard_names_44_functions():
    assert len(FUNCTIONS) == 44
    assert {"fmi2DoStep", "fmi2GetContinuousStates", "fmi2GetTypesPlatform"} <= FUNCTIONS


@pytest.mark.slow
@pytest.mark.parametrize(
    ("model", "platform"),
    [
        pytest.param(SMALL, platforms.LINUX64, id="tow-linux64"),
        pytest.param(SMALLEST, platforms.LINUX_AARCH64, id="reel-linux-aarch64", marks=pytest.mark.evidence),
        pytest.param(SMALL, platforms.LINUX_AARCH64, id="tow-linux-aarch64", marks=pytest.mark.evidence),
    ],
)
def test_linux_library_needs_an_old_glibc_and_shows_the_interface_alone(model, platform, library):
    binary = lief.parse(str(library(model, platform)))
    assert set(binary.libraries) <= {"libc.so.6", "libm.so.6", "libdl.so.2"}
    versions = glibc_versions(binary)
    assert versions
    assert max(versions) <= OLDEST
    assert {s.name for s in binary.exported_symbols} == FUNCTIONS
    assert binary.header.machine_type == (
        lief.ELF.ARCH.X86_64 if platform is platforms.LINUX64 else lief.ELF.ARCH.AARCH64
    )


def test_newer_glibc_would_be_seen(tmp_path):
    """The twin: `pow` is another symbol since glibc 2.29, and a library linked for that needs it.

    Linked with nothing else, or zig would build its run-time library for that glibc too.
    """
    source = tmp_path / "a.c"
    source.write_text("double pow(double, double);\ndouble f(double x) { return pow(x, x); }\n")
    found = []
    for version in ("2.17", "2.31"):
        made = tmp_path / f"{version}.so"
        target = f"x86_64-linux-gnu.{version}"
        subprocess.run(
            [sys.executable, "-m", "ziglang", "cc", "-target", target, *FAST, "-nostdlib", source, "-o", made, "-lm"],
            check=True, capture_output=True,
        )  # fmt: skip
        found.append(max(glibc_versions(lief.parse(str(made)))))
    assert found[0] <= OLDEST < found[1]


@pytest.mark.evidence
@pytest.mark.parametrize("model", [SMALLEST, SMALL])
def test_linux_on_arm64_has_one_library_wherever_it_is_looked_for(model, library):
    """By the tuple of FMI 3.0, and where older loaders look: the same bytes."""
    one, other = (library(model, platforms.LINUX_AARCH64, place).read_bytes() for place in (0, 1))
    assert one == other


@EITHER
@pytest.mark.slow
def test_mac_on_arm64_has_one_library_wherever_it_is_looked_for(model, library):
    """The same bytes, part of the universal file."""
    whole, part = (library(model, platforms.DARWIN64, place).read_bytes() for place in (0, 1))
    assert len(part) > 10_000
    assert part in whole
    assert lief.MachO.parse(list(part)).at(0).header.cpu_type == lief.MachO.Header.CPU_TYPE.ARM64


@EITHER
@pytest.mark.slow
@pytest.mark.parametrize(("place", "machines"), [(0, ["X86_64", "ARM64"]), (1, ["ARM64"])])
def test_mac_library_is_universal_and_shows_the_interface_alone(model, library, place, machines):
    """Linked only: no Mac runs these tests."""
    parts = lief.MachO.parse(str(library(model, platforms.DARWIN64, place)))
    assert [p.header.cpu_type.name for p in parts] == machines
    for part in parts:
        assert {s.name.removeprefix("_") for s in part.exported_symbols} >= FUNCTIONS
        assert not any("dcone" in s.name for s in part.exported_symbols)
        assert {x.name for x in part.libraries} == {f"@rpath/{model}.dylib", "/usr/lib/libSystem.B.dylib"}
        assert list(part.build_version.minos)[:1] == [11]
    assert parts.at(len(machines) - 1).has_code_signature  # an arm64 Mac loads nothing unsigned


@pytest.mark.release
def test_windows_library_shows_the_interface_alone(library):
    binary = lief.parse(str(library(SMALL, platforms.WIN64)))
    assert binary.header.machine == lief.PE.Header.MACHINE_TYPES.AMD64
    exported = binary.get_export()
    assert exported.name == f"{SMALL}.dll"
    assert {e.name for e in exported.entries} == FUNCTIONS
    ours = {i.name for i in binary.imports}
    assert all(n.startswith("api-ms-win-crt-") or n == "KERNEL32.dll" for n in ours)


def test_clang_runs_where_its_own_files_are(monkeypatch, tmp_path):
    """It tells C libraries apart by paths seen from where it runs: from above its files it would build them anew."""
    told = []
    monkeypatch.setattr(tools, "run", lambda what, command, environment, place: told.append((command, place)))
    monkeypatch.chdir(tmp_path)
    link.clang(["-c", Path("a.c"), "-o", tmp_path / "a.o", "-lm"])
    ((command, place),) = told
    assert command[-5:] == ["-c", str(tmp_path / "a.c"), "-o", str(tmp_path / "a.o"), "-lm"]
    assert (place / "lib" / "libc" / "wasi").is_dir()


def part_of(kind, content):
    return struct.pack("<IIII", universal.PART_MAGIC, kind, 3, 6) + content


def test_universal_file_holds_its_parts_where_its_table_says():
    parts = [part_of(0x01000007, b"x" * 20001), part_of(0x0100000C, b"y" * 5)]
    joined = universal.join(parts)
    assert struct.unpack_from(">II", joined) == (0xCAFEBABE, 2)
    for k, part in enumerate(parts):
        kind, subtype, begin, size, power = struct.unpack_from(">IIIII", joined, 8 + 20 * k)
        assert (kind, subtype, power) == (struct.unpack_from("<I", part, 4)[0], 3, 14)
        assert begin % 2**14 == 0
        assert joined[begin : begin + size] == part
    with pytest.raises(ValueError, match="no 64-bit Mach-O"):
        universal.join([parts[0], b"\x7fELF" + bytes(60)])


def test_universal_file_is_read_by_others(tmp_path):
    """Two empty programs of clang's, joined, are two programs to another reader."""
    (tmp_path / "a.c").write_text("int f(void) { return 1; }\n")
    objects = []
    for machine in ("x86_64", "aarch64"):
        made = tmp_path / f"{machine}.o"
        command = [sys.executable, "-m", "ziglang", "cc", "-target", f"{machine}-macos", "-c", tmp_path / "a.c"]
        subprocess.run([*command, "-o", made], check=True, capture_output=True)
        objects.append(made.read_bytes())
    read = lief.MachO.parse(list(universal.join(objects)))
    assert [p.header.cpu_type.name for p in read] == ["X86_64", "ARM64"]


@pytest.mark.slow
def test_both_code_paths_give_the_same_bits(cache, tmp_path):
    """Both entries of one library, called side by side: every number of record and work memory."""
    if not llvm.get_host_cpu_features().get("avx2"):
        pytest.skip("this processor has no AVX2")
    for model, case in CASES.items():
        folder, _ = platform_cases.unpack(platform_cases.build(model, platforms.LINUX64, cache), tmp_path / model)
        ir = folder / "visible.ll"
        ir.write_text((folder / "sources/model.ll").read_text().replace("define hidden", "define"))
        ((target,),) = (place.targets for place in platforms.LINUX64.places)
        objects = link.compile_kernels(ir, target, folder)
        shared = folder / "both.so"
        command = [sys.executable, "-m", "ziglang", "cc", "-target", target.triple, *FAST, *objects, "-o", shared]
        subprocess.run([*command, "-lm"], check=True, capture_output=True)
        code = ctypes.CDLL(str(shared))
        ends = [run_entry(code[name], model, case) for name in ("dcone_entry", "dcone_entry_v3")]
        assert ends[0].tobytes() == ends[1].tobytes()
        assert np.count_nonzero(ends[0]) > 100
        other = dict(case.parameters, **{"chaser.mass": 1000.0})
        twin = run_entry(code.dcone_entry, model, platform_cases.Case(case.terms, other, case.step, case.count))
        assert twin.tobytes() != ends[0].tobytes()


def run_entry(entry, model, case):
    """Record and work memory after every step of a case, from a bare entry, as one array of 8-byte slots."""
    interface = MODELS[model].interface(case.terms)
    record = interface.make_record()
    slots = record.view(np.uint64)
    for name, value in case.parameters.items():
        record.view(np.float64)[interface.references[name]] = value
    whole, real = ctypes.c_int64, ctypes.c_double
    work = np.zeros(1, np.uint64)

    def call(command, time, step):
        result, exception = ctypes.c_int32(0), ctypes.c_void_p(None)
        size = whole(record.nbytes)
        status = entry(
            ctypes.byref(result), ctypes.byref(exception), whole(command),
            None, None, whole(1), size, record.ctypes.data_as(ctypes.c_void_p), whole(1), size,
            None, None, whole(work.size), whole(8), work.ctypes.data_as(ctypes.c_void_p), whole(work.size), whole(8),
            real(time), real(step),
        )  # fmt: skip
        assert status == 0
        return result.value

    def settle(command, time, step):
        answer = call(command, time, step)
        while answer == UNDER_WAY:
            answer = call(GO_ON, time, step)
        assert answer == 0

    settle(SIZE, 0.0, 0.0)
    work = np.zeros(int(record["work_size"][0]), np.uint64)
    settle(INITIALISE, 0.0, 0.0)
    for k in range(case.count):
        settle(STEP, k * case.step, case.step)
    return np.concatenate([slots, work])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("model", "terms", "others"),
    [
        ("reel_control", {}, {"motor": "lag"}),
        pytest.param(SMALL, CASES[SMALL].terms, {**CASES[SMALL].terms, "reel": "linear"}, marks=pytest.mark.evidence),
    ],
)
def test_two_builds_give_the_same_bytes(model, terms, others, cache, compiled_anew, tmp_path, monkeypatch):
    """Another folder, another cache, another order of hashes: the same FMU; other terms: another."""
    interface = MODELS[model].interface(terms)
    first = builds.build(interface, cache, platform=platforms.LINUX64)
    monkeypatch.setenv("PYTHONHASHSEED", "12345")
    if model == SMALL:  # whose C library is then built anew
        monkeypatch.setenv("ZIG_GLOBAL_CACHE_DIR", str(tmp_path / "zig"))
    monkeypatch.chdir(tmp_path)
    # the package is found from the project's folder, in a child process too
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[2]))
    second = builds.build(interface, tmp_path / "deeper" / "cache", platform=platforms.LINUX64)
    assert second.read_bytes() == first.read_bytes()
    with zipfile.ZipFile(second) as content:
        everything = b"".join(content.read(n) for n in content.namelist())
    assert str(tmp_path).encode() not in everything
    assert builds.fingerprint(MODELS[model].interface(others)) != builds.fingerprint(interface)


def small_fmu(path, **files):
    builds.pack({"modelDescription.xml": b"<x/>"} | {n.replace("__", "/"): b for n, b in files.items()}, path)
    return path


def test_fmus_of_one_origin_are_united(tmp_path):
    one = small_fmu(tmp_path / "one", binaries__linux64__a=b"1")
    two = small_fmu(tmp_path / "two", binaries__win64__a=b"2")
    everywhere = ("linux64", "win64")
    for k, order in enumerate(itertools.permutations([one, two])):
        builds.pack(builds.unite(dict.fromkeys(order, everywhere)), tmp_path / f"both{k}")
    assert (tmp_path / "both0").read_bytes() == (tmp_path / "both1").read_bytes()
    with zipfile.ZipFile(tmp_path / "both0") as content:
        assert set(content.namelist()) == {"modelDescription.xml", "binaries/linux64/a", "binaries/win64/a"}
    stranger = small_fmu(tmp_path / "three", binaries__win64__a=b"2", sources__model=b"3")
    assert builds.unite(dict.fromkeys([one, stranger], everywhere))["sources/model"] == b"3"
    four = small_fmu(tmp_path / "four", binaries__win64__a=b"other")
    with pytest.raises(ValueError, match="not of the same origin"):
        builds.unite(dict.fromkeys([two, four], everywhere))
    assert builds.unite({two: everywhere, four: ()}) == builds.unite({two: everywhere})


def test_kernels_are_worked_out_once_for_all_platforms(tmp_path, monkeypatch):
    emitted, linked = [], []
    monkeypatch.setattr(
        compile, "emit", lambda model, terms, path, kept: (emitted.append(model.name), path.write_text("IR"))
    )
    monkeypatch.setattr(
        link, "link", lambda ir, header, library, targets: (linked.append(targets), library.write_bytes(b"1"))
    )
    interface = MODELS[SMALL].interface(CASES[SMALL].terms)
    told = []
    chosen = list(platforms.PLATFORMS.values())
    ((*fmus,),) = builds.build_all([interface], tmp_path, told.append, chosen)
    assert emitted == [SMALL]
    assert linked == [place.targets for p in chosen for place in p.places]
    assert len(set(fmus)) == 4
    assert any("win64" in line and "minutes" in line for line in told)
    builds.build_all([interface], tmp_path, told.append, chosen)
    assert len(linked) == 6


def test_platforms_by_name():
    assert door.platform_names("all") == ("linux64", "win64", "darwin64", "linux-aarch64")
    assert door.platform_names("win64, linux64,win64") == ("win64", "linux64")
    with pytest.raises(InputError, match=r"'win46' is not a platform.*did you mean 'win64'"):
        door.platform_names("linux64,win46")
    with pytest.raises(InputError, match="'' is not a platform"):
        door.platform_names("linux64,")


def test_linux_on_arm64_has_an_archive_of_its_own_too():
    together, apart = platforms.archives(list(platforms.PLATFORMS.values()))
    folders = ["linux64", "win64", "darwin64", "aarch64-darwin", "aarch64-linux"]
    assert (together[0], [f for group in together[1].values() for f in group]) == ("", folders)
    assert apart == ("-linux-aarch64", {platforms.LINUX_AARCH64: ["aarch64-linux", "linux64"]})
    assert platforms.archives([platforms.LINUX_AARCH64]) == [apart]
    assert [ending for ending, _ in platforms.archives([platforms.LINUX64, platforms.WIN64])] == [""]


@pytest.mark.parametrize(
    ("system", "machine", "name"),
    [
        ("linux", "x86_64", "linux64"),
        ("linux", "aarch64", "linux-aarch64"),
        ("win32", "AMD64", "win64"),
        ("darwin", "arm64", "darwin64"),
    ],
)
def test_each_machine_builds_for_itself(system, machine, name, monkeypatch):
    monkeypatch.setattr(sys, "platform", system)
    monkeypatch.setattr(platforms.platform, "machine", lambda: machine)
    assert platforms.host().name == name
    monkeypatch.setattr(platforms.platform, "machine", lambda: "riscv64")
    with pytest.raises(tools.BuildError, match=f"for {system} on riscv64"):
        platforms.host()


@pytest.fixture
def without_tools(tmp_path, monkeypatch):
    """Builds that neither compile nor link: what an archive is called and holds is seen without."""
    monkeypatch.setattr(compile, "emit", lambda model, terms, path, kept: path.write_text("IR"))
    monkeypatch.setattr(
        link, "link", lambda ir, header, library, targets: library.write_text(" ".join(t.triple for t in targets))
    )
    monkeypatch.setenv("DCONE_CACHE", str(tmp_path / "cache"))
    monkeypatch.chdir(tmp_path)


def test_command_writes_two_archives_for_all_platforms(without_tools, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["dcone", "build", "table2-deorbit", "--platforms", "all", "-o", "fmus"])
    with pytest.raises(SystemExit) as stop:
        cli.main()
    assert not stop.value.code
    written = sorted((tmp_path / "fmus").iterdir())
    assert [str(p.relative_to(tmp_path)) for p in written] == sorted(capsys.readouterr().out.split())
    binaries = []
    for path in written:
        with zipfile.ZipFile(path) as content:
            binaries.append({n: content.read(n).decode() for n in content.namelist() if n.startswith("binaries/")})
    arm = {f"binaries/aarch64-linux/{SMALL}.so": "aarch64-linux-gnu.2.17"}
    assert written[0].stem == f"{written[1].stem}-linux-aarch64"
    assert binaries[0] == arm | {f"binaries/linux64/{SMALL}.so": "aarch64-linux-gnu.2.17"}
    assert binaries[1] == arm | {
        f"binaries/linux64/{SMALL}.so": "x86_64-linux-gnu.2.17",
        f"binaries/win64/{SMALL}.dll": "x86_64-windows-gnu",
        f"binaries/darwin64/{SMALL}.dylib": "x86_64-macos.11.0 aarch64-macos.11.0",
        f"binaries/aarch64-darwin/{SMALL}.dylib": "aarch64-macos.11.0",
    }


def test_unknown_platform_is_bad_input_and_leaves_nothing(without_tools, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["dcone", "build", "table2-deorbit", "--platforms", "macos", "-o", "fmus"])
    with pytest.raises(SystemExit) as stop:
        cli.main()
    assert stop.value.code == 2
    assert "'macos' is not a platform" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
