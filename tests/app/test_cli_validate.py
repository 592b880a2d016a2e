"""`validate`: the contract's JSON, a case that fails, a case that does not exist; every case file is well formed."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from aeroservo.studies import validation
from aeroservo.studies.case_calls import evaluated

Cli = Callable[..., Any]
COMMON = {"schema_version", "model", "altitude_m", "density_kg_m3", "warnings"}


def test_validate_json(cli: Cli) -> None:
    """Keys of the contract; the binary wing passes; difference, tolerance and pass agree with each other."""
    answer = cli("validate", "binary_wing", "--json")
    assert answer.code == 0, answer.err
    assert set(answer.json) == COMMON | {"cases", "not_yet_computed"}
    assert len(answer.json["cases"]) == 8
    for row in answer.json["cases"]:
        assert set(row) == {"name", "quantity", "reference", "result", "difference", "tolerance", "citation", "pass"}
        assert row["difference"] == pytest.approx(row["result"] - row["reference"], abs=1e-12)
        assert row["pass"] is (abs(row["difference"]) <= row["tolerance"])
        assert row["pass"] is True
        assert "Wright" in row["citation"]
        assert 0.0 < row["tolerance"] <= 1e-3 * row["reference"]


def test_validate_for_people(cli: Cli) -> None:
    """The table says how many pass, and names its sources."""
    answer = cli("validate", "typical_section")
    assert answer.code == 0
    assert re.search(r"\b(\d+) of \1 pass", answer.out)
    assert "NASA/TP-2015-218765" in answer.out


def case_folder(folder: Path, text: str) -> None:
    """A folder of cases with one case in it."""
    (folder / "mine").mkdir()
    (folder / "mine" / "runs.toml").write_text(text, encoding="utf-8")


RUN = """
citation = "nobody"
[[run]]
what = "modes"
model = "wright-cooper-binary"
analysis = "modes"
[[run.check]]
quantity = "frequencies_rad_s[0]"
reference = {reference}
{tolerance}
"""


@pytest.mark.parametrize(
    ("reference", "tolerance", "code"),
    [
        (17.75, "relative = 1e-3", 0),
        (17.75, "relative = 1e-5", 1),
        (17.0, "absolute = 1.0", 0),
        (17.0, "absolute = 0.5", 1),
    ],
)
def test_a_folder_is_a_case_and_may_fail(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, reference: float, tolerance: str, code: int
) -> None:
    """A new case is a folder and no code; one that misses its tolerance makes the exit code 1."""
    case_folder(tmp_path, RUN.format(reference=reference, tolerance=tolerance))
    monkeypatch.setattr(validation, "CASES", tmp_path)
    answer = cli("validate", "--json")
    assert answer.code == code
    assert answer.json["cases"][0]["pass"] is (code == 0)
    assert ("FAIL" in cli("validate").out) is (code == 1)


def test_no_result_is_a_failure() -> None:
    """A speed that was not found does not pass."""
    check = validation.Check(name="x", quantity="v", reference=1.0, result=None, tolerance=9.0, citation="")
    assert check.difference is None
    assert not check.passed


def test_unknown_case(cli: Cli) -> None:
    """An unknown case is code 2, with those that exist."""
    answer = cli("validate", "../goland", "--json")
    assert (answer.code, answer.out) == (2, "")
    assert "goland" in answer.err


def test_misspelt_keys_of_a_case_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A tolerance under another name would be no tolerance."""
    case_folder(tmp_path, RUN.format(reference=1.0, tolerance="relatif = 1e-3\nrelative = 1.0"))
    monkeypatch.setattr(validation, "CASES", tmp_path)
    with pytest.raises(ValueError, match="relatif"):
        validation.validate()


#: Largest relative tolerance of cases whose reference is another lattice's or another theory's, or a wind tunnel's;
#: SOURCE.md: why.
BETWEEN_PROGRAMS = {"thesis_wing": 0.03, "lifting_surface": 0.01, "hale_wing": 0.012, "bact": 0.03}


def test_what_cannot_be_computed_is_listed(cli: Cli) -> None:
    """Unsteady lattices: named with the published value, in words and in JSON, never passed."""
    answer = cli("validate", "goland", "--json")
    (missing,) = answer.json["not_yet_computed"]
    assert "163" in missing["reference"] and "lattice" in missing["why"] and "1945" in missing["citation"]
    assert {m.name.split(":")[0] for m in validation.not_yet_computed()} == {"goland", "thesis_wing"}
    assert "Not yet computed:\n  goland" in cli("validate", "goland").out


def test_a_case_may_bring_its_own_model(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A model file beside runs.toml is found there."""
    text = RUN.format(reference=17.75188, tolerance="relative = 1e-4").replace("wright-cooper-binary", "wing.toml")
    case_folder(tmp_path, text)
    preset = Path(validation.__file__).parents[1] / "aircraft" / "presets" / "wright-cooper-binary.toml"
    (tmp_path / "mine" / "wing.toml").write_text(preset.read_text(encoding="utf-8"), encoding="utf-8")
    monkeypatch.setattr(validation, "CASES", tmp_path)
    (check,) = validation.validate()
    assert check.passed


def test_the_book_of_the_docs_is_current(cli: Cli, tmp_path: Path) -> None:
    """Every comparison of every case stands in docs/validation.md with its reference and passes; nothing else does."""
    answer = cli("validate", "--markdown", tmp_path / "new.md")
    assert answer.code == 0, answer.err
    kept = (Path(__file__).parents[2] / "docs" / "validation.md").read_text(encoding="utf-8")

    def rows(text: str) -> list[list[str]]:
        cells = [[c.strip() for c in line.split(" | ")] for line in text.splitlines() if line.startswith("| ")]
        return [
            [c[0], re.sub(r" \(number .*", "", c[1]), *([c[2]] if "number" not in c[1] else []), c[-1]] for c in cells
        ]

    new = (tmp_path / "new.md").read_text(encoding="utf-8")
    assert rows(kept) == rows(new), "run: aeroservo validate --markdown docs/validation.md"
    headings = [[line for line in text.splitlines() if line.startswith(("#", "- "))] for text in (kept, new)]
    assert headings[0] == headings[1]


@pytest.mark.parametrize("name", validation.cases())
def test_case_files_are_complete(name: str) -> None:
    """Each case cites its source, has a SOURCE.md, and gives every check one tight tolerance."""
    folder = validation.CASES / name
    content = tomllib.loads((folder / "runs.toml").read_text(encoding="utf-8"))
    assert content["citation"]
    assert "Tolerance" in (folder / "SOURCE.md").read_text(encoding="utf-8")
    for run in content["run"]:
        assert run["check"]
        for check in run["check"]:
            assert ("relative" in check) != ("absolute" in check)
            assert check.get("relative", 0.0) <= BETWEEN_PROGRAMS.get(name, 1e-3)
            if "absolute" in check and isinstance(check["reference"], float | int) and check["reference"]:
                assert check["absolute"] <= 0.025 * abs(check["reference"])


def test_an_argument_may_be_called_name() -> None:
    """Only a table that holds nothing but `name` stands for an object of the package."""
    arguments = {"name": "fin", "sections": [], "mirrored": False}
    assert evaluated(arguments, {}) == arguments
    assert evaluated({"name": "studies.case_calls.evaluated"}, {}) is evaluated
