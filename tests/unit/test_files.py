"""Reading, copying and varying model files: every way of going wrong is one message, and nothing is overwritten."""

from __future__ import annotations

import json
import os
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.io import savemat

from aeroservo.aircraft import file_text, files
from aeroservo.aircraft.file_errors import ModelFileError
from aeroservo.aircraft.files import new, parse, presets, read, write_whole
from aeroservo.aircraft.overrides import numbers, override

GOLAND = (Path(files.__file__).parent / "presets" / "goland.toml").read_text(encoding="utf-8")


def refusal(path: Any) -> str:
    """The message with which a file is refused."""
    with pytest.raises(ModelFileError) as caught:
        read(path)
    return str(caught.value)


def written(folder: Path, content: str | bytes, name: str = "wing.toml") -> Path:
    """A file of the given content."""
    path = folder / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("", "is empty"),
        ("  \n\t\n", "is empty"),
        ("# nothing but a comment\n", "is empty"),
        (b"\x89PNG\r\n\x1a\n\x00\x00", "binary"),
        (b"kind = 'x'\x00", "binary"),
        (b"name = 'caf\xe9'", "UTF-8"),
        ("kind = ", "not valid TOML"),
        ("kind = 'goland'\nkind = 'goland'", "not valid TOML"),
        ("chord = 1e", "not valid TOML"),
        (f"chord = {'9' * 5000}", "not valid TOML"),
        ("schema_version = 1", "kind is missing"),
        ("kind = 'beam_wing'", "wing is missing"),
        ("kind = 'beam_wing'\nschema_version = 99", "newer"),
        ("kind = '\\u001b[31mred'", "not known"),
        ("x = " + "[" * 100_000, "nested too deeply"),
        ("x = " + "[" * 300 + "]" * 300, "nested too deeply"),
        ("[" + ".".join("a" * 3000) + "]\n", "nested too deeply"),
        ("a = {" * 5000, "nested too deeply"),
    ],
)
def test_files_that_say_nothing_usable(tmp_path: Path, content: str | bytes, words: str) -> None:
    """Empty, binary, not TOML, of no kind, nested: one line that names the file."""
    message = refusal(written(tmp_path, content))
    assert words in message
    assert "wing.toml" in message
    assert len(message) < 1000
    assert "\x1b" not in message


def test_paths_that_are_no_file(tmp_path: Path) -> None:
    """A folder, a device, nothing at all, names that no system takes."""
    assert "is a folder" in refusal(tmp_path)
    assert "no such file" in refusal(str(tmp_path / "missing.toml"))
    assert "not an ordinary file" in refusal("/dev/zero")
    assert "no such file" in refusal("\0")
    assert "no such file" in refusal("")
    assert len(refusal("a" * 100_000)) < 1000
    os.symlink(tmp_path / "loop", tmp_path / "loop")
    assert "loop" in refusal(tmp_path / "loop")
    os.mkfifo(tmp_path / "pipe")
    assert "not an ordinary file" in refusal(tmp_path / "pipe")


def test_unknown_preset_is_answered_with_the_nearest() -> None:
    """A misspelt name is met with a hint and the list."""
    message = refusal("golland")
    assert "did you mean 'goland'" in message
    assert all(preset.name in message for preset in presets())


@pytest.mark.parametrize("name", ["../presets/goland", "goland.toml", "./goland", "/goland", "GOLAND"])
def test_a_preset_is_named_not_searched(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No path leads into the folder of the presets by accident."""
    monkeypatch.chdir(tmp_path)
    assert "no such file" in refusal(name)


def test_a_path_object_is_never_a_preset(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """`Path("goland")` is the file of that name."""
    monkeypatch.chdir(tmp_path)
    assert "no such file" in refusal(Path("goland"))
    written(tmp_path, GOLAND.replace('name = "goland"', 'name = "mine"'), "goland")
    assert read(Path("goland")).name == "mine"
    assert read("goland").name == "goland"


def test_no_permission(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file that may not be read is named as such (a superuser may read all, so the refusal is played there)."""
    path = written(tmp_path, GOLAND)
    path.chmod(0)
    if os.access(path, os.R_OK):

        def forbidden(*_: Any, **__: Any) -> None:
            raise PermissionError(13, "Permission denied")

        monkeypatch.setattr(file_text, "open", forbidden, raising=False)
    assert "no permission" in refusal(path)


def test_a_huge_file_is_not_read(tmp_path: Path) -> None:
    """More than 10 MB is no model file."""
    path = tmp_path / "huge.toml"
    with open(path, "wb") as file:
        file.truncate(file_text.LARGEST + 1)
    assert "larger than 10 MB" in refusal(path)


def test_html_and_unicode_in_names_are_data(tmp_path: Path) -> None:
    """Names may hold markup and any script; whoever prints them escapes them."""
    for name in ("<script>alert(1)</script>", "Flügel 翼 🛩", "'; DROP TABLE wings; --", "../../etc/passwd", "{{7*7}}"):
        text = GOLAND.replace('name = "goland"', f'name = "{name}"')
        assert read(written(tmp_path, text)).name == name


@settings(max_examples=200, deadline=None)
@given(st.text(max_size=80))
def test_any_text_is_refused_in_words(text: str) -> None:
    """Whatever the text, the answer is a ModelFileError (there is no valid model so short)."""
    with pytest.raises(ModelFileError):
        parse(text, Path("x.toml"))


VALUES = st.one_of(
    st.floats(allow_nan=True, allow_infinity=True),
    st.integers(-(10**30), 10**30),
    st.booleans(),
    st.text(max_size=5),
    st.lists(st.floats(), max_size=3),
    st.dictionaries(st.text(max_size=3), st.floats(), max_size=2),
)


@settings(max_examples=300, deadline=None)
@given(st.sampled_from(["goland", "thesis-aircraft", "nasa-typical-section"]), st.data())
def test_any_value_anywhere_is_taken_or_refused(preset: str, data: st.DataObject) -> None:
    """One value of a valid file replaced by anything: a model or a ModelFileError, and no other exception."""
    tables = json.loads(read(preset).model_dump_json(exclude_unset=True))
    inner: Any = tables
    while True:
        key = data.draw(st.sampled_from(sorted(inner)) if isinstance(inner, dict) else st.integers(0, len(inner) - 1))
        if not isinstance(inner[key], dict | list) or not inner[key] or data.draw(st.booleans()):
            break
        inner = inner[key]
    inner[key] = data.draw(VALUES)
    try:
        model = files.validate(tables, "x.toml")
    except ModelFileError as error:
        assert "x.toml" in str(error)
    else:
        model.derived()
        model.problems()


def test_new_copies_the_comments_and_never_overwrites(tmp_path: Path) -> None:
    """A copy is the preset to the byte; an existing file stays unless forced."""
    path = new("goland", tmp_path / "mine.toml")
    assert path.read_text(encoding="utf-8") == GOLAND
    path.write_text("precious", encoding="utf-8")
    with pytest.raises(ModelFileError, match="exists already"):
        new("thesis-binary", path)
    assert path.read_text(encoding="utf-8") == "precious"
    new("thesis-binary", path, force=True)
    assert read(path).kind == "binary_wing"
    assert [p.name for p in tmp_path.iterdir()] == ["mine.toml"]


def test_new_refuses_what_it_cannot_do(tmp_path: Path) -> None:
    """Unknown presets, folders, missing folders, dangling links: refused, and nothing is left behind."""
    for preset in ("golan", "../presets/goland", "", "goland.toml"):
        with pytest.raises(ModelFileError, match="no preset named"):
            new(preset, tmp_path / "x.toml")
    with pytest.raises(ModelFileError, match="is a folder"):
        new("goland", tmp_path)
    with pytest.raises(ModelFileError, match="cannot be written"):
        new("goland", tmp_path / "missing" / "x.toml")
    with pytest.raises(ModelFileError, match="cannot be written"):
        new("goland", tmp_path / ("x" * 300))
    os.symlink(tmp_path / "nowhere", tmp_path / "link.toml")
    with pytest.raises(ModelFileError, match="exists already"):
        new("goland", tmp_path / "link.toml")
    assert [p.name for p in tmp_path.iterdir()] == ["link.toml"]


def test_a_file_that_appears_meanwhile_is_not_overwritten(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Between the check and the write another program may make the file: it wins."""
    path = tmp_path / "x.toml"
    monkeypatch.setattr(files.os.path, "lexists", lambda _: False)
    path.write_text("precious", encoding="utf-8")
    with pytest.raises(FileExistsError):
        write_whole(path, b"ours", force=False)
    assert path.read_text(encoding="utf-8") == "precious"
    assert [p.name for p in tmp_path.iterdir()] == ["x.toml"]


def test_a_write_that_fails_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The disk is full half way: the old content stays, no temporary file does."""
    path = written(tmp_path, "old")

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(files.os, "fsync", full)
    with pytest.raises(OSError, match="No space left"):
        write_whole(path, b"new")
    assert path.read_bytes() == b"old"
    assert [p.name for p in tmp_path.iterdir()] == ["wing.toml"]


# --- kind = "modal" -------------------------------------------------------------------------------------------------


def arrays(n: int = 2, n_in: int = 3, n_k: int = 4, n_mach: int = 2) -> dict[str, Any]:
    """Arrays of kind `modal` that are valid."""
    rng = np.random.default_rng(3)
    Q = rng.standard_normal((n_mach, n_k, n, n_in)) + 1j * rng.standard_normal((n_mach, n_k, n, n_in))
    return {
        "M": np.eye(n),
        "D": np.zeros((n, n)),
        "K": np.diag(np.arange(1.0, n + 1.0)),
        "phi": rng.standard_normal((5, 6, n)),
        "grid": rng.standard_normal((5, 3)),
        "k": np.linspace(0.0, 1.0, n_k),
        "mach": np.linspace(0.0, 0.5, n_mach) if n_mach > 1 else np.zeros(1),
        "Q": Q,
        "b_m": 0.5,
        "mode_names": np.array([f"mode {i}" for i in range(n)]),
        "input_names": np.array([f"mode {i}" for i in range(n)] + [f"elevon {i}" for i in range(n_in - n)]),
    }


def modal(folder: Path, content: dict[str, Any] | bytes, name: str = "data.npz") -> Path:
    """A model file of kind `modal` beside its data."""
    if isinstance(content, bytes):
        (folder / name).write_bytes(content)
    elif name.endswith(".npz"):
        np.savez(folder / name, **content)
    else:
        savemat(folder / name, content)
    return written(folder, f'kind = "modal"\n[modal]\ndata = "{name}"\n')


@pytest.mark.parametrize("name", ["data.npz", "data.mat"])
@pytest.mark.parametrize(("n", "n_in", "n_k", "n_mach"), [(2, 3, 4, 2), (1, 1, 3, 1), (2, 2, 1, 1), (1, 2, 3, 2)])
def test_arrays_are_read_as_they_were_written(
    tmp_path: Path, name: str, n: int, n_in: int, n_k: int, n_mach: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Both formats give the same numbers, whatever axes Matlab drops; the folder is that of the model file."""
    given_arrays = arrays(n, n_in, n_k, n_mach)
    content = dict(given_arrays)
    if name.endswith(".mat"):
        content |= {key: np.array(list(content[key]), dtype=object) for key in ("mode_names", "input_names")}
    path = modal(tmp_path, content, name)
    monkeypatch.chdir("/")
    model: Any = read(path)
    for key in ("M", "D", "K", "phi", "grid", "k", "mach", "Q"):
        np.testing.assert_array_equal(getattr(model.arrays, key), given_arrays[key], err_msg=key)
        assert not getattr(model.arrays, key).flags.writeable
    assert model.arrays.b_m == 0.5
    assert model.arrays.input_names == tuple(given_arrays["input_names"])
    assert model.derived()["modes"] == n


def test_optional_arrays(tmp_path: Path) -> None:
    """Damping is zero where it is left out; shapes are left out together."""
    content = {key: value for key, value in arrays().items() if key not in ("D", "phi", "grid")}
    model: Any = read(modal(tmp_path, content))
    assert not model.arrays.D.any()
    assert model.arrays.phi is None


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("M", np.eye(3), "M must have shape (2, 2), got (3, 3)"),
        ("M", np.zeros((2, 2)), "positive definite"),
        ("M", np.array([[1.0, 0.5], [0.0, 1.0]]), "symmetric"),
        ("K", np.ones(2), "K must have shape (2, 2), got (2,)"),
        ("K", np.array([[np.nan, 0.0], [0.0, 1.0]]), "K holds a value that is not finite"),
        ("K", np.eye(2) * (1.0 + 1.0j), "real"),
        ("D", np.eye(1), "D must have shape (2, 2)"),
        ("Q", np.zeros((2, 4, 2, 2)), "Q must have shape (2, 4, 2, 3), got (2, 4, 2, 2)"),
        ("Q", np.zeros((4, 2, 3)), "Q must have shape (2, 4, 2, 3), got (4, 2, 3)"),
        ("Q", np.full((2, 4, 2, 3), np.inf), "Q holds a value that is not finite"),
        ("k", np.array([0.0, 0.5, 0.4, 1.0]), "k must hold ascending"),
        ("k", np.array([-0.1, 0.0, 0.4, 1.0]), "k must hold ascending"),
        ("k", np.zeros((2, 2)), "k must have shape (any)"),
        ("k", np.zeros(0), "k must hold ascending"),
        ("mach", np.array([0.5, 0.0]), "mach must hold ascending"),
        ("b_m", -0.5, "b_m must be positive"),
        ("b_m", np.array([0.5, 0.5]), "b_m must have shape (1)"),
        ("b_m", "half", "b_m must hold numbers"),
        ("mode_names", np.array(["mode 0", "mode 1", "mode 2"]), "first 3 input_names must be the mode_names"),
        ("input_names", np.array(["mode 1", "mode 0", "elevon 0"]), "first 2 input_names must be the mode_names"),
        ("input_names", np.array(["mode 0", "mode 1", "mode 1"]), "input_names must differ"),
        ("input_names", np.arange(3), "input_names must be a list of strings"),
        ("mode_names", np.array(["a\x1b[0m", "b"]), "printable"),
        ("phi", np.zeros((5, 3, 2)), "phi must have shape (any, 6, 2)"),
        ("grid", np.zeros((4, 3)), "same n_grid"),
        ("grid", None, "given together"),
        ("M_control", np.zeros((3, 1)), "M_control must have shape (2, any)"),
        ("Q", None, "lacks the array(s) Q"),
        ("mode_names", np.array(["mode 0", None], dtype=object), "pickled"),
        ("K", np.array([[{}, 1], [2, 3]], dtype=object), "pickled"),
    ],
)
def test_wrong_arrays_are_refused(tmp_path: Path, name: str, value: Any, words: str) -> None:
    """Wrong shapes, missing arrays, pickled objects, not finite: the array and what is wanted are named."""
    content = arrays() | {name: value}
    if value is None:
        del content[name]
    message = refusal(modal(tmp_path, content))
    assert words in message
    assert "wing.toml: modal.data" in message
    assert "data.npz" in message


def test_nothing_in_a_data_file_is_executed(tmp_path: Path) -> None:
    """A pickle that would run a command is refused unread."""

    class Evil:
        def __reduce__(self) -> Any:
            return os.mkdir, (str(tmp_path / "pwned"),)

    content = arrays() | {"K": np.array([Evil()], dtype=object)}
    assert "pickled" in refusal(modal(tmp_path, content))
    assert not (tmp_path / "pwned").exists()


@pytest.mark.parametrize("name", ["data.npz", "data.mat"])
@pytest.mark.parametrize("content", [b"", b"not an archive", b"PK\x03\x04broken", b"MATLAB 5.0 MAT-file" + b"\0" * 200])
def test_damaged_data_files(tmp_path: Path, name: str, content: bytes) -> None:
    """Empty and damaged data files."""
    message = refusal(modal(tmp_path, content, name))
    assert "wing.toml: modal.data" in message
    assert "is not a readable" in message or "lacks the array" in message


def test_a_data_file_that_would_fill_the_memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What it would unpack to is read from the archive's table first."""
    from aeroservo.aircraft import modal_data

    monkeypatch.setattr(modal_data, "LARGEST", 1000)
    assert "unpacks to" in refusal(modal(tmp_path, arrays()))
    path = tmp_path / "data.npz"
    header = np.lib.format.header_data_from_array_1_0(np.zeros(1)) | {"shape": (10**15,)}
    with zipfile.ZipFile(path, "w") as archive, archive.open("M.npy", "w") as file:
        np.lib.format.write_array_header_1_0(file, header)
    message = refusal(tmp_path / "wing.toml")
    assert "memory" in message or "refused" in message or "readable" in message


@pytest.mark.parametrize("name", ["missing.npz", "../x/missing.mat", "/etc/passwd", "data.txt", "data.npz\\n", ""])
def test_data_files_that_are_not_there(tmp_path: Path, name: str) -> None:
    """Missing, of another ending, unprintable."""
    assert "modal.data" in refusal(written(tmp_path, f'kind = "modal"\n[modal]\ndata = "{name}"\n'))


# --- changing single numbers ----------------------------------------------------------------------------------------


def test_override_by_dotted_path() -> None:
    """A number changes, all others and the old model stay; stations are counted from 0 in either spelling."""
    model: Any = read("thesis-binary")
    softer: Any = override(model, {"wing.pitch_stiffness_N_m": 200, "wing.elevon.lift_per_rad": 1.0})
    assert softer.wing.pitch_stiffness_N_m == 200.0
    assert softer.wing.elevon.lift_per_rad == 1.0
    assert model.wing.pitch_stiffness_N_m == 413.2
    assert numbers(softer) | {"wing.pitch_stiffness_N_m": 413.2, "wing.elevon.lift_per_rad": 0.87} == numbers(model)
    wing: Any = read("goland")
    one, other = (override(wing, {path: 1e7}) for path in ("wing.station[1].EI_N_m2", "wing.station.1.EI_N_m2"))
    assert numbers(one) == numbers(other)
    assert one.wing.station[1].EI_N_m2 == 1e7  # type: ignore[attr-defined]
    assert one.wing.station[0].EI_N_m2 == 9.773e6  # type: ignore[attr-defined]


def test_optional_numbers_may_be_given() -> None:
    """An optional number that the file leaves out can be varied too."""
    wing: Any = override(read("wright-cooper-binary"), {"wing.eccentricity": 0.2})
    assert wing.wing.e == 0.2


def test_every_number_of_every_preset_can_be_written_back() -> None:
    """Each named number, set to its own value, changes nothing."""
    for preset in presets():
        model = read(preset.name)
        for path, value in numbers(model).items():
            if value is not None:
                assert numbers(override(model, {path: value})) == numbers(model), path


@pytest.mark.parametrize(
    "path",
    [
        "wing.pitch_stiffness",
        "wing",
        "wing.station",
        "wing.station.EI_N_m2",
        "wing.station[2].EI_N_m2",
        "wing.station[-1].EI_N_m2",
        "wing.station[01].EI_N_m2x",
        "name",
        "kind",
        "schema_version",
        "speeds_m_s[0]",
        "wing.root",
        "",
        ".",
        "wing..chord_m",
        "__class__.__init__",
        "wing.station[0].__dict__",
        "wing.station[99999999999999999999].y_m",
    ],
)
def test_unknown_fields_are_answered_with_those_that_exist(path: str) -> None:
    """A field that is no single number of the model is refused with the list."""
    with pytest.raises(ModelFileError) as caught:
        override(read("goland"), {path: 1.0})
    assert "is not a number of this model" in str(caught.value)
    assert "wing.station[0].EI_N_m2" in str(caught.value)


@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf"), 1e300])
def test_overrides_are_checked_like_files(value: float) -> None:
    """A value out of range is refused, naming the field and the range."""
    with pytest.raises(ModelFileError, match=r"wing\.station\[1\]\.EI_N_m2"):
        override(read("goland"), {"wing.station[1].EI_N_m2": value})


def test_overrides_keep_the_arrays(tmp_path: Path) -> None:
    """A model of kind `modal` keeps its data."""
    model: Any = read(modal(tmp_path, arrays()))
    assert override(model, {}).arrays is model.arrays  # type: ignore[attr-defined]
