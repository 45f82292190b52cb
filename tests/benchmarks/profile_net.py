"""Where the time of the net's FMU goes, by kernel: needs Linux, an x86-64 processor with AVX2 and `perf`.

    python -m tests.benchmarks.profile_net FMU      of a net in free flight, as NET_FMUS_KEEP of test_net_speed keeps it

links the FMU's own sources once more, kernels kept apart and with their names left in, and samples the flight of the
timings. A kernel that numba has put into another counts there.
"""

import re
import shutil
import subprocess
import sys
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

from fmpy import extract

from fmu_src.packaging.link import HEADERS
from tests.net_capture.evidence.mouth_error import SCENES, TIMED
from tests.packaging.driven import Driven, library_of

CLANG = (sys.executable, "-m", "ziglang", "cc", "-O3", "-ffp-contract=off", "-fno-math-errno", "-fPIC", "-w")
APART = ("-mllvm", "-inline-threshold=-10000")
"""Leaves every kernel a function of its own that numba has left so."""
LEAST = 0.5
"""Per cent below which a kernel is not told of."""


def link_named(folder: Path) -> None:
    """Put a library with its symbols, for processors with AVX2, in the place of an unpacked FMU's."""
    sources, library = folder / "sources", library_of(folder)
    kernels = folder / "kernels.o"
    subprocess.run([*CLANG, *APART, "-mcpu=x86_64_v3", "-c", sources / "model.ll", "-o", kernels], check=True)
    shim = (sources / "fmi2.c", sources / "resources.c", "-I", HEADERS, "-I", sources)
    subprocess.run([*CLANG, "-shared", *shim, kernels, "-o", library, "-lm", "-ldl"], check=True)


def fly(fmu: str, folder: str) -> None:
    """The flight of the timings, of an FMU that is unpacked in the folder."""
    scene = SCENES["deployment"]
    bound = Driven(fmu, folder, scene).outputs()["solver.stability_bound"]
    Driven(fmu, folder, {**scene, "solver.step_ratio": TIMED["deployment"] / bound}).step(8.0)


def plain(symbol: str) -> str:
    """Module and name of a kernel from what perf makes of the name that numba gave it."""
    names = [name for name in symbol.partition("[")[0].split("::") if name != "_3clocals_3e"]
    return ".".join([name for name in names if not name.startswith("make")][-2:])


def profile(fmu: str) -> Counter[str]:
    """Share of the samples by kernel [%], those outside the FMU's library under their own names."""
    with TemporaryDirectory() as folder:
        extract(fmu, unzipdir=folder)
        link_named(Path(folder))
        data = f"{folder}/perf.data"
        flight = (sys.executable, "-m", "tests.benchmarks.profile_net", fmu, folder)
        subprocess.run(["perf", "record", "-q", "-F", "2000", "-o", data, *flight], check=True)
        report = ["perf", "report", "-i", data, "--stdio", "-q", "-F", "overhead,symbol", "-w", "0,2000"]
        report += ["--dsos", Path(library_of(folder)).name]
        lines = subprocess.run(report, check=True, capture_output=True, text=True).stdout.splitlines()
    shares: Counter[str] = Counter()
    for line in lines:
        if found := re.match(r"\s*([\d.]+)%\s+\[.\]\s+(\S+)", line):
            shares[plain(found[2])] += float(found[1])
    return shares


if __name__ == "__main__":
    if len(sys.argv) > 2:
        fly(*sys.argv[1:])
    elif not shutil.which("perf"):
        sys.exit("profile_net: perf is not on this machine")
    else:
        whole = profile(sys.argv[1])
        print("| kernel | per cent of the FMU's time |\n| --- | --- |")
        for kernel, share in whole.most_common():
            if share >= LEAST:
                print(f"| {kernel} | {100.0 * share / whole.total():.1f} |")
