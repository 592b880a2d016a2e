"""Drafts of model files: what is typed, what is wrong with it, how it is written back, and where to."""

from __future__ import annotations

import os
import tomllib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from aeroservo.aircraft.file_errors import ModelFileError
from aeroservo.aircraft.files import parse, presets, read
from aeroservo.aircraft.schema import kinds
from aeroservo.studio.draft import Draft, changes, checked, held, opened, put, shown, typed
from aeroservo.studio.fields import Form, form_of
from aeroservo.studio.folder import files_in, inside, saved
from aeroservo.studio.layout import text_of

HERE = Path(".")
NAMES = [preset.name for preset in presets()]


def places(form: Form, draft: Draft, place: tuple[Any, ...] = ()) -> list[tuple[tuple[Any, ...], Any]]:
    """Every entry of a form with its place in a draft."""
    found = [((*place, entry.name), entry) for entry in form.entries]
    for group in form.groups:
        here = (*place, group.name)
        inner = held(draft, here)
        if group.rows:
            for i in range(len(inner or [])):
                found += places(group.table, draft, (*here, i))
        elif inner is not None:
            found += places(group.table, draft, here)
    return found


@pytest.mark.parametrize("name", NAMES)
def test_form_reaches_every_value_of_a_preset_and_shows_it_so_that_it_reads_back(name: str) -> None:
    source = opened(name, HERE)
    reached = {}
    for place, entry in places(form_of(kinds()[source.model.kind]), source.draft):
        value = held(source.draft, place)
        reached[place] = value
        if value is not None and entry.kind not in ("choice", "flag"):
            again = typed(entry.kind, shown(entry.kind, value))
            assert again == value
    leaves = {place for place in _leaves(source.draft) if place not in (("kind",), ("schema_version",))}
    assert leaves <= {place for place, value in reached.items() if value is not None}


def _leaves(at: Any, place: tuple[Any, ...] = ()) -> set[tuple[Any, ...]]:
    """Values of a draft; a list of numbers or texts is one."""
    if isinstance(at, dict):
        return set().union(*(_leaves(v, (*place, k)) for k, v in at.items())) if at else set()
    if isinstance(at, list) and at and all(isinstance(row, dict) for row in at):
        return set().union(*(_leaves(row, (*place, i)) for i, row in enumerate(at)))
    return {place}


@pytest.mark.parametrize("kind", list(kinds()))
def test_every_number_of_every_kind_has_a_meaning(kind: str) -> None:
    def entries(form: Form) -> list[Any]:
        return [*form.entries, *(e for group in form.groups for e in entries(group.table))]

    for entry in entries(form_of(kinds()[kind])):
        assert entry.text and "[" not in entry.unit and (entry.kind != "choice" or len(entry.choices) > 1)


@pytest.mark.parametrize("name", NAMES)
def test_an_unchanged_draft_is_the_file_byte_for_byte(name: str) -> None:
    source = opened(name, HERE)
    assert text_of(source.draft, source) == source.text
    assert checked(source.draft, source) == ()
    assert changes(source.draft, source.draft) == ()


@given(data=st.data())
@settings(max_examples=30, deadline=None)
def test_text_says_what_the_draft_says_whatever_is_changed(data: st.DataObject) -> None:
    source = opened(data.draw(st.sampled_from(NAMES)), HERE)
    draft = source.draft
    for _ in range(data.draw(st.integers(1, 4))):
        tables = [p for p in _tables(draft) if p]
        leaves = sorted(_leaves(draft), key=str)
        what = data.draw(st.sampled_from(["set", "remove", "row", "drop", "table"]))
        if what == "set":
            draft = put(draft, data.draw(st.sampled_from(leaves)), data.draw(st.floats(-1e9, 1e9)))
        elif what == "remove":
            draft = put(draft, data.draw(st.sampled_from(leaves)), None)
        elif what == "table":
            draft = put(draft, ("damping", "hysteretic", "g"), data.draw(st.floats(0.0, 0.9)))
        elif tables:
            place = data.draw(st.sampled_from(tables))
            if isinstance(place[-1], int):
                rows = held(draft, place[:-1])
                row = None if what == "drop" else dict(rows[place[-1]])
                draft = put(draft, place if row is None else (*place[:-1], len(rows)), row)
    assert tomllib.loads(text_of(draft, source)) == draft


def _tables(at: Any, place: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    inner = at.items() if isinstance(at, dict) else enumerate(at) if isinstance(at, list) else ()
    return [place] * isinstance(at, dict) + [p for k, v in inner for p in _tables(v, (*place, k))]


def test_comments_stay_with_what_they_explain() -> None:
    source = opened("thesis-uav", HERE)
    draft = put(put(source.draft, ("structure", "station", 1), None), ("surface", 0, "control", 0, "hinge_from"), 0.8)
    text = text_of(draft, source)
    assert text.count("#") == source.text.count("#")
    assert "hinge_from = 0.8                       # x/c" in text
    assert parse(text, Path("x.toml")).structure.station[1].y_m == 0.5  # type: ignore[attr-defined]


WRONG = [
    ("thesis-binary", ("wing", "chord_m"), "wide", ("wing", "chord_m"), "must be a number"),
    ("thesis-binary", ("wing", "chord_m"), None, ("wing", "chord_m"), "is missing"),
    ("thesis-binary", ("wing", "sweep_deg"), 99.0, ("wing", "sweep_deg"), "must be at least -80 and at most 80"),
    ("thesis-binary", ("wing", "chord_m"), 1e300, ("wing", "chord_m"), "must be greater than 0 and at most 100000"),
    ("thesis-binary", ("damping",), {}, ("damping",), "needs exactly one of"),
    ("thesis-binary", ("speeds_m_s",), [1.0, "x", 2.0], ("speeds_m_s", 1), "must be a number"),
    ("thesis-uav", ("structure", "root"), "loose", ("structure", "root"), "must be 'clamped' or 'free'"),
    ("thesis-uav", ("structure", "station", 1, "EI_N_m2"), "b(a)d", ("structure", "station", 1, "EI_N_m2"), "a number"),
    ("thesis-uav", ("surface", 0, "section", 0, "airfoil"), 5, ("surface", 0, "section", 0, "airfoil"), "must be text"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "place", "value", "where", "what"), WRONG)
def test_what_is_wrong_is_told_at_its_field_and_only_there(
    name: str, place: Any, value: Any, where: Any, what: str
) -> None:
    source = opened(name, HERE)
    (finding,) = checked(put(source.draft, place, value), source)
    assert finding.place == where and what in finding.message
    assert "[" not in finding.message or "damping" in finding.message  # the meaning stands beside the field already


def test_places_that_are_not_there() -> None:
    draft = {"wing": {"station": [{"y_m": 0.0}]}}
    assert held(draft, ("wing", "station", 3, "y_m")) is None
    with pytest.raises(ValueError, match="no such place"):
        put(draft, ("wing", "station", 2, "y_m"), 1.0)
    with pytest.raises(ValueError, match="no such place"):
        put(draft, ("wing", "station", 2), {"y_m": 1.0})
    assert draft == {"wing": {"station": [{"y_m": 0.0}]}}
    assert changes({"a": [1, 2], "b": 1}, {"a": [1]}) == ("a", "b")


BAD_NAMES = [
    "../x.toml", "/etc/x.toml", "a/b.toml", "a\\b.toml", ".hidden.toml", "", "x.toml/..", "con.toml", "NUL.toml",
    "lpt1.toml", "x\0.toml", "x\n.toml", "x.toml ", "C:x.toml", "~/x.toml", "x" * 200 + ".toml", "..toml", "a..b.toml",
    "x.html", "x;y.toml", "x|y.toml", "-rf.toml", "$(x).toml",
]  # fmt: skip


@pytest.mark.parametrize("name", BAD_NAMES)
def test_names_that_are_no_files_of_the_folder(name: str, tmp_path: Path) -> None:
    with pytest.raises(ModelFileError):
        inside(tmp_path, name, ".toml")
    with pytest.raises(ModelFileError):
        saved(tmp_path, name, ".toml", b"", force=True)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(os.name != "posix", reason="links of POSIX")
def test_links_do_not_lead_out_of_the_folder(tmp_path: Path) -> None:
    folder, outside = tmp_path / "in", tmp_path / "outside.toml"
    folder.mkdir()
    outside.write_text("kind = 'modal'")
    (folder / "link.toml").symlink_to(outside)
    (folder / "loop.toml").symlink_to(folder / "loop.toml")
    (folder / "own.toml").symlink_to(folder / "real.toml")
    for name in ("link.toml", "loop.toml"):
        with pytest.raises(ModelFileError, match="is a link"):
            saved(folder, name, ".toml", b"evil", force=True)
    assert outside.read_text() == "kind = 'modal'"
    assert inside(folder, "own.toml", ".toml") == folder / "own.toml"
    assert files_in(folder, ".toml") == ()
    with pytest.raises(ModelFileError, match="link"):
        opened("link.toml", folder)


@pytest.mark.parametrize("name", ["wing (1).toml", "Flügel.toml", "a.b-c_d+e, 2.toml"])
def test_ordinary_names_are_taken(name: str, tmp_path: Path) -> None:
    assert saved(tmp_path, name, ".toml", b"", force=False) == tmp_path / name
    assert files_in(tmp_path, ".toml") == (name,)


def test_saving_asks_before_it_replaces(tmp_path: Path) -> None:
    saved(tmp_path, "a.toml", ".toml", b"one", force=False)
    with pytest.raises(FileExistsError):
        saved(tmp_path, "a.toml", ".toml", b"two", force=False)
    assert (tmp_path / "a.toml").read_bytes() == b"one"
    saved(tmp_path, "a.toml", ".toml", b"two", force=True)
    assert (tmp_path / "a.toml").read_bytes() == b"two"
    (tmp_path / "d.toml").mkdir()
    with pytest.raises(ModelFileError, match="is a folder"):
        saved(tmp_path, "d.toml", ".toml", b"", force=True)
    with pytest.raises(ModelFileError, match="cannot be written"):
        saved(tmp_path / "gone", "a.toml", ".toml", b"", force=True)
    assert files_in(tmp_path, ".toml") == ("a.toml",)


def test_a_file_too_large_to_edit_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "big.toml"
    path.write_text(opened("goland", HERE).text + "#" * 600_000)
    assert read(path).kind == "beam_wing"
    with pytest.raises(ModelFileError, match="the most that the studio edits"):
        opened("big.toml", tmp_path)


def test_an_unknown_type_of_field_is_no_form() -> None:
    from pydantic import BaseModel

    class Odd(BaseModel):
        x: complex

    with pytest.raises(TypeError, match="no form knows"):
        form_of(Odd)
