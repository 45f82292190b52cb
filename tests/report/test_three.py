"""three.js as the registry has it: the one file from elsewhere, byte by byte. Skipped, visibly, without a registry."""

from __future__ import annotations

import base64
import hashlib
import shutil
import subprocess
import tarfile
from pathlib import Path

import pytest

from dcone_cosim.report import scripts

PATIENCE = 120.0
"""[s]"""


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package of that version, fetched by npm."""
    npm = shutil.which("npm")
    if npm is None:
        pytest.skip("no npm: three.js is not held against the registry")
    folder = tmp_path_factory.mktemp("npm")
    name = f"three@{scripts.origin()['version']}"
    try:
        done = subprocess.run(
            [npm, "pack", name], cwd=folder, capture_output=True, text=True, timeout=PATIENCE, check=False
        )
    except subprocess.TimeoutExpired:
        pytest.skip("no answer from the npm registry: three.js is not held against it")
    found = list(folder.glob("*.tgz"))
    if not found:
        pytest.skip(f"no npm registry: three.js is not held against it ({done.stderr.strip()[-80:]})")
    return found[0]


def test_it_is_the_file_of_that_version(package: Path) -> None:
    origin = scripts.origin()
    kind, _, digest = origin["integrity"].partition("-")
    assert base64.b64encode(hashlib.new(kind, package.read_bytes()).digest()).decode() == digest
    with tarfile.open(package) as archive:
        for name, here in (
            (origin["file"], Path(origin["file"]).name),
            (origin["licence_file"], origin["licence_file"]),
        ):
            member = archive.extractfile(f"package/{name}")
            assert member is not None
            assert member.read() == (scripts.THREE / here).read_bytes()


def test_its_licence_is_with_it() -> None:
    text = (scripts.THREE / scripts.origin()["licence_file"]).read_text()
    assert text.startswith(f"The {scripts.origin()['licence']} License")
    assert hashlib.sha256(text.encode()).hexdigest() == scripts.origin()["licence_sha256"]
