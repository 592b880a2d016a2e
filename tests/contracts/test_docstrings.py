"""The docstrings of everything public keep house style: units, shapes, sources, errors and runnable examples.

The rules, in the order in which they are reported:

- Everything public has a docstring whose first line is a sentence.
- Functions, and methods unless they take the short form, have `Parameters` (every argument, no stranger; numbers with
  a unit in brackets, arrays with a shape as well), `Returns` (numbers with a unit), `Raises` (every exception raised
  here or in a private helper of the module) and, in modules of theory, `References` (document and place in it) and
  `Examples`, which run.
- The short form is for methods and properties that raise nothing: one paragraph, holding the unit.
- A dataclass documents its fields, numbers with units and arrays with shapes, under `Attributes` (or `Parameters`) or
  in a comment beside the field: `V: Array  # (...)  true airspeed  [m/s]`.
- Compiled kernels (`*_kernels.py`) are plumbing behind public functions: one paragraph is enough.
"""

from __future__ import annotations

import ast
import doctest
import importlib
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[2] / "src" / "aeroservo"
#: Modules of theory: each formula names its source and shows itself at work.
THEORY = ("aero", "structure", "gust", "flight", "atmosphere", "frames", "aeroelastic", "control", "datatypes")
SECTIONS = ("Parameters", "Attributes", "Returns", "Yields", "Raises", "Warns", "Notes", "References", "Examples")

NUMBER = re.compile(r"\b(float|complex|floating|float64|complex128|ArrayLike|Array|NDArray|ndarray)\b")
ARRAY = re.compile(r"\b(ArrayLike|Array|NDArray|ndarray)\b")
#: [m/s], [-], [unit of x]; not [7.37], [0, 1], tuple[int] or range[...].
UNIT = re.compile(r"(?<![\w\]])\[(?![\d.,;\s–-]+\])[^\[\]]+\]|\[-\]")
SHAPE = re.compile(r"\bshapes?\b|\bscalar\b|\blength\b")
DOCUMENT = re.compile(
    r"\b(1[89]|20)\d\d\b|\.md\b|\b(NACA|AGARD|ISO|CFR|NIST|DLMF|Abramowitz|guide)\b|\b(CS|MIL)-|\bthesis \[|"
    r"Project convention[:,] +\w"
)
PLACE = re.compile(
    r"\b(Eqs?\.|equations?\b|sec(tion|\.)|§|chapters?\b|chap\.|ch\.|tables?\b|figs?\.|figures?\b|pp?\. ?\d|parts?\b|"
    r"appendix\b|no\. ?\d|report \d|theorem)|\[[\w.,– -]*\d+[\w.,– -]*\]|\"[^\"]+\"|`[^`]+`|\d+\(\d+\)|\d\.\d|"
    r"Project convention[:,]",
    re.IGNORECASE,
)

Function = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass(frozen=True, kw_only=True)
class Module:
    """One source file: its syntax tree and what its private helpers raise."""

    name: str
    tree: ast.Module
    lines: list[str]
    functions: dict[str, Function] = field(default_factory=dict)

    @property
    def is_theory(self) -> bool:
        """Whether formulas live here."""
        return any(part in THEORY for part in self.name.split(".")[1:2])

    @property
    def is_kernel(self) -> bool:
        """Whether this is a compiled kernel module."""
        return self.name.endswith("_kernels")


def read(source: str, name: str) -> Module:
    """Module of a source text."""
    tree = ast.parse(source)
    functions: dict[str, Function] = {}
    for node in ast.walk(tree):
        if isinstance(node, Function):
            functions.setdefault(node.name, node)
    return Module(name=name, tree=tree, lines=source.splitlines(), functions=functions)


def modules() -> list[str]:
    """Dotted names of every public module of the package."""
    names = []
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
        parts = parts[:-1] if parts[-1] == "__init__" else parts
        if not any(part.startswith("_") for part in parts):
            names.append(".".join(parts))
    return names


def path_of(name: str) -> Path:
    """Source file of a dotted module name."""
    stem = PACKAGE.parent.joinpath(*name.split("."))
    return stem / "__init__.py" if stem.is_dir() else stem.with_suffix(".py")


def complaints(module: Module) -> list[str]:
    """Every rule broken in a module, as `module:object: what is missing`."""
    found = [] if has_sentence(ast.get_docstring(module.tree)) else [f"{module.name}: no module docstring"]
    for node in module.tree.body:
        if getattr(node, "name", "_").startswith("_"):
            continue
        if isinstance(node, Function):
            found += [f"{module.name}:{node.name}: {c}" for c in check_function(node, module)]
        elif isinstance(node, ast.ClassDef):
            found += [f"{module.name}:{node.name}: {c}" for c in check_class(node, module)]
            is_protocol = any(ast.unparse(base).startswith("Protocol") for base in node.bases)
            for method in [] if is_protocol else node.body:
                if isinstance(method, Function) and (method.name == "__call__" or not method.name.startswith("_")):
                    where = f"{module.name}:{node.name}.{method.name}"
                    found += [f"{where}: {c}" for c in check_function(method, module, in_class=True)]
    return found


def check_function(node: Function, module: Module, *, in_class: bool = False) -> Iterator[str]:
    """Rules broken by one function or method."""
    text = ast.get_docstring(node)
    decorators = [ast.unparse(d) for d in node.decorator_list]
    if not has_sentence(text) or text is None:
        yield "no docstring whose first line is a sentence"
        return
    if module.is_kernel or any(d.endswith((".setter", "overload")) or ".command(" in d for d in decorators):
        return
    sections = split(text)
    returned = ast.unparse(node.returns) if node.returns else ""
    raised = raises(node, module)
    if in_class and not raised and set(sections) <= {""}:
        if is_number(returned) and not UNIT.search(text):
            yield f"one-paragraph docstring without a unit in brackets, though it returns {returned}"
        return
    yield from check_parameters(node, sections.get("Parameters"), in_class=in_class)
    yield from check_returns(returned, sections.get("Returns", sections.get("Yields")))
    for name in sorted(raised - set(re.findall(r"\w+", sections.get("Raises", "")))):
        yield f"raises {name}, which section Raises does not name"
    if module.is_theory:
        yield from check_source(sections.get("References"))
        if ">>>" not in sections.get("Examples", ""):
            yield "no runnable example under Examples"


def check_parameters(node: Function, section: str | None, *, in_class: bool) -> Iterator[str]:
    """Rules broken by section Parameters."""
    starred = [a for a in (node.args.vararg, node.args.kwarg) if a]
    arguments = node.args.posonlyargs + node.args.args + node.args.kwonlyargs + starred
    if in_class and "staticmethod" not in [ast.unparse(d) for d in node.decorator_list]:
        arguments = arguments[1:]
    if not arguments:
        return
    if section is None:
        yield "no section Parameters"
        return
    documented = entries(section)
    for argument in arguments:
        annotation = ast.unparse(argument.annotation) if argument.annotation else ""
        if argument.arg not in documented:
            yield f"parameter {argument.arg} is not documented"
        else:
            yield from check_quantity(f"parameter {argument.arg}", annotation, documented[argument.arg])
    for stranger in sorted(set(documented) - {a.arg for a in arguments}):
        yield f"documents {stranger}, which is no parameter"


def check_returns(returned: str, section: str | None) -> Iterator[str]:
    """Rules broken by section Returns."""
    if returned in ("None", "NoReturn", "Never", ""):
        if returned == "":
            yield "no return annotation"
        return
    if section is None:
        yield "no section Returns"
    elif is_number(returned) and not UNIT.search(section):
        yield "Returns has no unit in brackets"


def check_source(section: str | None) -> Iterator[str]:
    """Rules broken by section References."""
    if section is None:
        yield "no section References"
        return
    if not DOCUMENT.search(section):
        yield "References names no document (author and year, report, or a file of docs/)"
    if not PLACE.search(section):
        yield "References names no place in the document (equation, section, table, page)"


def check_class(node: ast.ClassDef, module: Module) -> Iterator[str]:
    """Rules broken by a class: a sentence, and the fields of a dataclass."""
    text = ast.get_docstring(node)
    if not has_sentence(text) or text is None:
        yield "no docstring whose first line is a sentence"
        return
    if not any("dataclass" in ast.unparse(d) for d in node.decorator_list):
        return
    sections = split(text)
    documented = entries(sections.get("Attributes", "") + "\n" + sections.get("Parameters", ""))
    for item in node.body:
        if not isinstance(item, ast.AnnAssign) or not isinstance(item.target, ast.Name):
            continue
        name, annotation = item.target.id, ast.unparse(item.annotation)
        beside = module.lines[(item.end_lineno or item.lineno) - 1][item.end_col_offset :]
        if name.startswith("_") or "ClassVar" in annotation:
            continue
        if name in documented:
            yield from check_quantity(f"field {name}", annotation, documented[name])
        elif "#" in beside:
            yield from check_quantity(f"field {name}", annotation, re.sub(r"\([^()]*\)", "shape", beside))
        else:
            yield f"field {name} is documented neither under Attributes nor in a comment beside it"


def check_quantity(what: str, annotation: str, text: str) -> Iterator[str]:
    """Unit of a number, shape of an array; masks and counts, named as such, have no unit."""
    annotation = re.sub(r"Callable\[.*\]", "Callable", annotation)
    counts = re.search(r"\b(bool|int|integers?|mask|index|indices|str)\b|\+1", text[:80])
    if not counts and is_number(annotation) and not UNIT.search(text):
        yield f"{what} ({annotation}) has no unit in brackets"
    if ARRAY.search(annotation) and not SHAPE.search(text):
        yield f"{what} ({annotation}) has no shape"


def is_number(annotation: str) -> bool:
    """Whether a type holds numbers with a unit; counts, indices and masks have none."""
    return bool(NUMBER.search(re.sub(r"NDArray\[np\.(int\w*|bool_?)\]", "", annotation)))


def has_sentence(text: str | None) -> bool:
    """Whether the first paragraph is there and ends as a sentence, or in the unit of what it describes."""
    first = split(text or "")[""].strip().split("\n\n")[0].rstrip()
    return first.endswith((".", ":", "]", ")", "?"))


def split(text: str) -> dict[str, str]:
    """Numpydoc sections of a docstring; the key of what stands before the first is empty."""
    sections, current = {"": ""}, ""
    lines = text.splitlines()
    for line, following in zip(lines, [*lines[1:], ""]):
        heading = line.strip()
        if heading in SECTIONS and re.fullmatch(r"\s*-{3,}\s*", following):
            current = heading
            sections[current] = ""
        elif not re.fullmatch(r"\s*-{3,}\s*", line):
            sections[current] += line + "\n"
    return sections


def entries(section: str) -> dict[str, str]:
    """Text of each `name, name : type` entry of a section, the type line included."""
    found: dict[str, str] = {}
    names: list[str] = []
    for line in section.splitlines():
        match = re.match(r"^([*\w]+(?:, *[*\w]+)*)\s*(:.*)?$", line)
        if match:
            names = [name.strip().lstrip("*") for name in match[1].split(",")]
            found |= dict.fromkeys(names, "")
            line = match[2] or ""
        for name in names:
            found[name] += line + "\n"
    return found


def raises(node: Function, module: Module, seen: frozenset[str] = frozenset()) -> set[str]:
    """Names of the exceptions raised in a function and, through private helpers of the same module, below it."""
    found = set()
    for item in body_nodes(node):
        if isinstance(item, ast.Raise) and item.exc is not None:
            name = ast.unparse(item.exc.func if isinstance(item.exc, ast.Call) else item.exc)
            if re.fullmatch(r"[A-Z]\w*", name):
                found.add(name)
        if isinstance(item, ast.Call):
            called = item.func.attr if isinstance(item.func, ast.Attribute) else getattr(item.func, "id", "")
            is_ours = isinstance(item.func, ast.Name) or ast.unparse(item.func).startswith(("self.", "cls."))
            helper = module.functions.get(called)
            if is_ours and helper and called.startswith("_") and called not in seen:
                found |= raises(helper, module, seen | {called})
    return found - {"NotImplementedError", "AssertionError"}


def body_nodes(node: ast.AST) -> Iterator[ast.AST]:
    """Nodes of a function, except what is caught by a `try` around it or belongs to a function defined inside."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, Function | ast.Lambda | ast.ClassDef):
            continue
        yield child
        if isinstance(child, ast.Try) and child.handlers:
            for part in [*child.handlers, *child.orelse, *child.finalbody]:
                yield from body_nodes(part)
        else:
            yield from body_nodes(child)


@pytest.mark.parametrize("name", modules())
def test_docstrings_keep_house_style(name: str) -> None:
    """Every public object of every module, by its syntax tree: nothing is imported."""
    found = complaints(read(path_of(name).read_text(encoding="utf-8"), name))
    if found:
        pytest.fail(f"{len(found)} to mend (rules: CONTRIBUTING.md, Docstrings)\n" + "\n".join(found), pytrace=False)


@pytest.mark.parametrize("name", modules())
def test_examples_run(name: str) -> None:
    """Every example of a module prints what it says."""
    flags = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    lines: list[str] = []
    runner = doctest.DocTestRunner(optionflags=flags)
    for case in doctest.DocTestFinder(exclude_empty=True).find(importlib.import_module(name)):
        runner.run(case, out=lines.append)
    if runner.failures:
        pytest.fail("".join(lines), pytrace=False)


GOOD = '''"""Things of theory."""
def lift(alpha: ArrayLike, *, slope: float = 6.28) -> Array:
    """Lift coefficient of a thin section.

    Parameters
    ----------
    alpha : array_like, shape (...)
        Incidence. [rad]
    slope : float
        Lift slope. [1/rad]

    Returns
    -------
    cl : ndarray, shape (...)
        Lift coefficient. [-]

    Raises
    ------
    ValueError
        If alpha is not finite.

    References
    ----------
    Glauert 1926, Eq. 7.1.

    Examples
    --------
    >>> 1 + 1
    2
    """
    return _checked(alpha) * slope

def _checked(x):
    if x is None:
        raise ValueError("x")
    return x

@dataclass(frozen=True)
class Wing:
    """A wing, one field documented beside itself.

    Attributes
    ----------
    c, s : float
        Chord and semi-span. [m]
    EI : ndarray, shape (n,)
        Bending stiffness. [N m^2]
    name : str
        What to call it.
    """

    c: float
    s: float
    EI: Array
    name: str
    q: Array  # (...)  dynamic pressure  [Pa]

    @property
    def area(self) -> float:
        """Area of the half wing. [m^2]"""
        return self.c * self.s
'''


def test_the_good_sample_passes() -> None:
    """The sample that the next test spoils breaks no rule."""
    assert complaints(read(GOOD, "aeroservo.aero.sample")) == []


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ('"""Things of theory."""', "", "no module docstring"),
        ("Lift coefficient of a thin section.", "", "sentence"),
        ("Incidence. [rad]", "Incidence, see [7.37], in [0, 1].", "parameter alpha (ArrayLike) has no unit"),
        ("alpha : array_like, shape (...)", "alpha : array_like", "parameter alpha (ArrayLike) has no shape"),
        ("    slope : float\n        Lift slope. [1/rad]\n", "", "parameter slope is not documented"),
        ("*, slope: float = 6.28", "", "documents slope, which is no parameter"),
        ("Parameters\n    ----------\n    alpha", "Notes\n    -----\n    alpha", "no section Parameters"),
        ("Lift coefficient. [-]", "Lift coefficient.", "Returns has no unit"),
        ("Returns\n    -------", "Notes\n    -----", "no section Returns"),
        ("Raises\n    ------", "Notes\n    -----", "raises ValueError, which section Raises does not name"),
        ("References\n    ----------", "Notes\n    -----", "no section References"),
        ("Glauert 1926, Eq. 7.1.", "Eq. 7.1.", "names no document"),
        ("Glauert 1926, Eq. 7.1.", "Glauert 1926.", "names no place"),
        (">>> 1 + 1", "1 + 1", "no runnable example"),
        ("Chord and semi-span. [m]", "Chord and semi-span.", "field c (float) has no unit"),
        ("EI : ndarray, shape (n,)", "EI : ndarray", "field EI (Array) has no shape"),
        ("    name : str\n        What to call it.\n", "", "field name is documented neither"),
        ("  # (...)  dynamic pressure  [Pa]", "", "field q is documented neither"),
        ("dynamic pressure  [Pa]", "dynamic pressure", "field q (Array) has no unit"),
        ("(...)  dynamic pressure  [Pa]", "dynamic pressure  [Pa]", "field q (Array) has no shape"),
        ("Area of the half wing. [m^2]", "Area of the half wing.", "without a unit"),
    ],
)
def test_each_rule_bites(old: str, new: str, complaint: str) -> None:
    """Each rule, broken alone in a good module, is reported."""
    assert old in GOOD
    found = complaints(read(GOOD.replace(old, new), "aeroservo.aero.sample"))
    assert any(complaint in line for line in found), found


def test_a_wrong_example_fails() -> None:
    """The doctest route sees a wrong answer: the runner used above reports it."""
    case = doctest.DocTestParser().get_doctest(">>> 1 + 1\n3\n", {}, "wrong", None, None)
    assert doctest.DocTestRunner().run(case, out=lambda _: None).failed == 1
