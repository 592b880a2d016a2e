"""The one folder that the studio reads models from and writes to; nothing leaves it."""

from __future__ import annotations

import os
import re
from pathlib import Path

from aeroservo.aircraft.file_errors import ModelFileError, clean
from aeroservo.aircraft.files import write_whole

#: What a file may be called: no separators, no leading dot, nothing that a system reads as a device or a stream.
_NAME = re.compile(r"\w[\w .,+()@=-]{0,119}")
_DEVICES = {"con", "prn", "aux", "nul", *(f"{d}{i}" for d in ("com", "lpt") for i in range(10))}


def inside(folder: Path, name: str, ending: str) -> Path:
    """The path of a file directly in the folder, or an error.

    Parameters
    ----------
    folder : Path
        The folder that the studio works in.
    name : str
        As typed or chosen.
    ending : str
        What it must end in, with its dot.

    Returns
    -------
    path : Path
        In the folder, whether it exists or not; never a link that leads out of it.

    Raises
    ------
    ModelFileError
        If it is no such name.

    References
    ----------
    Project convention: contract.md, `studio`.

    Examples
    --------
    >>> inside(Path("."), "../wing.toml", ".toml")
    Traceback (most recent call last):
    ...
    aeroservo.aircraft.file_errors.ModelFileError: file name '../wing.toml': letters, digits, spaces and ...
    """
    if not _NAME.fullmatch(name) or ".." in name or name.split(".")[0].strip().lower() in _DEVICES or name[-1] in " .":
        raise ModelFileError(
            f"file name {clean(repr(name), 80)}: letters, digits, spaces and ...y, starting with a "
            "letter, digit or _, no folders"
        )
    if not name.lower().endswith(ending):
        raise ModelFileError(f"file name {clean(repr(name), 80)} must end in {ending}")
    path = folder / name
    try:
        real = path.resolve(strict=False)
    except (OSError, RuntimeError):
        raise ModelFileError(f"{name}: is a link that leads nowhere") from None
    if real.parent != folder.resolve():
        raise ModelFileError(f"{name}: is a link that leads out of the folder {folder}")
    return path


def files_in(folder: Path, ending: str) -> tuple[str, ...]:
    """Names of the files in the folder that the studio can open.

    Parameters
    ----------
    folder : Path
        The folder that the studio works in.
    ending : str
        What they end in, with its dot.

    Returns
    -------
    names : tuple of str
        In alphabetical order, at most 500.

    References
    ----------
    Project convention: contract.md, `studio`.

    Examples
    --------
    >>> files_in(Path("no such folder"), ".toml")
    ()
    """
    found = []
    try:
        with os.scandir(folder) as entries:
            for entry in entries:
                if entry.name.lower().endswith(ending) and entry.is_file():
                    found.append(entry.name)
    except OSError:
        return ()
    names = []
    for name in sorted(found):
        try:
            inside(folder, name, ending)
        except ModelFileError:
            continue
        names.append(name)
    return tuple(names[:500])


def saved(folder: Path, name: str, ending: str, content: bytes, *, force: bool) -> Path:
    """Write a file into the folder, whole or not at all.

    Parameters
    ----------
    folder : Path
        The folder that the studio works in.
    name : str
        As typed.
    ending : str
        What it must end in.
    content : bytes
        What.
    force : bool
        Replace an existing file.

    Returns
    -------
    path : Path
        The file written.

    Raises
    ------
    FileExistsError
        If it exists and `force` is not set.
    ModelFileError
        If it is no such name, or it cannot be written.

    References
    ----------
    Project convention: contract.md, `new`: never over an existing file unless told so.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as there:
    ...     saved(Path(there), "wing.toml", ".toml", b"", force=False).name
    'wing.toml'
    """
    path = inside(folder, name, ending)
    if path.is_dir():
        raise ModelFileError(f"{name}: is a folder")
    try:
        write_whole(path, content, force=force)
    except FileExistsError:
        raise
    except OSError as error:
        raise ModelFileError(f"{name}: cannot be written: {error.strerror}") from None
    return path
