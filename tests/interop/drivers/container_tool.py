"""fmu-manipulation-toolbox: packs the FMU into an FMU container by its command line; fmpy runs the container."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from tests.interop.drivers import fmpy_tool
from tests.interop.job import Job, Row, serve

INNER = "towed"
"""Name of the FMU inside; its parameters come out as `towed.NAME`, its outputs under their own names."""


def pack(job: Job, folder: Path) -> Path:
    """An FMU container of the one FMU, that steps it as the job asks."""
    shutil.copyfile(job.fmu, folder / f"{INNER}.fmu")
    (folder / "container.csv").write_text(f"rule;from_fmu;from_port;to_fmu;to_port\nFMU;{INNER}.fmu;;;\n")
    command = [sys.executable, "-c", "from fmu_manipulation_toolbox.cli.fmucontainer import fmucontainer as f; f()"]
    options = ["-container", f"container.csv:{job.step!r}", "-fmu-directory", str(folder), "-auto-parameter"]
    done = subprocess.run([*command, *options], capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"fmucontainer ended with {done.returncode}\n{done.stdout}\n{done.stderr}")
    return folder / "container.fmu"


def run(job: Job) -> list[Row]:
    with tempfile.TemporaryDirectory() as name:
        path = pack(job, Path(name))
        parameters = {f"{INNER}.{name}": value for name, value in job.parameters.items()}
        return fmpy_tool.run(replace(job, fmu=str(path), parameters=parameters))


if __name__ == "__main__":
    serve("fmu-manipulation-toolbox", run)
