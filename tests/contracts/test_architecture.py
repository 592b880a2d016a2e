"""House rules that a syntax tree can check: budgets, kernels, module names, star imports, open keyword arguments.

Budgets: a module has at most 400 lines; a function has at most 60, its docstring not counted. Above a budget, split,
or say why in the module docstring with the words "Over budget because".
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCES = sorted((ROOT / "src" / "aeroservo").rglob("*.py"))
MODULE_LINES, FUNCTION_LINES = 400, 60
EXCUSE = "Over budget because"
NAMELESS = {"utils", "util", "core", "common", "helpers", "misc"}
COMPILED = {"numba", "llvmlite"}


def complaints(path: Path, source: str) -> list[str]:
    """Every rule that a source file breaks."""
    tree = ast.parse(source)
    return [*over_budget(tree, source), *named_for_nothing(path), *imports_wrongly(path, tree), *open_calls(tree)]


def over_budget(tree: ast.Module, source: str) -> Iterator[str]:
    """Modules and functions that are too long and do not say why."""
    if EXCUSE in " ".join((ast.get_docstring(tree) or "").split()):
        return
    lines = len(source.splitlines())
    if lines > MODULE_LINES:
        yield f"{lines} lines, budget {MODULE_LINES}"
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            first = node.body[1:] if ast.get_docstring(node) is not None else node.body
            start = first[0].lineno if first else node.end_lineno
            lines = (node.end_lineno or 0) - (start or 0) + 1 + (node.body[0].lineno - node.lineno)
            if lines > FUNCTION_LINES:
                yield f"{node.name} has {lines} lines without its docstring, budget {FUNCTION_LINES}"


def named_for_nothing(path: Path) -> Iterator[str]:
    """Modules whose name says nothing about the theory in them."""
    if path.stem.lstrip("_") in NAMELESS:
        yield f"the name {path.stem} says nothing: name the module after what is in it"


def imports_wrongly(path: Path, tree: ast.Module) -> Iterator[str]:
    """Star imports; compilers outside kernels; anything of ours inside them."""
    is_kernel = path.stem.endswith("_kernels")
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and any(alias.name == "*" for alias in node.names):
            yield f"line {node.lineno}: import *"
        for name in imported(node):
            top = name.split(".")[0]
            if top in COMPILED and not is_kernel:
                yield f"line {node.lineno}: {top} outside a *_kernels.py module"
            if top in ("aeroservo", "") and is_kernel:
                yield f"line {node.lineno}: a kernel module imports nothing of ours"
        if isinstance(node, ast.FunctionDef) and is_kernel:
            for decorator in node.decorator_list:
                text = ast.unparse(decorator)
                if "jit" in text and "cache=True" not in text:
                    yield f"{node.name}: compiled without cache=True, so every process pays for it again"


def imported(node: ast.AST) -> list[str]:
    """Dotted names that an import statement names; relative imports begin with a dot."""
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    if isinstance(node, ast.ImportFrom):
        return ["." * node.level + (node.module or "")]
    return []


def open_calls(tree: ast.Module) -> Iterator[str]:
    """Public functions and methods that take **kwargs: what they accept is written nowhere."""
    owners = [tree, *(n for n in tree.body if isinstance(n, ast.ClassDef) and not n.name.startswith("_"))]
    for owner in owners:
        for node in owner.body:
            is_public = isinstance(node, ast.FunctionDef) and (
                not node.name.startswith("_") or node.name in ("__call__", "__init__")
            )
            if is_public and node.args.kwarg:
                yield f"{node.name} takes **{node.args.kwarg.arg}: name the arguments"


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT / "src")))
def test_module_keeps_the_rules(path: Path) -> None:
    """Every module of the package."""
    found = complaints(path, path.read_text(encoding="utf-8"))
    if found:
        pytest.fail("\n".join(f"{path.relative_to(ROOT)}: {complaint}" for complaint in found), pytrace=False)


def test_there_are_sources() -> None:
    """The test above looks at something."""
    assert len(SOURCES) > 10


@pytest.mark.parametrize(
    ("name", "source", "complaint"),
    [
        ("beam", "x = 1\n" * 401, "401 lines, budget 400"),
        ("beam", "def f():\n" + "    x = 1\n" * 60, "f has 61 lines"),
        ("utils", "", "says nothing"),
        ("_common", "", "says nothing"),
        ("beam", "from numpy import *", "import *"),
        ("beam", "def f():\n    from numba import njit", "numba outside"),
        ("vlm_kernels", "from aeroservo.datatypes import frozen", "nothing of ours"),
        ("vlm_kernels", "from . import vlm", "nothing of ours"),
        ("vlm_kernels", "@njit\ndef f(): ...", "without cache=True"),
        ("beam", "def f(**options): ...", "f takes **options"),
        ("beam", "class A:\n    def __call__(self, **options): ...", "__call__ takes **options"),
    ],
)
def test_each_rule_bites(name: str, source: str, complaint: str) -> None:
    """Each rule, broken on purpose, is reported."""
    assert any(complaint in found for found in complaints(Path(f"{name}.py"), source))


@pytest.mark.parametrize(
    ("name", "source"),
    [
        ("beam", "x = 1\n" * 400),
        ("beam", '"""A page. Over budget\nbecause the type is one table."""\n' + "x = 1\n" * 500),
        ("beam", 'def f():\n    """' + "\n" * 80 + '"""\n' + "    x = 1\n" * 59),
        ("vlm_kernels", "from numba import njit\n@njit(cache=True)\ndef f(): ..."),
        ("beam", "def _f(**options): ..."),
    ],
)
def test_what_is_allowed_passes(name: str, source: str) -> None:
    """The near side of each rule is not reported."""
    assert complaints(Path(f"{name}.py"), source) == []


def test_test_files_have_their_own_names() -> None:
    """No two test files share a name, so that a failure is found in one guess."""
    names = Counter(path.name for path in (ROOT / "tests").rglob("test_*.py"))
    assert [name for name, count in names.items() if count > 1] == []
