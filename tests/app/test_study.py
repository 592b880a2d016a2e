"""`aeroservo study thesis`: every figure and table is there, numbers are those of the runs, verdicts can fall."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from aeroservo.report import thesis_folder
from aeroservo.report.thesis_drawings import entry_figure
from aeroservo.report.thesis_folder import MADE_BY, book_json, prepare_folder, write_study
from aeroservo.report.thesis_parts import thesis_parts
from aeroservo.report.thesis_text import PICTURES, markdown, picture_name
from aeroservo.studies import thesis_study
from aeroservo.studies.thesis_design_claims import design_claims
from aeroservo.studies.thesis_flight_claims import flight_claims
from aeroservo.studies.thesis_linear_figures import linear_claims
from aeroservo.studies.thesis_records import Compared, Curve, number, verdict
from aeroservo.studies.thesis_study import ThesisBook, thesis_book

Cli = Callable[..., Any]
DOCS = Path(__file__).parents[2] / "docs" / "thesis.md"
#: The figures with computed content (1, 7, 8, 12, 13 and 20 are drawings or diagrams without numbers).
FIGURES = (*range(2, 7), *range(9, 12), *range(14, 20), *range(21, 41))


@pytest.fixture(scope="module")
def book() -> ThesisBook:
    """Few speeds, points and seeds: boundaries are refined whatever the step."""
    return thesis_book(
        speeds=np.arange(10.0, 131.0, 10.0), k=np.geomspace(3e-4, 1.6, 31), points=3, seeds=range(3)
    )  # fmt: skip


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch, book: ThesisBook) -> None:
    """The commands with that book."""
    monkeypatch.setattr(thesis_study, "thesis_book", lambda *, progress: book)


class Page(HTMLParser):
    """What a page asks for."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.asks: list[str] = []
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Collect."""
        self.asks += [v for name, v in attrs if name in ("src", "href", "srcset", "action") and v]


def test_every_figure_and_table(book: ThesisBook) -> None:
    """All of them, in order, each with what the thesis says and what comes out."""
    names = [e.number for e in book.entries]
    assert names == ["Table 1", *(f"Fig. {n}" for n in FIGURES), "Eqs. 7.34-7.36"]
    for entry in book.entries:
        assert entry.thesis and entry.finding and (entry.plots or entry.compared)
        assert "nan" not in entry.finding.split() and "None" not in entry.finding
    anchors = [part.anchor for part in thesis_parts(book, pictures=False)]
    assert len(set(anchors)) == len(anchors) == len(names) + 3


def test_tables_2_and_3_are_complete(book: ThesisBook) -> None:
    """Four analytic and the simulation columns, three speeds each, and the sounder method beside each."""
    cells = {(c.table, c.column, c.quantity): c for c in book.cells}
    assert len(cells) == len(book.cells) == 5 * 3 + 6 * 3
    for c in book.cells:
        assert c.ours is not None and c.sound is not None and c.method and c.reason
    assert [cells[2, "simulation_lqr", q].thesis for q in ("flutter", "divergence", "reversal")] == ["66", "NA", "51"]
    wanted = {
        (2, "binary_quasi", "flutter"): (49.1632, 62.12198),
        (3, "binary_quasi", "flutter"): (56.7719, 70.50004),
        (2, "aircraft_quasi", "flutter"): (48.1655, 62.30104),
        (3, "aircraft_quasi", "flutter"): (55.3472, 69.3271),
        (2, "binary_quasi", "divergence"): (81.00479, 81.00479 * np.pi / np.sqrt(12.0)),
        (3, "aircraft_unsteady", "reversal"): (64.0, None),
        (3, "simulation_lqr", "flutter"): (58.618, None),
        (2, "simulation_lqr", "flutter"): (50.374, None),
        (3, "simulation_lqr", "divergence"): (58.618, 124.05),
        (3, "simulation_adaptive", "reversal"): (53.29, 35.49),
        (3, "simulation_adaptive", "divergence"): (124.05, 124.05),
    }
    for key, (ours, sound) in wanted.items():
        assert cells[key].ours == pytest.approx(ours, abs=0.01), key
        if sound is not None:
            assert cells[key].sound == pytest.approx(sound, abs=0.01), key
    assert cells[3, "simulation_lqr", "flutter"].difference == pytest.approx(58.618 - 59.0, abs=0.01)
    assert cells[3, "simulation_adaptive", "flutter"].difference is None  # ">120" is no number
    assert "k 0.0008" in str(cells[3, "binary_unsteady", "flutter"].ours)


def test_claims_follow_from_numbers(book: ThesisBook) -> None:
    """Known verdicts; and each turns when its numbers do."""
    said = {c.statement: c.verdict for c in book.claims}
    assert len(said) == len(book.claims) >= 30
    for words, wanted in (
        ("best L/D with the flap 10", "holds"),
        ("morphed elevon gives more lift", "holds in part"),
        ("flutter comes first", "holds in part"),
        ("unsteady terms sometimes", "holds in part"),
        ("rigid-body freedom", "holds in part"),
        ("by at most 13 m/s", "holds in part"),
        ("reversal ends the LQR", "does not hold"),
        ("outputs must be reversed", "holds in part"),
        ("beyond 120 m/s", "holds"),
        ("integrals of plunge and pitch", "does not hold"),
        ("Mach 0.3", "holds"),
    ):
        (found,) = [v for s, v in said.items() if words in s]
        assert found == wanted, words

    def of(claims: Any, words: str) -> str:
        return next(c.verdict for c in claims if words in c.statement)

    f, a = book.flight, book.aeroelastic
    late = replace(f, lost={3048.0: 52.0, 0.0: 40.0})
    assert of(flight_claims(late, a), "reversal ends the LQR") == "holds"
    slow = replace(f.climbs["switch"], reached=(100.0, 110.0, 90.0))
    assert of(flight_claims(replace(f, climbs=f.climbs | {"switch": slow}), a), "beyond 120") == "does not hold"
    flipped = {k: -np.abs(v) for k, v in f.growth.items()}
    assert of(flight_claims(replace(f, growth=flipped), a), "outputs must be reversed") == "holds"
    slack = replace(book.appendix, settling=20.0)
    assert of(linear_claims(slack), "settles in about 6 s") == "does not hold"
    even = replace(book.design, efficiency={0.0: np.eye(10)[3], 23.0: np.eye(10)[3]})
    assert of(design_claims(even), "taper of 0.4") == "holds"


def test_numbers_of_figures(book: ThesisBook) -> None:
    """What other tests and published values say."""
    found = {(e.number, c.what): c.ours for e in book.entries for c in e.compared}
    assert found["Fig. 2", "thickness"] == pytest.approx(9.30, abs=0.005)
    assert found["Fig. 16", "BACT, flutter in the tunnel"] == pytest.approx(149.08, abs=0.1)
    assert found["Fig. 37", "reversal"] == pytest.approx(53.29, abs=0.02)
    assert found["Fig. 36", "still air, 10,000 ft"] == pytest.approx(58.618, abs=0.01)
    assert found["Fig. 40", "largest real part of the poles"] < 0.0
    assert book.flight.servo_root == pytest.approx(10.3 + 74.5j, abs=0.05)
    np.testing.assert_allclose(book.flight.gain, [[-6.783, -1.69, -0.573, -0.916]], atol=1e-3)
    (plunge,) = [z for z in book.flight.zero_curves if z.sensor == "plunge_m"]
    assert plunge.crossings == pytest.approx((53.29,), abs=0.01)
    assert book.appendix.integrals == (5, 6)
    assert book.design.efficiency[0.0].max() < 1.0 + 1e-3


def test_curves_are_those_of_the_runs(book: ThesisBook) -> None:
    """Fig. 26 by its formulas; Figs 27, 28 mark their flutter; a held k breaks where it changes branch."""
    (plot,) = book.entry("Fig. 26").plots
    run = book.aeroelastic.study.run("binary", 3048.0, "quasi_steady_damped")
    curves = {c.name.split(",")[0]: c for c in plot.curves}
    V_D, V_R = run.static.divergence.V, run.static.reversal.V
    assert V_D is not None and V_R is not None
    twist = curves["twist"]
    part = (twist.x / V_D) ** 2  # one shape of twist: proportional to q/(q_D - q)
    assert twist.y[-1] == pytest.approx(100.0)
    np.testing.assert_allclose(twist.y, 100.0 * part / (1.0 - part) * (1.0 - part[-1]) / part[-1], rtol=1e-6)
    effect = curves["roll effectiveness"]
    known = np.isfinite(effect.y)
    np.testing.assert_allclose(effect.y[known], 100.0 * (1.0 - (effect.x[known] / V_R) ** 2), atol=1e-6)
    damping = curves["damping of torsion 1"]
    past = int(np.searchsorted(damping.x, run.flutter.flutter_speed))
    assert np.all(damping.y[:past] < 0.0) and damping.y[past] > 0.0
    for name in ("Fig. 27", "Fig. 28"):
        assert len(book.entry(name).plots) == 6
        assert all(p.marks and p.marks[0][1] == "flutter" for p in book.entry(name).plots)
    held = book.entry("Eqs. 7.34-7.36").plots
    assert len(held) == 4
    assert any(np.isnan(c.y[1:-1]).any() for p in held for c in p.curves)


def test_figures_can_be_drawn(book: ThesisBook) -> None:
    """Each on its own axes, every axis named; nothing lies outside its figure."""
    for entry in book.entries:
        figure = entry_figure(entry)
        assert (figure is None) == (not entry.plots and entry.surface is None)
        if figure is None or entry.number not in ("Fig. 5", "Fig. 23", "Fig. 30", "Fig. 40"):
            continue
        FigureCanvasAgg(figure).draw()
        for ax in figure.axes:
            if ax.axison and ax.lines:
                assert ax.get_xlabel()
                box = ax.get_window_extent()
                assert box.x0 >= 0 and box.x1 <= figure.bbox.x1


@pytest.mark.usefixtures("quick")
def test_demo(cli: Cli, tmp_path: Path, book: ThesisBook) -> None:
    """Both tables, then where the page lies; page and results, and again over itself."""
    folder = tmp_path / "new" / "folder"
    answer = cli("demo", "--out", folder)
    assert answer.code == 0, answer.err
    lines = answer.out.splitlines()
    for words in (
        ("binary quasi", "flutter", "49", "49.16", "+0.16", "62.12"),
        ("aircraft quasi", "flutter", "55", "55.35", "+0.35"),
        ("simulated LQR", "flutter", "59", "58.62", "-0.38", "stable to 130"),
        ("simulated switch", "divergence", "124", "124.05"),
    ):
        assert any(all(word in line for word in words) for line in lines), words
    assert max(len(line) for line in lines[:-1]) <= 80
    assert "\x1b" not in answer.out
    assert re.search(r"\d+ claims of the thesis: \d+ hold", answer.out)
    assert lines[-1] == str(folder / "index.html")
    assert {p.name for p in folder.iterdir()} == {"index.html", "results.json"}
    content = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    assert content == json.loads(json.dumps(book_json(book), allow_nan=False))
    again = cli("demo", "--out", folder, "--json")
    assert again.code == 0
    assert "replacing the earlier study" in again.err
    assert again.json["page"] == str(folder / "index.html")
    assert len(again.json["tables"]) == 33


@pytest.mark.usefixtures("quick")
def test_page_is_self_contained(cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One page alone; no request leaves it; the Markdown beside it with its pictures."""
    drawn = thesis_folder.entry_figure
    monkeypatch.setattr(thesis_folder, "PICTURES", ("Fig. 4",))
    monkeypatch.setattr(thesis_folder, "entry_figure", lambda entry: drawn(entry) if entry.number == "Fig. 4" else None)
    answer = cli("study", "thesis", "-o", tmp_path / "thesis.html", "--markdown", tmp_path / "thesis.md")
    assert answer.code == 0, answer.err
    page = Page((tmp_path / "thesis.html").read_text(encoding="utf-8"))
    assert all(ask.startswith(("#", "data:")) for ask in page.asks)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["img", "thesis.html", "thesis.md"]
    assert (tmp_path / "img" / "thesis" / "fig-4.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.usefixtures("quick")
@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("nothing",), "no study named 'nothing'"),
        (("thesis", "-o", "x/y/z.html"), "its folder does not exist"),
        (("thesis", "-o", "page.html", "--figures"), "needs a folder"),
        (("thesis", "--markdown", "x.txt"), "must end in .md"),
    ],
)
def test_refused(cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: Any, says: str) -> None:
    """Before any work, with the reason, nothing written."""
    monkeypatch.chdir(tmp_path)
    answer = cli("study", *arguments)
    assert (answer.code, answer.out) == (2, "")
    assert says in answer.err
    assert list(tmp_path.iterdir()) == []


def test_figures_on_request_and_a_disk_that_fills(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, book: ThesisBook
) -> None:
    """PNG and PDF of every figure; the page comes last, so what can be opened is complete."""
    few = replace(book, entries=tuple(book.entry(n) for n in ("Fig. 2", "Fig. 17")))
    assert not prepare_folder(tmp_path)
    write_study(few, tmp_path, figures=True)
    assert {p.name for p in tmp_path.iterdir()} == {"fig-2.png", "fig-2.pdf", "index.html", "results.json"}
    (tmp_path / "index.html").unlink()
    real = thesis_folder.write_whole

    def full(path: Path, content: bytes) -> None:
        if path.suffix == ".html":
            raise OSError(28, "No space left on device")
        real(path, content)

    monkeypatch.setattr(thesis_folder, "write_whole", full)
    with pytest.raises(ValueError, match="cannot be written: No space left"):
        write_study(few, tmp_path)
    assert "index.html" not in os.listdir(tmp_path)
    assert prepare_folder(tmp_path)


def table_numbers(text: str, heading: str) -> dict[tuple[str, str], list[float]]:
    """Rows of a table of speeds: the numbers in thesis, ours and sounder."""
    part = text.split(f"## {heading}")[1].split("\n## ")[0]
    rows = [[c.strip() for c in line.strip("|").split("|")] for line in part.splitlines() if line.startswith("| ")]
    found = {}
    for row in rows[1:]:
        found[row[0], row[1]] = [float(x) if re.fullmatch(r"[-+]?[\d.]+", x) else np.nan for x in (*row[2:4], row[5])]
    return found


def test_the_page_of_the_docs_is_current(book: ThesisBook) -> None:
    """Same headings, claims and verdicts, speeds to 0.05 m/s; the median of climbs depends on the seeds."""
    kept, now = DOCS.read_text(encoding="utf-8"), markdown(book)
    headings = [[line for line in text.splitlines() if line.startswith("#")] for text in (kept, now)]
    assert headings[0] == headings[1], "run: aeroservo study thesis --markdown docs/thesis.md"
    for heading in ("Table 2: sea level", "Table 3: 10,000 ft (3048 m)"):
        old, new = table_numbers(kept, heading), table_numbers(now, heading)
        assert list(old) == list(new)
        for key, values in new.items():
            tolerance = 8.0 if key == ("simulation, adaptive", "flutter") else 0.05
            np.testing.assert_allclose(old[key], values, atol=tolerance, equal_nan=True, err_msg=str(key))
    claim = re.compile(r"^\| [^|]+ \| ([^|]+) \| \*\*([^|]+)\*\* \|", re.MULTILINE)
    assert claim.findall(kept) == claim.findall(now) == [(c.statement, c.verdict) for c in book.claims]
    assert book_json(book)["made_by"] == MADE_BY
    for name in PICTURES:
        assert (DOCS.parent / "img" / "thesis" / picture_name(book.entry(name))).is_file()


def test_records() -> None:
    """Words for numbers; curves are checked."""
    assert (verdict(whole=True), verdict(whole=False, part=True), verdict(whole=False)) == (
        "holds",
        "holds in part",
        "does not hold",
    )
    assert [number(x) for x in (None, "text", 3.14159265, float("nan"))] == ["none", "text", "3.142", "none"]
    assert Compared(what="x", unit="", thesis=1.0, ours=1.5).difference == 0.5
    assert Compared(what="x", unit="", thesis="a few", ours=1.5).difference is None
    with pytest.raises(ValueError, match="one length"):
        Curve(name="x", x=[0.0, 1.0], y=[0.0])
