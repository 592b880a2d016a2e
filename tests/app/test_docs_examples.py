"""Every example of the documentation runs and prints what its page says.

A fenced block `console` holds commands after `$ ` and, under each, lines of its output: all of them have to occur, in
order, where `...` stands for anything and runs of blanks count as one. Blocks `python` of a page share one namespace;
a line `expr  # = text` has to print that text. Pages run in a folder of their own, block after block.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable, Iterator
from fnmatch import translate
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted([ROOT / "README.md", *(ROOT / "docs").rglob("*.md")])
FENCE = re.compile(r"^```(console|python)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def blocks(page: Path) -> list[tuple[str, str]]:
    """Language and text of each example of a page."""
    return FENCE.findall(page.read_text(encoding="utf-8"))


def commands(block: str) -> Iterator[tuple[str, list[str]]]:
    """Command and the lines expected of it."""
    command, expected = "", list[str]()
    for line in block.splitlines():
        if line.startswith("$ "):
            if command:
                yield command, expected
            command, expected = line[2:], []
        elif line.strip():
            expected.append(line)
    if command:
        yield command, expected


def missing(expected: list[str], output: str) -> str | None:
    """The first expected line that does not occur in the rest of an output."""
    lines = iter([" ".join(line.split()) for line in output.splitlines()])
    for want in expected:
        text = " ".join(want.split())
        pattern = re.compile(translate(re.sub(r"([\[\]?*])", r"[\1]", text).replace("...", "*")))
        if not any(pattern.fullmatch(line) for line in lines):
            return want
    return None


def run_console(block: str, cli: Callable[..., Any]) -> None:
    """Run the commands of a block; compare."""
    for command, expected in commands(block):
        words = shlex.split(command, comments=True)
        assert words[0] == "aeroservo", f"only aeroservo is run here: {command}"
        answer = cli(*words[1:])
        assert answer.code == 0, f"{command}: exit {answer.code}\n{answer.err}"
        output = answer.err + answer.out
        lost = missing(expected, output)
        assert lost is None, f"{command}: no line {lost!r} (in this order) in\n{output}"


def run_python(block: str, names: dict[str, object]) -> None:
    """Run a block; compare what `# =` promises."""
    exec(compile(block, "example", "exec"), names)
    for line in block.splitlines():
        if match := re.fullmatch(r"(\S.*?)  # = (.*)", line):
            shown = str(eval(match[1], names))
            assert missing([match[2]], shown) is None, f"{match[1]} is {shown}, the page says {match[2]}"


@pytest.mark.parametrize("page", [p for p in PAGES if blocks(p)], ids=lambda p: p.stem)
def test_examples_of_a_page_run(
    page: Path, cli: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for language, block in blocks(page):
        if language == "console":
            run_console(block, cli)
        else:
            run_python(block, names)


def test_the_comparison_bites(cli: Callable[..., Any]) -> None:
    assert missing(["flutter  49.2 m/s"], "flutter     49.2 m/s") is None
    assert missing(["flutter  49.3 m/s"], "flutter     49.2 m/s") == "flutter  49.3 m/s"
    assert missing(["b", "a"], "a\nb") == "a"
    assert missing(["flutter 49... m/s"], "flutter 49.163 m/s") is None
    assert missing(["a [b]"], "a [b]") is None and missing(["a [b]"], "a b") == "a [b]"
    with pytest.raises(AssertionError, match="the page says 3"):
        run_python("x = 2\nx  # = 3\n", {})
    with pytest.raises(AssertionError, match="exit 2"):
        run_console("$ aeroservo flutter no-such-model\n", cli)
