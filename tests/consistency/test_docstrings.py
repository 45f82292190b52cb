"""Every `Checked` line of a docstring names test files that exist."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]


def named_tests():
    for package in ("orbital", "fmu_src", "dcone_cosim"):
        for source in (ROOT / package).rglob("*.py"):
            for line in re.findall(r"^\s*Checked\s+(.*)$", source.read_text(), re.MULTILINE):
                folder = "tests"
                for path in re.findall(r"[\w/]*test_\w+\.py", line):
                    folder = path.rpartition("/")[0] or folder
                    yield source, folder + "/" + path.rpartition("/")[2]


def test_tests_named_in_docstrings_exist():
    found = list(named_tests())
    assert len(found) > 50
    missing = sorted({f"{source.relative_to(ROOT)}: {path}" for source, path in found if not (ROOT / path).is_file()})
    assert missing == []
