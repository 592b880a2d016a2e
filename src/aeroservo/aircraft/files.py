"""Read, copy and vary model files: the only place where a path becomes a model.

Every way in which a file can be wrong ends in one `ModelFileError` that names the file, the field, the value and what
is allowed.
"""

from __future__ import annotations

import contextlib
import os
import secrets
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from aeroservo.aircraft.file_errors import ModelFileError, clean, explained, nearest
from aeroservo.aircraft.file_text import file_text
from aeroservo.aircraft.schema_base import SCHEMA_VERSION, FileModel

_PRESETS = Path(__file__).with_name("presets")
_DEEPEST = 20  # tables and lists inside each other


@dataclass(frozen=True, kw_only=True)
class Preset:
    """A model file that comes with the program.

    Attributes
    ----------
    name, kind, description : str
        What to call it, its kind, and one line about it.
    """

    name: str
    kind: str
    description: str


def read(name_or_path: str | os.PathLike[str]) -> FileModel:
    """The model of a preset's name or of a TOML file.

    Parameters
    ----------
    name_or_path : str or path
        Name of a preset (`presets()` lists them), or path of a model file.

    Returns
    -------
    model : FileModel
        Checked; its class depends on `kind`. Units are part of the names.

    Raises
    ------
    ModelFileError
        If there is no such file, it cannot be read, or what it says is not allowed.

    References
    ----------
    Project convention: contract.md, "Model files (TOML)".

    Examples
    --------
    >>> read("goland").wing.station[0].chord_m
    1.8288
    """
    path = model_path(name_or_path)
    return parse(file_text(path), path)


def parse(text: str, path: Path) -> FileModel:
    """The model of a file's text.

    Parameters
    ----------
    text : str
        TOML.
    path : Path
        Where it came from: named in errors; data files are looked for in its folder.

    Returns
    -------
    model : FileModel
        Checked.

    Raises
    ------
    ModelFileError
        If what the text says is not allowed.

    References
    ----------
    TOML 1.0; project convention: contract.md, "Model files (TOML)".

    Examples
    --------
    >>> parse('kind = "typical_section"', Path("wing.toml"))
    Traceback (most recent call last):
    ...
    aeroservo.aircraft.file_errors.ModelFileError: wing.toml: section is missing (the aerofoil and its springs)
    """
    try:
        data = tomllib.loads(text)
    except RecursionError:
        raise ModelFileError(f"{path}: tables or lists are nested too deeply") from None
    except ValueError as error:
        raise ModelFileError(f"{path}: is not valid TOML: {clean(str(error), 300)}") from None
    if not data:
        raise ModelFileError(f"{path}: is empty: start from a preset with 'aeroservo new PRESET FILE'")
    model = validate(data, str(path))
    return _with_data(model, path)


def validate(data: dict[str, Any], where: str) -> FileModel:
    """The model of a table that has been read.

    Parameters
    ----------
    data : dict
        As TOML gives it.
    where : str
        What to call it in errors.

    Returns
    -------
    model : FileModel
        Checked; a model of kind `modal` has no arrays yet.

    Raises
    ------
    ModelFileError
        If what the table says is not allowed.

    References
    ----------
    Project convention: contract.md, "Model files (TOML)".

    Examples
    --------
    >>> validate({"kind": "wing"}, "wing.toml")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ...
    aeroservo.aircraft.file_errors.ModelFileError: wing.toml: kind = 'wing' is not known; did you mean ...
    """
    from aeroservo.aircraft.schema import kinds

    if _depth(data) > _DEEPEST:
        raise ModelFileError(f"{where}: tables or lists are nested too deeply")
    known = kinds()
    version = data.get("schema_version", 1)
    if isinstance(version, int) and not isinstance(version, bool) and version > SCHEMA_VERSION:
        raise ModelFileError(
            f"{where}: schema_version = {clean(str(version), 20)} is newer than {SCHEMA_VERSION}, the newest that this "
            "program reads: use a newer aeroservo"
        )
    kind = data.get("kind")
    if kind is None:
        raise ModelFileError(f"{where}: kind is missing; it is one of {', '.join(known)}")
    if not isinstance(kind, str) or kind not in known:
        raise ModelFileError(
            f"{where}: kind = {clean(repr(kind), 60)} is not known{nearest(kind, known)}; "
            f"it is one of {', '.join(known)}"
        )
    try:
        return known[kind].model_validate(data)
    except ValidationError as error:
        raise ModelFileError(explained(error, known[kind], where)) from None


def presets() -> tuple[Preset, ...]:
    """The model files that come with the program, by name.

    Returns
    -------
    presets : tuple of Preset
        In alphabetical order.

    References
    ----------
    Project convention: contract.md, `list`.

    Examples
    --------
    >>> [preset.kind for preset in presets() if preset.name == "goland"]
    ['beam_wing']
    """
    return tuple(_preset(path) for path in sorted(_PRESETS.glob("*.toml")))


def new(preset: str, file: str | os.PathLike[str], *, force: bool = False) -> Path:
    """Copy a preset, comments and all, to a file of the user's own.

    Parameters
    ----------
    preset : str
        Name of a preset.
    file : str or path
        Where to.
    force : bool
        Replace an existing file.

    Returns
    -------
    path : Path
        The file written. It appears whole or not at all.

    Raises
    ------
    ModelFileError
        If there is no such preset, the file exists and `force` is not set, or it cannot be written.

    References
    ----------
    Project convention: contract.md, `new`.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     read(new("goland", Path(folder) / "mine.toml")).kind
    'beam_wing'
    """
    names = _preset_names()
    if preset not in names:
        hint = nearest(preset, names)
        raise ModelFileError(f"no preset named {clean(preset, 60)!r}{hint}; the presets are {', '.join(names)}")
    path = Path(file)
    if os.path.isdir(path):
        raise ModelFileError(f"{path}: is a folder; give the name of the file to write")
    try:
        write_whole(path, (_PRESETS / f"{preset}.toml").read_bytes(), force=force)
    except FileExistsError:
        raise ModelFileError(f"{path}: exists already and is left as it is; --force replaces it") from None
    except (OSError, ValueError) as error:
        raise ModelFileError(f"{path}: cannot be written: {getattr(error, 'strerror', None) or error}") from None
    return path


def write_whole(path: Path, content: bytes, *, force: bool = True) -> None:
    """Write a file so that it appears whole or not at all.

    Parameters
    ----------
    path : Path
        Where to.
    content : bytes
        What.
    force : bool
        Replace an existing file.

    Raises
    ------
    FileExistsError
        If the file exists and `force` is not set.
    OSError
        If it cannot be written.

    References
    ----------
    POSIX.1-2017, rename() and link(): both replace or appear in one step.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_whole(Path(folder) / "x.txt", b"x")
    """
    if not force and os.path.lexists(path):
        raise FileExistsError(path)
    temporary = path.parent / f".aeroservo-{secrets.token_hex(8)}.tmp"
    try:
        with open(temporary, "xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        _move(temporary, path, force)
    finally:
        with contextlib.suppress(FileNotFoundError):
            os.unlink(temporary)


def _move(temporary: Path, path: Path, force: bool) -> None:
    """Into place in one step; without `force` never over a file, even one that appeared meanwhile."""
    if force:
        os.replace(temporary, path)
        return
    try:
        os.link(temporary, path)
    except FileExistsError:
        raise
    except OSError:  # a file system without hard links
        if os.path.lexists(path):
            raise FileExistsError(path) from None
        os.replace(temporary, path)


def _preset_names() -> list[str]:
    """Names of the presets, none of them read."""
    return [path.stem for path in sorted(_PRESETS.glob("*.toml"))]


def model_path(name_or_path: str | os.PathLike[str]) -> Path:
    """Path of a preset or file.

    Parameters
    ----------
    name_or_path : str or path
        Name of a preset, or path of a file that exists.

    Returns
    -------
    path : Path
        Of the TOML file.

    Raises
    ------
    ModelFileError
        Listing what there is, where there is no such file and no such preset.

    References
    ----------
    Project convention: contract.md, "MODEL is a preset's name or a path to a TOML file".

    Examples
    --------
    >>> model_path("goland").name
    'goland.toml'
    """
    given = os.fspath(name_or_path)
    if isinstance(name_or_path, str) and given in _preset_names():
        return _PRESETS / f"{given}.toml"
    try:
        if os.path.lexists(given):
            return Path(given)
    except (OSError, ValueError):  # a name that the system does not take
        pass
    names = _preset_names()
    raise ModelFileError(
        f"{clean(given, 200)}: no such file, and no preset of that name{nearest(given, names)}; "
        f"the presets are {', '.join(names)}"
    )


def _depth(data: Any) -> int:
    """How deep tables and lists lie inside each other, without recursion, up to one more than allowed."""
    level, depth = [data], 0
    while level and depth <= _DEEPEST:
        inside = [x.values() if isinstance(x, dict) else x for x in level if isinstance(x, dict | list | tuple)]
        level = [y for x in inside for y in x if isinstance(y, dict | list | tuple)]
        depth += 1
    return depth


def _with_data(model: FileModel, path: Path) -> FileModel:
    """Name an unnamed model after its file; find what lies beside it: data of kind `modal`, airfoils of `aircraft`."""
    if not model.name:
        stem = "".join(c for c in path.stem if c.isprintable())[:200]
        model = model.model_copy(update={"name": stem})
    if model.kind == "modal":
        from aeroservo.aircraft.modal_data import read_modal_data
        from aeroservo.aircraft.schema_other import ModalFile

        assert isinstance(model, ModalFile)
        try:
            model._arrays = read_modal_data(path.parent / model.modal.data)
        except ValueError as error:
            raise ModelFileError(f"{path}: modal.data: {error}") from None
    if model.kind == "aircraft":
        from aeroservo.aircraft.aircraft_schema import with_airfoils

        model = with_airfoils(model, path.parent)
    return model


def _preset(path: Path) -> Preset:
    """Name, kind and the first line of comment."""
    text = path.read_text(encoding="utf-8")
    first = text.splitlines()[0]
    return Preset(name=path.stem, kind=tomllib.loads(text)["kind"], description=first.lstrip("# ").rstrip())
