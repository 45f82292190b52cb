"""Every kernel says what it is and which test checks it, and every test a docstring names is there."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("orbital", "fmu_src", "dcone_cosim")
KERNELS = (
    "orbital",
    "fmu_src/integrators",
    "fmu_src/net_capture",
    "fmu_src/tethered_deorbit",
    "fmu_src/reel_control",
)
"""Files and folders all of whose kernels name a test."""
DECORATORS = ("kernel", "view", "entry", "njit")
CHECKED = re.compile(r"^( *)Checked +(.*(?:\n\1 +\S.*)*)", re.MULTILINE)
"""The line, and those that go on with it farther in."""


def sources(*places: str) -> Iterator[Path]:
    for place in places:
        yield from sorted((ROOT / place).rglob("*.py")) if (ROOT / place).is_dir() else [ROOT / place]


def named_tests(text: str) -> Iterator[str]:
    """Test files that the `Checked` lines of a text name; the folder of one holds for those after it."""
    for _, line in CHECKED.findall(text):
        folder = "tests"
        for path in re.findall(r"[\w/]*test_\w+\.py", line):
            folder = path.rpartition("/")[0] or folder
            yield folder + "/" + path.rpartition("/")[2]


def name_of(node: ast.AST) -> str:
    """The last name of `kernel`, `entry(...)` or `plain.to_matrix`."""
    node = node.func if isinstance(node, ast.Call) else node
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""


def compiled_elsewhere(tree: ast.AST) -> Iterator[str]:
    """Functions of other modules that this one compiles: `to_matrix = kernel(plain.to_matrix)`."""
    for call in ast.walk(tree):
        if isinstance(call, ast.Call) and name_of(call) == "kernel":
            yield from (name_of(argument) for argument in call.args)


def kernels(tree: ast.AST, others: frozenset[str] = frozenset()) -> Iterator[ast.FunctionDef]:
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            decorated = any(name_of(decorator) in DECORATORS for decorator in node.decorator_list)
            if decorated or node.name in others:
                yield node


def is_trivial(function: ast.FunctionDef) -> bool:
    """Nothing but its docstring, or the return of numbers as they stand: there is nothing to check."""
    body = [s for s in function.body if not (isinstance(s, ast.Expr) and isinstance(s.value, ast.Constant))]
    if not body or isinstance(body[0], ast.Pass):
        return True
    value = body[0].value if isinstance(body[0], ast.Return) else None
    numbers = value.elts if isinstance(value, ast.Tuple) else [value]
    return all(isinstance(number, ast.Constant) for number in numbers)


def fault(function: ast.FunctionDef) -> str | None:
    """What a kernel's docstring lacks. That of one that does nothing may be a single line."""
    text = ast.get_docstring(function)
    if not text:
        return "has no docstring"
    named = list(named_tests(text))
    if not named and not is_trivial(function):
        return "names no test"
    missing = [path for path in named if not (ROOT / path).is_file()]
    return f"names {missing[0]}, which is not there" if missing else None


def test_every_kernel_names_the_test_that_checks_it() -> None:
    trees = {path: ast.parse(path.read_text()) for path in sources(*KERNELS)}
    others = frozenset(name for tree in trees.values() for name in compiled_elsewhere(tree))
    found = [(path, kernel) for path, tree in trees.items() for kernel in kernels(tree, others)]
    assert len(found) > 150
    assert {"to_matrix", "mean_motion"} <= {kernel.name for _, kernel in found}
    wrong = [f"{path.relative_to(ROOT)}: {kernel.name} {fault(kernel)}" for path, kernel in found if fault(kernel)]
    assert wrong == []


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("return x + 1.0", "has no docstring"),
        ('"""More [m]."""\n    return x + 1.0', "names no test"),
        ('"""More [m].\n\n    Checked  tests/test_none.py\n    """\n    return x + 1.0', "names tests/test_none.py"),
        ('"""More [m].\n\n    Checked  tests/consistency/test_docstrings.py\n    """\n    return x + 1.0', None),
        ('"""Nothing."""', None),
        ('"""Nothing."""\n    pass', None),
        ('"""None and none."""\n    return 0.0, 0', None),
        ('"""Itself."""\n    return x', "names no test"),
        ("return 0.0", "has no docstring"),
    ],
)
def test_the_rule_notices(body: str, expected: str | None) -> None:
    for decorator in ("kernel", "view", "entry(interface.dtype)", "njit(inline='always', **OPTIONS)"):
        (function,) = kernels(ast.parse(f"@{decorator}\ndef more(x):\n    {body}\n\n\ndef other(x):\n    return x\n"))
        found = fault(function)
        assert found is None if expected is None else found is not None and found.startswith(expected)


def test_tests_named_in_docstrings_exist() -> None:
    found = [(source, path) for source in sources(*PACKAGES) for path in named_tests(source.read_text())]
    assert len(found) > 250
    missing = sorted({f"{source.relative_to(ROOT)}: {path}" for source, path in found if not (ROOT / path).is_file()})
    assert missing == []


def test_a_line_that_goes_on_is_read_to_its_end() -> None:
    text = "    Checked  tests/a/test_b.py: this,\n             test_c.py: that\n\n    test_d.py is another matter"
    assert list(named_tests(text)) == ["tests/a/test_b.py", "tests/a/test_c.py"]
